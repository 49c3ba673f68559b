"""The question that a guess leaves open, with the options and commands that answer it."""

import shlex

from smarig.core import shown
from smarig.study import quantity_words as q
from smarig.study.signal_columns import holds_still, is_noise
from smarig.study.table_guess import TableGuess
from smarig.study.typed_names import listed_names, typed_name

_MOST_COMMANDS = 6  # that a question lists


def question(guess: TableGuess) -> str:
    """What the user must say."""
    options = []
    for doubt in guess.doubts:
        if doubt.startswith("unit "):
            options.append(f"--unit '{typed_name(guess.table, doubt.removeprefix('unit '))}=UNIT'")
        else:
            options.append(f"--{doubt} NAME")
    names, drive = listed_names(guess.table), guess.first("input")
    if guess.by_loop and drive is not None and "input" not in guess.doubts:  # no name says so
        options.append(f"and --input NAME if it is not {shown(typed_name(guess.table, drive.name))}")
    units = [doubt.removeprefix("unit ") for doubt in guess.doubts if doubt.startswith("unit ")]
    what = "which columns to use"
    if len(units) == len(guess.doubts):
        what = f"in which unit {' and '.join(shown(name) for name in units)} {'are' if units[1:] else 'is'}"
    return (
        f"{guess.table.path}: it is not clear {what}. Say {' '.join(options)} (columns: {names}), "
        f"or take the draft with --yes.{_commands(guess)}"
    )


def _commands(guess: TableGuess) -> str:
    """The commands that answer which columns are input and output, where few are possible; "" otherwise."""
    drive, out = guess.first("input"), guess.first("output")
    able = [c for c in guess.columns if c.facts.kind == "number" and c.facts.levels > 1]
    able = [c for c in able if c.quantity not in q.NO_SIGNALS and not holds_still(c) and not is_noise(c)]
    if not {"input", "output"} & set(guess.doubts) or not 1 < len(able) <= _MOST_COMMANDS:
        return ""
    inputs = able if "input" in guess.doubts or drive is None else [drive]
    outputs = able if "output" in guess.doubts or out is None else [out]
    if drive is not None and drive.is_named:  # the question is which column of this quantity
        inputs = [c for c in inputs if c.quantity == drive.quantity]
    pairs = [(a, b) for a in inputs for b in outputs if a.name != b.name][:_MOST_COMMANDS]
    names = [[shlex.quote(typed_name(guess.table, c.name)) for c in pair] for pair in pairs]
    file, out = shlex.quote(str(guess.table.path)), shlex.quote(guess.table.path.stem)
    commands = [f"smarig study {file} --input {a} --output {b} -o {out}" for a, b in names]
    return f" Each of these commands answers it: {'; '.join(commands)}." if commands else ""
