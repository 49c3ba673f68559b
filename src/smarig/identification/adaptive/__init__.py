"""The choice of the next holds by expected information per minute of rig time (§9.2)."""

from collections.abc import Sequence

from smarig.core import Settled
from smarig.protocols import HoldResult, NextInputs, Setup


def informed_choice(setup: Setup, seen: Sequence[HoldResult], settle: Settled) -> NextInputs:
    """The next inputs to hold, for ``adaptive_fod`` (``next_inputs.informed_choice``).

    The module is imported at the first call: other protocols need no SciPy, which takes half a second to import.
    """
    from smarig.identification.adaptive import next_inputs

    return next_inputs.informed_choice(setup, seen, settle)


informed_choice.__name__ = (
    "informed"  # the name that records of adaptive_fod hold, also those of earlier versions
)
