"""Which of several temperatures is that of the specimen: by the place or the purpose that its name states."""

import re

from smarig.study.column_guess import ColumnGuess
from smarig.study.quantity_words import without_accents

IN_INSTRUMENT = 3
_SPECIMEN = re.compile(
    r"sample|specimen|probe|wire|draht|echantillon|muestra|campione|workpiece|proben|\bpv\b|^t ?s\b|"  # ISO 11357: T_s
    r"\bsma\b|nitinol",
    re.IGNORECASE,
)
_SURROUNDINGS = re.compile(
    r"oven|ofen|furnace|four\b|forno|horno|chamber|kammer|air|luft|bath|(?<![a-z])bad|heater|heiz|"
    r"cryostat|kryostat|system|block",
    re.IGNORECASE,
)
_HOLDER = re.compile(  # what holds the specimen, and moves or warms less than it
    r"\bframe|rahmen|gestell|\bbati\b|holder|halter|\bgrips?\b|clamp\b|klemme|einspann|spannbacke|\bjaws?\b|"
    r"\bmors\b|fixture|crosshead|cross head|traverse|\btelaio\b|bastidor|mordaza",
    re.IGNORECASE,
)
_INSTRUMENT = re.compile(
    r"\bp ?temp|panel|board|platine|intern|(reference|ref|cold) ?junction|vergleichsstelle|\bcjc?\b|logger|enclosure|"
    r"(device|chip|cpu|instrument|ger(a|ä)te) ?temp",
    re.IGNORECASE,
)


def distance(c: ColumnGuess) -> int:
    """How far a temperature is from the specimen: 0 at it, 1 where no name says so, 2 in what surrounds it, 3 in the
    instrument that reads the others, 4 for a set-point, which nothing measured.
    """
    words = _words(c)
    if c.commanded:
        return 4
    if _SPECIMEN.search(words):
        return 0
    if _INSTRUMENT.search(words):
        return IN_INSTRUMENT
    return 2 if _SURROUNDINGS.search(words) or _HOLDER.search(words) else 1


def is_of_holder(c: ColumnGuess) -> bool:
    """Whether a name says that a reading is of a frame or a grip, which hold the specimen."""
    return _HOLDER.search(_words(c)) is not None


def _words(c: ColumnGuess) -> str:
    return re.sub(r"[_\W]+", " ", without_accents(f"{c.label} {c.facts.comment}"))
