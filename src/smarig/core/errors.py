"""Errors by cause, each with an exit status and a message that states what to do."""

from typing import Self

from smarig.core.shown_text import one_line

AT_ZERO = "The current is at zero."

# What float and numpy raise for values that they cannot convert; the last one for integers of over 308 digits.
NOT_NUMBERS = (TypeError, ValueError, OverflowError)


class SmarigError(Exception):
    """Base class of all errors that smarig raises on purpose. ``exit_status`` is the exit status of the CLI.

    ``current_text`` is a sentence about the current of a rig, which ends the message. Whoever switches the rig off
    replaces it.

    >>> error = LimitExceeded("Too hot.").at_zero()
    >>> str(error)
    'Too hot. The current is at zero.'
    >>> error.current_text = "0.7 A is still measured: switch it off by hand now."
    >>> str(error)
    'Too hot. 0.7 A is still measured: switch it off by hand now.'
    """

    exit_status = 1
    current_text = ""

    def at_zero(self) -> Self:
        """This error, as one that ends a run at zero current."""
        self.current_text = AT_ZERO
        return self

    def __str__(self) -> str:
        text = super().__str__()
        if not self.current_text or self.current_text in text:  # a driver may have said so itself
            return text
        return f"{text} {self.current_text}"


class UsageError(SmarigError):
    """The user requested something that does not exist or cannot be done (exit 2)."""

    exit_status = 2


class ConfigError(UsageError):
    """A configuration file is wrong: names the file, the key and the expected value (exit 2)."""


class UnknownEntry(UsageError):
    """A catalogue has no entry of a name (exit 2)."""


class NotPassed(UsageError):
    """A file names what it may not; nothing of it was opened (exit 2). ``text`` is what it names."""

    def __init__(self, sentence: str, text: str) -> None:
        super().__init__(sentence)
        self.text = text


class MissingExtra(UsageError):
    """A package of one of smarig's extras is not installed (exit 2). ``extra`` names the extra."""

    def __init__(self, subject: str, extra: str) -> None:
        super().__init__(f"{subject} needs the extra '{extra}': pip install 'smarig[{extra}]'.")
        self.extra = extra


class RigFault(SmarigError):
    """The rig tripped, refused a command, or could not be reached (exit 3). Its driver may have chosen the words, which
    are shown on one line.
    """

    exit_status = 3

    def __init__(self, *given: object) -> None:
        super().__init__(*(one_line(part) if isinstance(part, str) else part for part in given))


class LimitExceeded(RigFault):
    """A command or a predicted temperature exceeds the rig's limits (exit 3)."""


class LeaseExpired(RigFault):
    """The device received no command in time and switched its output off (exit 3)."""


class DataError(SmarigError):
    """Measured data or a data file is wrong or unusable (exit 4)."""

    exit_status = 4


class StorageError(DataError):
    """A run could not be written: the disk is full, or the folder is missing or not writable (exit 4)."""


class InUse(SmarigError):
    """Another process uses the wire, the line of a device, or the run file (exit 5)."""

    exit_status = 5


class Interrupted(SmarigError):
    """A user or the system requested a stop; the rig is safe (exit 130). ``remedy`` states how to continue."""

    exit_status = 130
    remedy = "'smarig resume' continues it."
