"""The period of the rows where no column is a clock: what the lines before a table state."""

import re
from collections.abc import Mapping

from smarig.exchange import convert, dimension, known_unit

_PERIOD = re.compile(
    r"sampl\w*[ _-]*(?:time|period|interval)|(?:time[ _-]*)?(?:increment|step)|dt|abtastzeit|abtastintervall",
    re.IGNORECASE,
)
_VALUE = re.compile(r"([+]?\d+(?:[.,]\d*)?(?:[eE][+-]?\d+)?)\s*(\S*)")
_KEY = re.compile(r"(.*?)\s*[\[(]([^\])]*)[\])]")


def row_period(header: Mapping[str, str]) -> tuple[str, float] | None:
    """The key that states the time from row to row, and that time in seconds; None if no key does.

    >>> row_period({"SAMPLE_TIME": "0.005"}), row_period({"Sample Interval (ms)": "20"}), row_period({"Step": "3 N"})
    (('SAMPLE_TIME', 0.005), ('Sample Interval (ms)', 0.02), None)
    """
    for key, text in header.items():
        words, unit = match.groups() if (match := _KEY.fullmatch(key)) else (key, "")
        value = _VALUE.fullmatch(text.strip())
        if not _PERIOD.fullmatch(words.strip()) or value is None:
            continue
        unit = known_unit(unit or value[2] or "s")
        seconds = float(value[1].replace(",", "."))
        if dimension(unit) == "time" and seconds > 0:
            return key, float(convert(seconds, unit, "s"))
    return None
