"""Writes the meaning of a table as a mapping file, with the reasons as comments."""

import json
from typing import Any

from smarig.exchange import convert, dimension
from smarig.study import quantity_words as q
from smarig.study.column_guess import ColumnGuess
from smarig.study.row_period import row_period
from smarig.study.second_thermometer import AGREE_K
from smarig.study.stated_conditions import condition_name, may_be_condition, stated_conditions
from smarig.study.table_guess import TableGuess

_STORED = {"length": "mm", "temperature": "degC", "ratio": "mm/mm"}  # units in which outputs are stored
_HEAT_FLOWS = {"heat flow": "W/g", "power": "mW"}
_CHANNELS = {q.TEMPERATURE: "temperature_degC", q.CURRENT: "current_A"}
_UNUSED = ("ignored", "elsewhere")  # roles of columns that are not imported


def mapping_draft(guess: TableGuess, name: str) -> str:
    """The mapping of a table as TOML; it can be read by ``load_mapping`` if the table has an input."""
    drive, out, time = guess.first("input"), guess.first("output"), guess.first("time")
    if drive is None:
        return _unfinished(guess, name)
    channel = input_channel(drive)
    lines = ["# Drafted by smarig study. Correct what is wrong and give it with --map."]
    lines += [
        f"name = {_s(name)}",
        f"summary = {_s(_summary(guess))}",
        f"source = {_s(guess.table.path.name)}",
    ]
    lines += ['steps = "rows"     # each row is one settled reading'] if guess.settled else []
    for section, entries in guess.table.layout.items():
        lines += ["", f"[{section}]", *(f"{key} = {_value(value)}" for key, value in entries.items())]
    if time is not None:
        lines += ["", "[time]", f"column = {_s(time.name)}" + _why(guess, time)]
        lines += ['written = "clock"'] if time.facts.kind == "clock" else [f"unit = {_s(time.unit or 's')}"]
        for part in guess.of_role("fraction"):
            lines += [f"fraction = {_s(part.name)}" + _why(guess, part), f"fraction_unit = {_s(part.unit)}"]
        lines += ['empty = "leave out"     # rows without a time'] if time.facts.missing else []
        lines += ['restarts = "join"     # a log that was resumed'] if time.facts.restarts else []
        repeats = _repeats(time) and not guess.of_role("fraction")
        lines += ['repeated = "mean"     # several rows have the same time'] if repeats else []
    elif (period := row_period(guess.table.header)) and not guess.settled and guess.backward is None:
        lines += ["", "[time]", f"period_s = {period[1]!r}   # {period[0]} before the table"]
    elif "mat" not in guess.table.layout and not guess.settled and guess.backward is None:
        lines += [
            "",
            "# [time]               # no clock was found; if the rows are equally spaced, remove both signs",
            "# period_s = 0.1",
        ]
    lines += _column_lines(guess, channel)
    lines += ["", "[input]", f"channel = {_s(channel)}", f"quantity = {_s(_quantity(drive, 'input'))}"]
    lines += [f"unit = {_s(input_unit(drive))}"]
    if out is not None:
        turned = ", turned" if guess.scale < 0 else ""
        lines += [
            "",
            "[output]",
            f"quantity = {_s(_quantity(out, 'output') + turned)}",
            f"unit = {_s(output_unit(out))}",
        ]
    if out is not None and out.quantity == q.POLARISATION:
        lines += ['zero = "own"     # an integrated charge starts at any zero']
    lines += _condition_lines(guess)
    for other in guess.of_role("compare"):
        lines += [
            "",
            "[[compare]]",
            f"columns = [{_s(drive.name)}, {_s(other.name)}]",
            f"within = {AGREE_K}",
            'unit = "K"',
        ]
        lines += [f'blames = ["{channel}"]']
    ignored = [
        g for g in guess.columns if guess.roles[g.name].role in _UNUSED and g.name not in _mapped(guess)
    ]
    if ignored:
        lines += ["", "[ignore]", *(f"{_s(g.name)} = {_s(guess.roles[g.name].reason)}" for g in ignored)]
    return "\n".join(lines) + "\n"


def input_channel(drive: ColumnGuess) -> str:
    """The channel of a run that an input is kept in."""
    return (
        _CHANNELS.get(drive.quantity, "input")
        if dimension(drive.unit) in q.DIMENSIONS.get(drive.quantity, ())
        else "input"
    )


def input_unit(drive: ColumnGuess) -> str:
    """The unit in which an input is stored."""
    fixed = {"temperature_degC": "degC", "current_A": "A"}
    return fixed.get(input_channel(drive), drive.unit or "1")


