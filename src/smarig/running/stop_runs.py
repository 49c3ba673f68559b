"""Stops several runs at once, so that each record says who asked."""

import time
from collections.abc import Sequence
from contextlib import suppress

from smarig.core import Requester, UsageError
from smarig.running.run_in_progress import RunInProgress

_LONGEST_S, _LOOK_S = 1.0, 0.02


def stop_runs(runs: Sequence[RunInProgress], who: str, by: Requester) -> None:
    """Ask each run to stop, and then send SIGTERM, which also ends a protocol that computes without returning.

    The signal follows when the runs have taken the request, or after a second: the first cause stands in the record,
    and a signal does not tell who sent it.
    """
    for run in runs:
        with suppress(UsageError):  # it has just ended; the others must be stopped all the same
            run.ask("stop", who, by)
    until_s = time.monotonic() + _LONGEST_S
    while any(map(_goes_on, runs)) and time.monotonic() < until_s:
        time.sleep(_LOOK_S)
    for run in runs:
        run.terminate()


def _goes_on(run: RunInProgress) -> bool:
    with suppress(UsageError):
        return run.alive and not run.status().get("stopping")
    return False
