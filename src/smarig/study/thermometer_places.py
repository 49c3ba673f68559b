"""Which of several temperatures is that of the specimen: by the place or the purpose that its name states."""

import re

from smarig.study.column_guess import ColumnGuess

_SPECIMEN = re.compile(
    r"sample|specimen|probe|wire|draht|echantillon|muestra|campione|workpiece|proben|\bpv\b|^t ?s\b",  # ISO 11357: T_s
    re.IGNORECASE,
)
_SURROUNDINGS = re.compile(
    r"oven|ofen|furnace|four\b|forno|horno|chamber|kammer|air|luft|bath|(?<![a-z])bad|heater|heiz|"
    r"cryostat|kryostat|system|block",
    re.IGNORECASE,
)


def distance(c: ColumnGuess) -> int:
    """How far a temperature is from the specimen: 0 at it, 1 where no name says so, 2 in what surrounds it, 3 for a
    set-point, which nothing measured.
    """
    words = re.sub(r"[_\W]+", " ", f"{c.label} {c.facts.comment}")
    if c.commanded:
        return 3
    if _SPECIMEN.search(words):
        return 0
    return 2 if _SURROUNDINGS.search(words) else 1
