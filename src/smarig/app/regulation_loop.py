"""Set-point regulation on a rig with a model from a file. The arguments are checked before any current
flows."""

from collections.abc import Mapping
from functools import partial
from typing import Any

from smarig.app.loop_model import ClosedLoop, ModelSource, check_arguments, controller_model_for
from smarig.config import RigFile
from smarig.control import (
    SETPOINT_CONTROLLERS,
    START_STATES,
    TRACKING_CONTROLLERS,
    VELOCITY_CONTROLLERS,
    PositionObserver,
    ResistanceFeedback,
    SelfSensing,
    SetpointController,
    check_times,
    finite_number,
    optional_numbers,
)
from smarig.control import regulate as regulation_protocol
from smarig.core import UsageError, catalogue_entry, catalogue_names, suggestion
from smarig.protocols import Setup
from smarig.replay import Model

FEEDBACKS = ("encoder", "resistance")


def regulation(
    source: ModelSource,
    rig: RigFile,
    setpoint: float,
    *,
    within: float = 0.01,
    hold_s: float = 600.0,
    start: str = "diagonal",
    disturbance_K: float = 0.0,
    controller: str = "pi",
    numbers: Mapping[str, Any] | None = None,
    feedback: str = "encoder",
) -> ClosedLoop:
    """The closed loop that goes to the state with output ``setpoint`` (model's scale) and holds it.

    ``feedback``: "encoder", or "resistance" for the position observed from the wire's resistance.
    Raises UsageError for arguments that do not suit the model or the rig.
    """
    check_arguments(controller, numbers)
    model, controller_model = source.model, controller_model_for(source.model, rig)
    setup = controller_model.setup
    low, high = (end + controller_model.origin for end in controller_model.reach)
    y = finite_number("The set-point", setpoint)
    count = setup.actuator.resolution(rig.encoder)
    if not low - count <= y <= high + count:
        raise UsageError(
            f"The set-point {y:g} {model.unit} is out of reach. This model on this rig reaches from {low:.4g} to "
            f"{high:.4g} {model.unit}."
        )
    y = min(max(y, low), high)  # one count is the resolution of the rig
    if start not in START_STATES:
        raise UsageError(f"start must be one of {', '.join(START_STATES)}, not '{start}'.")
    push_K, share = finite_number("The disturbance", disturbance_K), finite_number("within", within)
    _check_push(push_K, setup)
    check_times(setup, finite_number("hold_s", hold_s), push_K)
    loop = _regulator(controller, numbers or {}, setup, model, count)
    sensing = _sensing(feedback, model, setup)
    recorded_settings = {
        "setpoint": y,
        "within": share,
        "hold_s": hold_s,
        "start": start,
        "disturbance_K": push_K,
    }

    def make(rig_setup: Setup, used: SelfSensing | None = sensing):
        return regulation_protocol(
            rig_setup,
            hysteresis=model.hysteresis,
            setpoint=y,
            within=share,
            hold_s=float(hold_s),
            start=start,
            loop=loop,
            disturbance_K=push_K,
            feedback=_feedback(used, rig_setup, model) if used else None,
        )

    recorded_settings |= {"controller": controller, **loop.settings()}
    recorded_settings |= {"feedback": feedback} if sensing else {}
    return ClosedLoop(
        "regulate",
        make,
        source.settings() | recorded_settings,
        " ".join(filter(None, (loop.statement(), _below_resolution(y, low, count, model.unit)))),
        partial(make, used=None) if sensing else None,
    )


def _below_resolution(y: float, low: float, count: float, unit: str) -> str:
    """A warning for a set-point that the sensor hardly distinguishes from the cold wire; "" for others."""
    if y - low >= count:
        return ""
    return (
        f"The set-point {y:.4g} {unit} lies within one count ({count:.3g} {unit}) of the lower end of the range, "
        f"{low:.4g} {unit}: readings hardly distinguish it from the cold wire."
    )


def _sensing(feedback: str, model: Model, setup: Setup) -> SelfSensing | None:
    """The self-sensing of a model, None for the feedback of an encoder."""
    if feedback not in FEEDBACKS:
        raise UsageError(f"feedback must be one of {', '.join(FEEDBACKS)}, not '{feedback}'.")
    if feedback == "encoder":
        return None
    if not model.self_sensing:
        raise UsageError(
            f"Model {model.name} has no self-sensing, so the resistance tells it no position. Add it with "
            "smarig sense MODEL RUN… -o NEW.model.json."
        )
    sensing = SelfSensing.from_json(model.self_sensing)
    if len(sensing.wires) != (2 if setup.two_wire else 1):
        raise UsageError(f"The self-sensing of model {model.name} is of a rig with another number of wires.")
    return sensing


def _feedback(sensing: SelfSensing, setup: Setup, model: Model) -> ResistanceFeedback:
    observer = PositionObserver(sensing, setup.actuator, model.hysteresis, "negative", setup.period_s)
    return ResistanceFeedback(observer, setup.period_s)


def _check_push(push_K: float, setup: Setup) -> None:
    range_K = setup.upper_K - setup.lower_K
    if abs(push_K) > range_K:
        raise UsageError(
            f"A disturbance of {push_K:g} K exceeds this rig's whole range, {range_K:.4g} K. Give a smaller one."
        )


def _regulator(
    name: str, pairs: Mapping[str, Any], setup: Setup, model: Model, count: float
) -> SetpointController:
    """The set-point controller of the catalogue with its numbers; those not given are set by the model."""
    known = catalogue_names(SETPOINT_CONTROLLERS)
    if name not in known:
        raise UsageError(
            f"No regulating controller '{name}'{suggestion(name, known)}. "
            f"The controllers {', '.join(catalogue_names(TRACKING_CONTROLLERS))} track a position, and "
            f"{', '.join(catalogue_names(VELOCITY_CONTROLLERS))} its velocity: smarig track --controller."
        )
    allowed = list(optional_numbers(SETPOINT_CONTROLLERS, name))
    numbers = {}
    for key, value in pairs.items():
        if key not in allowed:
            raise UsageError(f"Controller '{name}' has no parameter '{key}'{suggestion(key, allowed)}.")
        numbers[key] = finite_number(f"Controller '{name}', {key}", value)
        if numbers[key] < 0 or (numbers[key] == 0 and key == "gain"):
            at_least = "must be positive" if key == "gain" else "must not be negative"
            raise UsageError(f"Controller '{name}': {key} {at_least} (given: {value}).")
    return catalogue_entry(SETPOINT_CONTROLLERS, name)(setup, model.hysteresis, count, **numbers)
