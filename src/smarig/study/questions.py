"""The question that a guess leaves open, with the options and commands that answer it."""

import shlex
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import islice, product
from pathlib import Path

from smarig.core import shown
from smarig.report import display_unit
from smarig.study import quantity_words as q
from smarig.study.column_guess import ColumnGuess
from smarig.study.held_quantities import holds_still, is_noise
from smarig.study.physical_roles import evenness, role_vote
from smarig.study.signal_columns import SENSOR_SIGNALS
from smarig.study.study_options import StudyOptions
from smarig.study.table_guess import TableGuess
from smarig.study.typed_names import listed_names, typed_name

_MOST_COMMANDS = 6  # that a question lists
_ROLES = ("input", "output")
_OF_INPUTS, _OF_OUTPUTS = ("degC", "A", "V"), ("mm", "%")  # of columns of which nothing is known
_MOST_FILES = 3  # with which a whole command is still read


@dataclass(frozen=True)
class StudyCommand:
    """The command of a study as its user gave it; ``out`` None: a folder named as the file."""

    files: tuple[Path, ...]
    options: StudyOptions
    out: Path | None = None

    def with_answers(self, guess: TableGuess, answers: dict[str, str]) -> str:
        """The command with further options: the columns by "input" and "output", the units by "unit NAME"."""
        given = {role: name for role in _ROLES if (name := getattr(self.options, role)) is not None}
        given |= {f"unit {name}": unit for name, unit in self.options.units.items()} | answers
        words = ["smarig", "study", *map(str, self.files)]
        for key, value in given.items():
            name = key.removeprefix("unit ")
            unit = f"{typed_name(guess.table, name)}={value}"
            words += [f"--{key}", typed_name(guess.table, value)] if key in _ROLES else ["--unit", unit]
        words += ["--split", self.options.split] if self.options.split != "auto" else []
        words += ["--yes"] if self.options.accept else []
        words += [] if self.options.diagnose else ["--no-diagnosis"]
        return shlex.join([*words, "-o", str(self.out or guess.table.path.stem)])


def question(guess: TableGuess, command: StudyCommand) -> str:
    """What the user must say, with commands that say it."""
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
        what = f"{_taken(guess)}{what}"
    return (
        f"{guess.table.path}: it is not clear {what}. Say {' '.join(options)} (columns: {names}), "
        f"or take the draft with --yes.{answering(guess, command)}"
    )


def _taken(guess: TableGuess) -> str:
    """Which columns are taken as input and output where no name says so, before a question of their units."""
    drive, out = guess.first("input"), guess.first("output")
    if not guess.by_loop or drive is None or out is None:
        return ""
    return f"whether {shown(drive.name)} is the input and {shown(out.name)} the output, and "


def answering(guess: TableGuess, command: StudyCommand) -> str:
    """The commands that answer which columns are input and output, else those that answer their units; "" if no
    columns could be meant.
    """
    if [role for role in _ROLES if role in guess.doubts or guess.first(role) is None]:
        return _listed(" Each of these commands answers it", guess, command, _roles(guess))
    units = [doubt for doubt in guess.doubts if doubt.startswith("unit ")]
    columns = [next(c for c in guess.columns if f"unit {c.name}" == doubt) for doubt in units]
    usual = [_usual_units(c, guess) for c in columns]
    answers = (dict(zip(units, chosen[::-1])) for chosen in product(*usual[::-1]))  # of the input first
    return _listed(" Each of these commands answers it", guess, command, answers)


def _usual_units(c: ColumnGuess, guess: TableGuess) -> tuple[str, ...]:
    """The units that a column may be in: those of its quantity, else those of any input or output."""
    if c.quantity or c.unit or c.label:
        return q.USUAL_UNITS.get(c.quantity, (c.unit or "1",))
    return _OF_INPUTS if c is guess.first("input") else _OF_OUTPUTS


