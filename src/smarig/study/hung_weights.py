"""The load of a weight that hangs on a wire, where a name or a title states its mass, as "500 g" does."""

import re
from typing import NamedTuple

from smarig.exchange import convert

_GRAVITY = 9.80665  # m/s²
_MASS = re.compile(  # no factor or summand, and nothing per metre or minute
    r"(?<![\w.,+×*·])(?<![x+×*·]\s)(\d+(?:[.,]\d+)?)\s*_?(k?g)(?![\w/·*²+]|\s*[+/])"
)
_OTHER = re.compile(  # a mass of the specimen, the range of a sensor, an acceleration
    r"(sample|specimen|wire|proben?|draht)[\s_-]*(mass|weight|gewicht)|einwaage|cell|sensor|aufnehmer|dose|capteur"
    r"|max|limit|accel|beschleunigung|vibration",
    re.IGNORECASE,
)


class HungWeight(NamedTuple):
    """The force of a weight in N, and its mass as it is written."""

    newtons: float
    mass: str

    def __str__(self) -> str:
        return f"{self.newtons:.3g} N, the weight of {self.mass}"


def hung_weight(text: str) -> HungWeight | None:
    """The one weight that a text states; None if it states no mass, several, or that of something else.

    >>> str(hung_weight("wire_3_1.5kg")), hung_weight("sample mass 2 g"), hung_weight("2 x 500 g")
    ('14.7 N, the weight of 1.5 kg', None, None)
    """
    found = set(_MASS.findall(text.replace("_", " ")))
    if len(found) != 1 or _OTHER.search(text):
        return None
    ((value, unit),) = found
    kilograms = float(convert(float(value.replace(",", ".")), unit, "kg"))
    return HungWeight(kilograms * _GRAVITY, f"{value} {unit}")
