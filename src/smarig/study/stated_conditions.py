"""Conditions of a run that no column holds: what names of files, groups and sheets, titles and properties state."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from smarig.core import shown
from smarig.exchange import CONDITION_UNITS, FoundColumn, dimension, known_unit
from smarig.study import quantity_words as q
from smarig.study.column_guess import VALUE_IN_NAME, ColumnGuess
from smarig.study.hung_weights import hung_weight
from smarig.study.table_guess import TableGuess

CONDITIONS = {
    q.STRESS: "stress",
    q.FORCE: "load",
    q.FIELD: "magnetic_field",
}
_HEADER_CONDITIONS = (("frequency", "frequency", "Hz"), ("room temp", "room_temperature", "degC"))
_SCALARS = CONDITIONS | {q.AMBIENT: "room_temperature"}
_NO_WEIGHT = (q.FORCE, q.STRESS, q.HEAT_FLOW)  # quantities of columns beside which a mass is no load
_OF_SPECIMEN = ("applied", "constant", "nominal", "sample", "specimen", "wire", "temperature")
_WEIGHTS = ("weight", "gewicht")  # that hang at a wire, if they are given as forces
_OF_DEVICE = re.compile("cell|sensor|aufnehmer|dose|capteur")  # what a load cell can bear is no load
_KEY_UNIT = re.compile(r"(.*?)\s*\[([^\]]*)\]")
_OF_SENSOR = re.compile(r"[\w.-]+/\S+|[A-Za-z]+\d\S*")  # U9C/500N, WA20mm
_PLACES = ("group", "sheet")  # keys of a layout that name a part of the file
_PARTS_OF_TITLE = re.compile(r"\s+[-–|]\s+|[;|(),]\s+|[;|()]")
_BARE = re.compile(r"(-?\d+(?:[.,]\d+)?)[\s_]*([^\s\d]+)")
_OF_UNIT = {dimension(unit): name for name, unit in CONDITION_UNITS.items() if name != "chamber_temperature"}
_STATEMENT = re.compile(r"(.*?)[\s:=]*(-?\d+(?:[.,]\d+)?)\s*([^\s\d]*)")


def condition_name(c: ColumnGuess) -> str:
    """The name under which a run keeps a condition that a column holds: of its quantity, else of the column."""
    return (
        CONDITIONS.get(c.quantity) or re.sub(r"\W+", "_", c.quantity or c.label or c.name).strip("_").lower()
    )


def may_be_condition(c: ColumnGuess) -> bool:
    """Whether a column is in a unit of the condition that it would be: runs are compared by some in one unit."""
    expected = CONDITION_UNITS.get(condition_name(c))
    return expected is None or dimension(c.unit) == dimension(expected)


class Stated(NamedTuple):
    """A condition as it is stated: value and unit, and where."""

    value: float
    unit: str
    source: str


def stated_conditions(guess: TableGuess) -> dict[str, Stated]:
    """The conditions that a table and its file state beside the columns, by name; the nearest statement counts."""
    table = guess.table
    used = [c for c in table.columns if guess.roles[c.name].role in ("input", "output")]
    clock = conditions_in_comments([c for c in table.columns if guess.roles[c.name].role == "time"])
    comments = (
        conditions_in_comments(used).items() - clock.items()
    )  # a rate of logging is no frequency of the wire
    found = _weight(guess, table.path.stem, "the name of the file")
    found |= _from(conditions_in_name(table.path.stem), "the name of the file")
    found |= _from(dict(comments), "the comment of a column")
    measured = {c.quantity for role in ("input", "output") for c in guess.of_role(role)}
    if not measured & set(CONDITIONS):  # else a load is what the table measures
        found |= _of_part(guess)
    found |= _from(header_conditions(guess), "a line before the table")
    found |= _from(_quantities(table.scalars), "a single number of the record")
    return found


def _from(conditions: Mapping[str, tuple[float, str]], source: str) -> dict[str, Stated]:
    return {key: Stated(value, unit, source) for key, (value, unit) in conditions.items()}


def _of_part(guess: TableGuess) -> dict[str, Stated]:
    """The loads that the names of group or sheet, the titles and the properties of a table state."""
    found: dict[str, Stated] = {}
    for entries in guess.table.layout.values():
        for kind in (kind for kind in _PLACES if kind in entries):
            name = str(entries[kind])
            place = f"the name of the {kind} {shown(name)}"
            found |= _weight(guess, name, place) | _from(conditions_in_name(name), place)
    for title in guess.table.titles:
        parts = [part for part in _PARTS_OF_TITLE.split(title) if part.strip()]
        place = f"the title {shown(title)}"
        found |= _weight(guess, title, place) | _from(_bare_condition(guess, title), place)
        found |= _from(_quantities(dict(filter(None, map(_statement, parts)))), place)
    entries = dict(_entries(guess.table.header))
    return found | _from(_quantities(entries), "a property of the table")


def _bare_condition(guess: TableGuess, title: str) -> dict[str, tuple[float, str]]:
    """The condition of a title that is a value with its unit and nothing else, as "45 °C" is the label of a run; it
    is no quantity that the table measures or sets.
    """
    match = _BARE.fullmatch(title.strip())
    unit = known_unit(match[2], temperature=True) if match else ""
    measured = {dimension(c.unit) for c in guess.columns if guess.roles[c.name].role in ("input", "output")}
    name = _OF_UNIT.get(dimension(unit), "")
    if not match or not name or dimension(unit) in measured:
        return {}
    return {name: (float(match[1].replace(",", ".")), unit)}


def _weight(guess: TableGuess, text: str, place: str) -> dict[str, Stated]:
    """The load of the weight that a text states, for a wire: beside a heat flow it is the mass of the sample, and a
    measured force contains it.
    """
    weight = hung_weight(text)
    if weight is None or any(c.quantity in _NO_WEIGHT for c in guess.columns):
        return {}
    return {CONDITIONS[q.FORCE]: Stated(weight.newtons, "N", f"{weight} in {place}")}


def _statement(text: str) -> tuple[str, tuple[float, str]] | None:
    """A name with its value and unit, as "Gewicht 10 N"; None for another text."""
    match = _STATEMENT.fullmatch(text.strip())
    return (match[1], (float(match[2].replace(",", ".")), match[3])) if match and match[1] else None


def _entries(header: Mapping[str, str]) -> Iterator[tuple[str, tuple[float, str]]]:
    """The keys of a header whose values are numbers, with or without units."""
    for key, value in header.items():
        match = _STATEMENT.fullmatch(value.strip())
        if match and not match[1]:
            yield key, (float(match[2].replace(",", ".")), match[3])


def conditions_in_name(stem: str) -> dict[str, tuple[float, str]]:
    """Conditions that a file's name states with their units: value and unit by name.

    >>> conditions_in_name("wire_150MPa")
    {'stress': (150.0, 'MPa')}
    """
    names = {"MPa": ("stress", "MPa"), "Hz": ("frequency", "Hz")}
    names |= {unit: ("load", unit) for unit in ("N", "kgf", "gf", "lbf")}
    found = {}
    for value, unit in VALUE_IN_NAME.findall(stem):
        if unit in names:
            found[names[unit][0]] = (float(value.replace(",", ".")), names[unit][1])
    return found


def conditions_in_comments(columns: Sequence[FoundColumn]) -> dict[str, tuple[float, str]]:
    """Conditions that the comments of columns state. The name of a sensor, as U9C/500N, states none; nor does a value
    in the unit of its own column, which is the range of a channel.

    >>> import numpy as np
    >>> stated = lambda unit, text: conditions_in_comments([FoundColumn("F", unit, np.ones(2), comment=text)])
    >>> stated("mV/V", "U9C/500N"), stated("N", "500 N"), stated("N", "60 MPa")
    ({}, {}, {'stress': (60.0, 'MPa')})
    """
    found = {}
    for column in columns:
        own = dimension(known_unit(q.name_and_unit(column.name, column.unit)[1]))
        of_sensors = _OF_SENSOR.sub(" ", column.comment)
        stated = conditions_in_name(of_sensors).items()
        found |= {name: (value, unit) for name, (value, unit) in stated if dimension(unit) != own}
    return found


def _quantities(scalars: Mapping[str, tuple[float, str]]) -> dict[str, tuple[float, str]]:
    """Conditions among single numbers: those whose name states a quantity and nothing else, in a unit of it, as
    "stress" does, but not "stress_limit".

    >>> _quantities({"stress_limit": (900.0, "MPa"), "Gewicht": (10.0, "N"), "weight": (8.0, "mg")})
    {'load': (10.0, 'N')}
    """
    found = {}
    for name, (value, written) in scalars.items():
        label, unit = q.name_and_unit(name, written)
        words = [word for word in re.split(r"[\W_]+", label.lower()) if word and word not in _OF_SPECIMEN]
        known = known_unit(unit, temperature=True)
        quantities = {_quantity_of(word, known) for word in words}
        quantity = quantities.pop() if len(quantities) == 1 else ""
        key = _SCALARS.get(quantity, "")
        if key and dimension(known) in q.DIMENSIONS.get(quantity, ()):
            found[key] = (value, known)
    return found


def _quantity_of(word: str, unit: str) -> str:
    if _OF_DEVICE.search(word):
        return ""
    return q.FORCE if word in _WEIGHTS and dimension(unit) == "force" else q.quantity_of_name(word)[0]


def header_conditions(guess: TableGuess) -> dict[str, tuple[float, str]]:
    """Conditions that the lines before the table state: value and unit by name."""
    found = {}
    for key, value in guess.table.header.items():
        match = _KEY_UNIT.fullmatch(key)
        words, unit = (match[1], match[2]) if match else (key, "")
        for word, name, usual in _HEADER_CONDITIONS:
            if word in words.lower() and re.fullmatch(r"[-+]?\d+(\.\d+)?([eE][-+]?\d+)?", value.strip()):
                found[name] = (float(value), unit or usual)
    return found
