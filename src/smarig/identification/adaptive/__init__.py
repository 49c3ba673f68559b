"""Choosing the next experiment: expected information per minute of rig time (§9.2)."""

from collections.abc import Sequence

from smarig.core.command import Settled
from smarig.protocols._setup import Setup
from smarig.protocols.adaptive_fod import HoldResult, NextInputs


def informed(setup: Setup, seen: Sequence[HoldResult], settle: Settled) -> NextInputs:
    """``informed_choice.informed``, loaded when it is first asked: most runs need no SciPy, half a second of imports."""
    from smarig.identification.adaptive import informed_choice

    return informed_choice.informed(setup, seen, settle)