def assumed_unit(guess: TableGuess, command: StudyCommand) -> str:
    """Which units of temperatures, of the input and of the output are assumed, with the commands that state others; ""
    if the file states them all.
    """
    if command.options.mapping is not None:
        return ""
    hot = [c for c in guess.columns if c.quantity in (q.TEMPERATURE, q.AMBIENT)]
    others = [[c] for role in _ROLES for c in guess.of_role(role) if c not in hot]
    assumed = [[c for c in columns if c.unit_is_assumed] for columns in (hot, *others)]
    return " ".join(_assumed(columns, guess, command) for columns in assumed if columns)


def _assumed(columns: Sequence[ColumnGuess], guess: TableGuess, command: StudyCommand) -> str:
    """That the unit of columns of one quantity is assumed, with the commands that state another, or the options where a
    command would name many files.
    """
    first = columns[0]
    names = " and ".join(shown(typed_name(guess.table, c.name)) for c in columns)
    units = [unit for unit in q.USUAL_UNITS.get(first.quantity, ()) if unit != first.unit]
    sentence = f"The file states no unit of {names}: {display_unit(first.unit)} is assumed."
    if len(command.files) > _MOST_FILES and units:
        options = [" ".join(_unit_option(guess, c.name, unit) for c in columns) for unit in units]
        return f"{sentence} If it is another, add {' or '.join(options)}."
    answers = ({f"unit {c.name}": unit for c in columns} for unit in units)
    return sentence + _listed(" If it is another, name it", guess, command, answers)


def _unit_option(guess: TableGuess, column: str, unit: str) -> str:
    return shlex.join(["--unit", f"{typed_name(guess.table, column)}={unit}"])


def other_columns(guess: TableGuess, command: StudyCommand) -> str:
    """The commands with another output than the one of the guess, if the user named none; "" if there is none."""
    out = guess.first("output")
    if command.options.output is not None or command.options.mapping is not None or out is None:
        return ""
    drive = guess.first("input")
    others = [c.name for c in _able(guess) if c.name not in (drive and drive.name, out.name)]
    answers = ({"input": drive.name, "output": name} for name in others if drive is not None)
    return _listed(" If another column is the output, name it", guess, command, answers)


def _roles(guess: TableGuess) -> Iterable[dict[str, str]]:
    """Columns that could be input and output, those of the guess first; pairs that their loop
    supports come first where either may be the other, and of them the input that is swept most evenly, as a ramp is.
    """
    drive, out = guess.first("input"), guess.first("output")
    able = sorted(_able(guess), key=lambda c: c not in (drive, out))
    open_ = (
        out is None and drive is not None and drive.quantity in SENSOR_SIGNALS
    )  # it may be the output itself
    inputs = able if open_ or "input" in guess.doubts or drive is None else [drive]
    outputs = able if "output" in guess.doubts or out is None else [out]
    if drive is not None and drive.is_named and not open_:  # the question is which column of this quantity
        inputs = [c for c in inputs if c.quantity == drive.quantity]
    if out is not None and out.is_named and not guess.by_loop:
        outputs = [c for c in outputs if c.quantity == out.quantity]
    pairs = [(a, b) for a in inputs for b in outputs if a.name != b.name]
    if open_ or drive is None:
        pairs.sort(key=_doubt)
    return ({"input": a.name, "output": b.name} for a, b in pairs)


def _doubt(pair: tuple[ColumnGuess, ColumnGuess]) -> tuple[bool, float, int]:
    """What speaks against two columns as input and output: their loop, an input not swept evenly (to a hundredth,
    which noise may change), and how little their loop says.
    """
    drive, out = (c.facts.values for c in pair)
    score = role_vote(drive, out).score
    return score <= 0, -round(evenness(drive), 2), -score


def _able(guess: TableGuess) -> Sequence[ColumnGuess]:
    able = [c for c in guess.columns if c.facts.kind == "number" and c.facts.levels > 1]
    able = [c for c in able if c.quantity not in q.NO_SIGNALS and not c.is_flag and not holds_still(c)]
    follow = [c for c in able if not is_noise(c)]
    return follow if len(follow) > 1 else able


def _listed(words: str, guess: TableGuess, command: StudyCommand, answers: Iterable[dict[str, str]]) -> str:
    commands = [command.with_answers(guess, answer) for answer in islice(answers, _MOST_COMMANDS)]
    return f"{words}: {'; '.join(commands)}." if commands else ""
