"""The closed loop as a protocol: the wire is initialised, a controller drives it along a reference, the end is 0 A.

Whatever a controller asks for is clipped here, once for all: current range, current rate, and what the rig's
temperature limit leaves. A loop that diverges ends the run with zero current. Knows commands; refuses to know rigs.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from smarig.command import Drive, Mark, Protocol
from smarig.control.limits import allowed
from smarig.control.tracking.known import Controller, Known, Wanted
from smarig.control.tracking.reference import Reference
from smarig.errors import LimitExceeded
from smarig.protocols.initialise import initialise
from smarig.sample import Sample

CLOSED, OPENED = "closed loop", "loop opened"  # labels of the marks that begin and end it

ControllerMaker = Callable[[Known, Wanted], Controller]


@dataclass(frozen=True)
class Patience:
    """When a loop counts as diverged: further off than a share of the range, for so long without coming closer."""

    share: float = 0.3
    seconds: float = 30.0


def track(
    known: Known,
    make: ControllerMaker,
    reference: Reference,
    *,
    name: str = "",
    prepare: bool = True,
    patience: Patience | None = None,
) -> Protocol:
    """Initialise (§5.2.2), close the loop, follow the reference to its end, and let go.

    ``make(known, wanted)`` is a controller; ``name`` is written into the record. Without ``prepare`` it goes on from
    where the wire is. Raises LimitExceeded when the loop diverges or a controller asks for what is no number.
    """
    setup = known.setup
    if prepare:
        yield from initialise(setup)
    first: Sample = yield Drive(0.0)
    start_s = first.t_s
    yield Mark(CLOSED, {"controller": name, "start_s": start_s, "reference": reference.as_data()})
    watch = _Watch(patience or Patience(), known.reach)
    controller = make(known, lambda t_s: reference.at(t_s - start_s))
    asked_A, given_A = next(controller), first.current_command_A
    for _ in range(max(1, round(reference.duration_s / setup.period_s))):
        given_A = allowed(setup, asked_A, given_A)
        sample: Sample = yield Drive(given_A)
        watch.look(sample, reference.at(sample.t_s - start_s))
        asked_A = controller.send(sample)
    controller.close()
    yield Mark(OPENED)
    while given_A:
        given_A = allowed(setup, 0.0, given_A)
        yield Drive(given_A)


class _Watch:
    """Whether the loop still holds the wire."""

    def __init__(self, patience: Patience, reach: tuple[float, float]) -> None:
        self._most = patience.share * (reach[1] - reach[0])
        self._seconds = patience.seconds
        self._least, self._since_s = math.inf, math.nan

    def look(self, sample: Sample, wanted: float) -> None:
        """Raise LimitExceeded after a while of large errors that do not shrink."""
        error = abs(sample.position - wanted)
        if error <= self._most:
            self._least = math.inf
        elif error < 0.9 * self._least:
            self._least, self._since_s = error, sample.t_s
        elif sample.t_s - self._since_s > self._seconds:
            raise LimitExceeded(
                f"The loop diverges: {error:.3g} off what is wanted, and no closer for {self._seconds:g} s. "
                "The current is at zero."
            )
