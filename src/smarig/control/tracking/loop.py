"""The closed loop as a protocol: the wire is initialised, a controller drives it along a reference, the end is 0 A.

Whatever a controller asks for is clipped here, once for all: current range, current rate, and what the rig's
temperature limit leaves. A loop that diverges ends the run with zero current. Knows commands; refuses to know rigs.
"""

from smarig.command import Drive, Mark, Protocol
from smarig.control.limits import allowed, let_go
from smarig.control.tracking.asked import Asked
from smarig.control.tracking.known import ControllerMaker, Known
from smarig.control.tracking.reference import Reference
from smarig.control.watch import Patience, Watch
from smarig.protocols.initialise import initialise
from smarig.sample import Sample

CLOSED, OPENED = "closed loop", "loop opened"  # labels of the marks that begin and end it


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
    where the wire is. Raises LimitExceeded when the loop diverges or a controller asks for NaN or infinity, UsageError
    when it asks for what is no number, or for nothing any more.
    """
    setup = known.setup
    if prepare:
        yield from initialise(setup)
    first: Sample = yield Drive(0.0)
    start_s = first.t_s
    yield Mark(CLOSED, {"controller": name, "start_s": start_s, "reference": reference.as_data()})
    watch = Watch(patience or Patience(), known.reach)
    controller = Asked(make, known, lambda t_s: reference.at(t_s - start_s), name)
    asked_A, given_A = controller.first(), first.current_command_A
    for _ in range(max(1, round(reference.duration_s / setup.period_s))):
        given_A = allowed(setup, asked_A, given_A)
        sample: Sample = yield Drive(given_A)
        watch.look(sample.t_s, sample.position - reference.at(sample.t_s - start_s))
        asked_A = controller.after(sample)
    controller.close()
    yield Mark(OPENED)
    yield from let_go(setup, given_A)
