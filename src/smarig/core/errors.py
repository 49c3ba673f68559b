"""Errors by blame, each with an exit status and a sentence a lab person can act on.

Knows: whose fault it was. Refuses to know: how the error is printed, or what the rig does about it.
"""


class SmarigError(Exception):
    """Base of everything smarig raises on purpose; ``exit_status`` is the CLI's exit code."""

    exit_status = 1


class UsageError(SmarigError):
    """The user asked for something that does not exist or cannot be done (exit 2)."""

    exit_status = 2


class ConfigError(UsageError):
    """A configuration file is wrong: names file, key, what was expected (exit 2)."""


class RigFault(SmarigError):
    """The rig tripped, refused, or could not be reached (exit 3)."""

    exit_status = 3


class LimitExceeded(RigFault):
    """A command or a predicted temperature would leave the rig's limits (exit 3)."""


class LeaseExpired(RigFault):
    """The device was not spoken to in time and has switched its output off (exit 3)."""


class DataError(SmarigError):
    """Measured data or a data file is wrong or unusable (exit 4)."""

    exit_status = 4


class StorageError(DataError):
    """A run could not be written: disk full, directory gone, not writable (exit 4)."""


class Interrupted(SmarigError):
    """A person or the system asked to stop; the rig is safe (exit 130). ``remedy``: how to go on."""

    exit_status = 130
    remedy = "'smarig resume' goes on with it."
