"""The tracking loop as a protocol: initialise the wire, let a controller follow a reference, end at 0 A.

Every command of a controller is clipped here to the current range, the current rate and the rig's temperature limit. A
loop that diverges ends the run with zero current.
"""

from smarig.control.current_limits import limited_current, ramp_to_zero
from smarig.control.divergence_monitor import DivergenceLimits, DivergenceMonitor
from smarig.control.tracking.checked_controller import CheckedController
from smarig.control.tracking.controller_model import ControllerFactory, ControllerModel
from smarig.control.tracking.reference import Reference
from smarig.core import Drive, Mark, Protocol, Sample
from smarig.protocols import initialise

TRACKING_LOOP_CLOSED, TRACKING_LOOP_OPENED = (
    "closed loop",
    "loop opened",
)  # labels of the marks at start and end


def track(
    controller_model: ControllerModel,
    make: ControllerFactory,
    reference: Reference,
    *,
    name: str = "",
    prepare: bool = True,
    divergence_limits: DivergenceLimits | None = None,
) -> Protocol:
    """Initialise (§5.2.2), close the loop, follow the reference to its end, and open the loop.

    ``make(known, wanted)`` makes a controller; ``name`` is recorded. Without ``prepare`` the loop starts from the
    present state. Raises LimitExceeded if the loop diverges or a controller commands NaN or infinity, UsageError if it
    yields something other than a number or ends.
    """
    setup = controller_model.setup
    if prepare:
        yield from initialise(setup)
    first: Sample = yield Drive(0.0)
    start_s = first.t_s
    yield Mark(
        TRACKING_LOOP_CLOSED, {"controller": name, "start_s": start_s, "reference": reference.as_data()}
    )
    divergence_monitor = DivergenceMonitor(divergence_limits or DivergenceLimits(), controller_model.reach)
    controller = CheckedController(make, controller_model, lambda t_s: reference.at(t_s - start_s), name)
    commanded_A, applied_A = controller.first(), first.current_command_A
    for _ in range(max(1, round(reference.duration_s / setup.period_s))):
        applied_A = limited_current(setup, commanded_A, applied_A)
        sample: Sample = yield Drive(applied_A)
        divergence_monitor.check(sample.t_s, sample.position - reference.at(sample.t_s - start_s))
        commanded_A = controller.after(sample)
    controller.close()
    yield Mark(TRACKING_LOOP_OPENED)
    yield from ramp_to_zero(setup, applied_A)
