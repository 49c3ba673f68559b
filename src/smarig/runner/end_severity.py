"""The severity of the end of a run, from the error that ended it."""

from smarig.core import Interrupted, Severity
from smarig.device import LinkFault


def end_severity(error: BaseException | None) -> Severity:
    """None for a normal end, minor for a requested one, invalid if a device was lost, otherwise major."""
    if error is None:
        return Severity.NONE
    if isinstance(error, Interrupted | KeyboardInterrupt):
        return Severity.MINOR
    return Severity.INVALID if isinstance(error, LinkFault) else Severity.MAJOR