def output_unit(out: ColumnGuess) -> str:
    """The unit in which an output is stored: that of the file for a strain in %."""
    if out.quantity == q.STRAIN and dimension(out.unit) == "ratio":
        return "%" if out.unit == "%" else "mm/mm"
    if out.quantity == q.HEAT_FLOW:
        return _HEAT_FLOWS.get(dimension(out.unit), out.unit or "1")
    return (
        _STORED.get(dimension(out.unit), out.unit or "1")
        if out.quantity == q.DISPLACEMENT
        else out.unit or "1"
    )


def _column_lines(guess: TableGuess, channel: str) -> list[str]:
    channels: list[tuple[str, ColumnGuess]] = [(channel, c) for c in guess.of_role("input")]
    channels += [("temperature_degC", c) for c in guess.of_role("temperature")[:1]]
    channels += [("voltage_V", c) for c in guess.of_role("voltage")[:1]]
    channels += [("current_command_A", c) for c in guess.of_role("command")[:1]]
    channels += [("ambient_degC", c) for c in guess.of_role("ambient")[:1] if channel != "ambient_degC"]
    channels += [("position", c) for c in guess.of_role("output")]
    if not guess.branches:
        return ["", "[columns]", *(_channel_line(guess, key, c.name, c) for key, c in channels)]
    lines = []
    for direction, names in (("up", {a: a for a in guess.branches}), ("down", guess.branches)):
        lines += ["", "[[branch]]", f'direction = "{direction}"']
        if direction in (guess.backward or ()):
            lines += ['rows = "backward"     # read from the last row to the first']
        lines += ["[branch.columns]"]
        lines += [_channel_line(guess, key, names[c.name], c) for key, c in channels if c.name in names]
    return lines


def _channel_line(guess: TableGuess, key: str, name: str, c: ColumnGuess) -> str:
    scale = ", scale = -1.0" if key == "position" and guess.scale < 0 else ""
    unit = c.unit or "1"
    return f"{key} = {{ column = {_s(name)}, unit = {_s(unit)}{scale} }}{_why(guess, c) if name == c.name else ''}"


def _mapped(guess: TableGuess) -> set[str]:
    """Columns that branches use beside those with a role."""
    used = {g.name for g in guess.columns if guess.roles[g.name].role not in _UNUSED}
    return {b for a, b in guess.branches.items() if a in used}


def _condition_lines(guess: TableGuess) -> list[str]:
    lines = []
    stated = stated_conditions(guess)
    for c in guess.of_role("condition"):
        key = condition_name(c)
        stated.pop(key, None)
        if not may_be_condition(c):
            continue
        name = key if key.isascii() else _s(key)
        lines.append(f"{name} = {{ column = {_s(c.name)}, unit = {_s(c.unit or '1')} }}{_why(guess, c)}")
    lines += [
        f"{key} = {{ value = {s.value!r}, unit = {_s(s.unit)} }}   # {s.source}".replace("\n", " ")
        for key, s in stated.items()
    ]
    return ["", "[conditions]", *lines] if lines else []


def _why(guess: TableGuess, c: ColumnGuess) -> str:
    role = guess.roles[c.name]
    unit = f"; unit {c.unit_reason}" if c.unit_reason and c.unit_confidence < 0.9 else ""
    return f"   # {role.reason}{unit}".replace("\n", " ")


def _quantity(c: ColumnGuess, otherwise: str) -> str:
    return c.quantity or c.label or otherwise


def _summary(guess: TableGuess) -> str:
    drive, out = guess.first("input"), guess.first("output")
    if drive is None:
        return "Columns whose meaning is not known yet."
    if out is None:
        return f"Heating by {_quantity(drive, 'input')}; temperature only."
    return f"{_quantity(out, 'output')} against {_quantity(drive, 'input')}.".capitalize()


def _unfinished(guess: TableGuess, name: str) -> str:
    lines = [
        f"# Drafted by smarig study from {guess.table.path.name}; it needs an input and an output.",
        f"name = {_s(name)}",
    ]
    lines += [
        f"# column {_s(g.name)}: {g.facts.low:.4g} … {g.facts.high:.4g}, {g.facts.looks()}"
        for g in guess.columns
    ]
    return "\n".join(lines) + "\n"


def _repeats(time: ColumnGuess) -> bool:
    x = convert(time.facts.values, time.unit or "s", "s")
    return bool((x[1:] == x[:-1]).any())


def _value(value: Any) -> str:
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_s(str(v)) for v in value) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return _s(value) if isinstance(value, str) else str(value)


def _s(text: str) -> str:
    """A text as a TOML string."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
