"""Units of records of ROS messages, which are in SI units by convention (REP 103)."""

import re
from collections.abc import Sequence

from smarig.study import quantity_words as q

_STAMP = re.compile(r"(.*[./])?header[./]stamp([./]\w+)?")
_SI = {
    q.DISPLACEMENT: "m",
    q.ANGLE: "rad",
    q.FORCE: "N",
    q.PRESSURE: "Pa",
    q.STRESS: "Pa",
    q.FIELD: "T",
    q.CURRENT: "A",
    q.VOLTAGE: "V",
}
REASON = "messages of ROS are in SI units (REP 103)"


def are_messages(names: Sequence[str]) -> bool:
    """Whether names of columns are those of messages with a header.

    >>> are_messages(["%time", "field.header.stamp", "field.x"]), are_messages(["time", "stamp"])
    (True, False)
    """
    return any(_STAMP.fullmatch(name) for name in names)


def si_unit(quantity: str) -> str:
    """The SI unit of a quantity in a message, "" for one that has no fixed unit there."""
    return _SI.get(quantity, "")
