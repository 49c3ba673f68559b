"""Systems of units that a file of a magnetometer states for all of its columns, in place of units of each."""

import re
from collections.abc import Sequence

UNIT_SYSTEMS = {  # units of field and moment
    "hybrid si": ("T", "A m^2"),
    "simunaughth": ("T", "A m^2"),  # Lake Shore 8600: the field is µ0 H
    "si": ("A/m", "A m^2"),
    "cgs": ("Oe", "emu"),
}
_STATED = re.compile(
    rf"\W*(?:units?(?: of measure)?|units? system|system of units)[\s:=,;]+({'|'.join(UNIT_SYSTEMS)})\W*",
    re.IGNORECASE,
)
_FIELD, _MOMENT = re.compile(r"\bfield\b", re.IGNORECASE), re.compile(r"\bmoment\b", re.IGNORECASE)

_OWN_UNIT = re.compile(r"[\[({</]")  # before the unit in a name


def units_of_system(names: Sequence[str], lines: Sequence[str]) -> list[str]:
    """The units of columns of fields and moments in the system that a line states, "" for others or without one.

    >>> units_of_system(["Field", "Moment", "Point"], ["Units of measure        Hybrid SI"])
    ['T', 'A m^2', '']
    """
    stated = next((match[1].lower() for line in lines if (match := _STATED.fullmatch(line))), None)
    if stated is None:
        return [""] * len(names)
    field, moment = UNIT_SYSTEMS[stated]
    plain = ["" if _OWN_UNIT.search(name) else name for name in names]
    return [field if _FIELD.search(name) else moment if _MOMENT.search(name) else "" for name in plain]
