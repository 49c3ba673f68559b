"""The severity of an event: the four of EPICS. One table gives it by kind; any other kind has that of its level."""

from collections.abc import Iterable, Mapping
from enum import StrEnum
from typing import Any


class Severity(StrEnum):
    """How far an event affects the run, in rising order.

    none      part of a normal run
    minor     the run continues; a look is advised
    major     the run ends, or must be attended to
    invalid   recorded values cannot be trusted, or a device cannot be reached
    """

    NONE = "none"
    MINOR = "minor"
    MAJOR = "major"
    INVALID = "invalid"

    def reaches(self, least: "Severity") -> bool:
        """Whether it is ``least`` or more."""
        return _RANK[self] >= _RANK[least]


_RANK = {severity: rank for rank, severity in enumerate(Severity)}
LEVEL_SEVERITY = {"info": Severity.NONE, "warning": Severity.MINOR, "error": Severity.MAJOR}
KIND_SEVERITY = {  # only kinds whose severity their level does not imply
    "blind": Severity.INVALID,  # the converter of the current returns no reading
    "link": Severity.INVALID,  # a device cannot be reached
    "still_on": Severity.INVALID,  # the source was switched off and may be on: not confirmed, or a current is measured
    "contradiction": Severity.INVALID,  # the reply of a device contradicts what it was ordered
}


def severity_of(kind: str, level: str, data: Mapping[str, Any] | None = None) -> Severity:
    """The severity of an event: the one in its data, else that of its kind, else that of its level.

    >>> str(severity_of("contradiction", "warning")), str(severity_of("lost", "warning"))
    ('invalid', 'minor')
    """
    stated = (data or {}).get("severity")
    if isinstance(stated, str) and stated in set(Severity):
        return Severity(stated)
    return KIND_SEVERITY.get(kind) or LEVEL_SEVERITY.get(level, Severity.NONE)


def highest_severity(severities: Iterable[Severity]) -> Severity:
    """The highest of some severities, "none" if there is none."""
    return max(severities, key=_RANK.__getitem__, default=Severity.NONE)
