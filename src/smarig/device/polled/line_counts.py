"""What the line of a queried instrument tells: its attribute ``line`` (TextLine, VisaLine), if it has one."""

from typing import Any

from smarig.device.encoding.link_faults import Garbled


def repeats_of(instrument: Any) -> int:
    """How many queries were asked once more, because the first was not answered."""
    return int(getattr(getattr(instrument, "line", None), "repeats", 0))


def reconnections_of(instrument: Any) -> int:
    """How often the line was lost and opened again; an instrument may count that itself."""
    of_line = getattr(getattr(instrument, "line", None), "reconnections", 0)
    return int(getattr(instrument, "reconnections", of_line))


def garbled_remedy(instrument: Any) -> str:
    """The remedy for garbled replies that fits the line of an instrument."""
    return Garbled.remedy_at(str(getattr(getattr(instrument, "line", None), "where", "")))
