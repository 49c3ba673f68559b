"""What a file of heat flow says about itself: its exothermic direction and the mass of the sample."""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from smarig.exchange import FoundTable, convert, preamble_lines

_BETWEEN = "direction|dirección|direzione|sens|richtung|vers|le|nach|hacia|verso|il|l"
_WAYS = {
    "up": ("up", "haut", "oben", "arriba", "alto"),
    "down": ("down", "bas", "unten", "abajo", "basso"),
}
_DIRECTION = re.compile(
    rf"\b(exo|endo)\w*\b[^a-z]*(?:(?:{_BETWEEN})\b[^a-z]*)*({'|'.join(sum(_WAYS.values(), ()))})\b",
    re.IGNORECASE,
)
_ARROW = re.compile(r"([\^↑↓])\s*(exo|endo)|(exo|endo)[a-z]*\s*([\^↑↓])", re.IGNORECASE)
_MASS = re.compile(
    r"(?:sample (?:mass|weight)|probenmasse|einwaage|(?:masse|masa|massa) (?:de |del |della |de la |de l['’])?"
    r"(?:[ée]chantillon|muestra|campione)|^\W*(?:mass|masse|masa|massa)\b)"
    r"\W*(?:([mµu]?g)\b\W*)?(\d+(?:[.,]\d+)?)\s*(?:([mµu]?g)\b)?",
    re.IGNORECASE,
)
_SIZE = re.compile(  # a size is a mass by its unit only
    r"^\W*(?:sample )?size\b\W*(?:([mµu]?g)\b\W*)?(\d+(?:[.,]\d+)?)\s*(?:([mµu]?g)\b)?", re.IGNORECASE
)
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
    found = [match for line in lines if (match := _MASS.search(line) or _SIZE.search(line))]
    masses = [_milligrams(match) for match in found if match.re is _MASS or match[1] or match[3]]
    return HeatFlowHeader(exothermic_direction(lines), next((m for m in masses if m > 0), None))


def _milligrams(mass: re.Match[str]) -> float:
    """The mass in the unit that stands before or behind the number, mg without one."""
    return float(convert(float(mass[2].replace(",", ".")), (mass[1] or mass[3] or "mg").lower(), "mg"))


def exothermic_direction(lines: Iterable[str]) -> str:
    """The exothermic direction that the first line with one states: "up", "down", or "" for none.

    >>> exothermic_direction(["exothermic\\tUp"]), exothermic_direction(["DSC (endo up)"])
    ('up', 'down')
    >>> exothermic_direction(["Endotherme : vers le haut"]), exothermic_direction(["Exo nach unten"])
    ('down', 'down')
    """
    for line in lines:
        if match := _DIRECTION.search(line):
            kind, way = match[1], next(way for way, words in _WAYS.items() if match[2].lower() in words)
        elif match := _ARROW.search(line):
            kind, way = match[2] or match[3], "down" if (match[1] or match[4]) == "↓" else "up"
        else:
            continue
        return way if kind.lower() == "exo" else _OTHER[way]
    return ""
