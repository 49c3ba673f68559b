"""Feed-forward by the inverse of hysteresis and heating lag, with an observer of the model error."""

from smarig.control.tracking.controller_model import Controller, ControllerModel, ReferenceFunction
from smarig.control.tracking.heating_lag import clipped, current_towards
from smarig.control.tracking.slope_observer import SlopeObserver
from smarig.core import DataError

RANGES = {
    "lead_s": (0.05, 3.0),
    "horizon_s": (0.1, 5.0),
    "walk": (1e-4, 1.0),
    "slope_walk": (0.01, 5.0),
    "rest_counts": (0.01, 1.0),
}
READING_COUNTS = 0.5  # noise of a reading: rounding to counts and encoder noise


def inverse(
    controller_model: ControllerModel,
    reference: ReferenceFunction,
    *,
    lead_s: float = 0.31,
    horizon_s: float = 0.32,
    walk: float = 0.022,
    slope_walk: float = 0.56,
    rest_counts: float = 0.28,
) -> Controller:
    """Inverse Preisach operator and heating lag (feed-forward of §8.1) with an observer of the model error.

    The model, effects included, follows the measured current, or the command if an effect alters the current.
    ``SlopeObserver`` estimates the model error. The reference ``lead_s`` ahead is converted to an output of the model,
    then to the temperature that the model's memory requires, then to the current that brings the wire there in
    ``horizon_s``, with the time constant and heat that effects leave. Within ``rest_counts`` of the target, the target
    temperature stays, because a reversal costs the width of the hysteresis and noise does not justify it.

        lead_s (s): preview time of the reference
        horizon_s (s): time in which the current brings the wire to its target temperature
        walk (unit/√s): random change of the model error with time
        slope_walk (1/√unit): random change of the model's slope error with travel
        rest_counts (counts): position error below which the target temperature stays
    """
    setup, model = controller_model.setup, controller_model.plant()
    count = controller_model.position_per_count
    low, high = controller_model.reach
    observer = SlopeObserver.at(controller_model.origin, high - low, READING_COUNTS * count, walk, slope_walk)
    goal_K = model.hysteresis_input_K
    sample = yield setup.current_for(goal_K)
    while True:
        position = model.step(sample.current_command_A if model.alters_current else sample.current_A)
        observer = observer.updated(sample.position + controller_model.origin, position, setup.period_s)
        target = observer.model_for(reference(sample.t_s + lead_s) + controller_model.origin)
        if abs(target - position) > rest_counts * count:
            goal_K = _temperature_for_output(model.operator, model.operator.y + target - position, goal_K)
        # effects may shift the hysteresis input against the wire temperature: command the same change of the wire
        move_K = goal_K - model.hysteresis_input_K
        wire_K = model.heating.input_K
        sample = yield current_towards(setup, model, clipped(setup, wire_K + move_K), horizon_s)


def _temperature_for_output(operator, output: float, fallback_K: float) -> float:
    """Temperature at which the operator has an output, within its range; the previous target if there is none."""
    hysteresis = operator.hysteresis
    low, high = (
        hysteresis.y_lower,
        hysteresis.y_lower + hysteresis.everett(hysteresis.upper, hysteresis.lower),
    )
    if output <= low:
        return hysteresis.lower
    if output >= high:
        return hysteresis.upper
    try:
        return operator.inverse(output)
    except DataError:  # the branch turns back: stay until the observer has converged
        return fallback_K
