"""What a file of heat flow says about itself: its exothermic direction and the mass of the sample."""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from smarig.exchange import FoundTable, preamble_lines

_DIRECTION = re.compile(r"\b(exo|endo)[a-z]*\b[^a-z]*(?:direction\b[^a-z]*)?(up|down)\b", re.IGNORECASE)
_ARROW = re.compile(r"([\^↑↓])\s*(exo|endo)|(exo|endo)[a-z]*\s*([\^↑↓])", re.IGNORECASE)
_MASS = re.compile(r"sample (?:mass|weight)\W*(?:mg\W*)?(\d+(?:[.,]\d+)?)", re.IGNORECASE)
_OTHER = {"up": "down", "down": "up"}


@dataclass(frozen=True)
class HeatFlowHeader:
    """``exothermic`` is "up", "down" or "" (not said); ``mass_mg`` the mass of the sample, None if not said."""

    exothermic: str
    mass_mg: float | None


def heat_flow_header(table: FoundTable) -> HeatFlowHeader:
    """What the names of the columns and the lines before the tables say.

    The number ``#EXO`` of NETZSCH is not used: sources differ on the meaning of its sign.
    """
    lines = [*table.names, *(f"{k}: {v}" for k, v in table.header.items()), *preamble_lines(table.path)]
    masses = [float(m[1].replace(",", ".")) for line in lines if (m := _MASS.search(line))]
    return HeatFlowHeader(exothermic_direction(lines), next((m for m in masses if m > 0), None))


def exothermic_direction(lines: Iterable[str]) -> str:
    """The exothermic direction that the first line with one states: "up", "down", or "" for none.

    >>> exothermic_direction(["exothermic\\tUp"]), exothermic_direction(["DSC (endo up)"])
    ('up', 'down')
    """
    for line in lines:
        if match := _DIRECTION.search(line):
            kind, way = match[1], match[2].lower()
        elif match := _ARROW.search(line):
            kind, way = match[2] or match[3], "down" if (match[1] or match[4]) == "↓" else "up"
        else:
            continue
        return way if kind.lower() == "exo" else _OTHER[way]
    return ""
