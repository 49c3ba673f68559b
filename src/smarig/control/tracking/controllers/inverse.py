"""Feed-forward by the inverse of the hysteresis and of the heating lag, with the model's error tracked on the way."""

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
READING_COUNTS = 0.5  # noise of a reading: rounding to counts, and the encoder's own


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
    """Inverse Preisach and heating lag (§8.1's feed-forward), made robust by an observer of the model's error.

    The model, effects included, follows the measured current, or the command where an effect says what becomes of
    it; ``SlopeObserver`` says how far it is off. What is wanted ``lead_s`` from now is turned into an output of the
    model, that into the temperature which the model's memory needs for it, and that into the current which brings
    the wire there in ``horizon_s``, with the time constant and the heat that effects leave it. Within ``rest_counts``
    of where it shall be, the temperature goal stays: a reversal costs the width of a hysteresis; noise is not worth it.

        lead_s (s): how far ahead what is wanted is looked at
        horizon_s (s): time in which the current is to bring the wire to its temperature; short is forceful
        walk (unit/√s): how fast the model's error may wander by itself
        slope_walk (1/√unit): how fast the model's error of slope may change along the way
        rest_counts (counts): nearer than this, the temperature goal stays
    """
    setup, model = controller_model.setup, controller_model.plant()
    count = setup.actuator.position_per_count(controller_model.counts_per_rev)
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
        # effects may shift what the hysteresis feels against what the wire has: asked of the wire is the same move
        move_K = goal_K - model.hysteresis_input_K
        wire_K = model.heating.input_K
        sample = yield current_towards(setup, model, clipped(setup, wire_K + move_K), horizon_s)


def _temperature_for_output(operator, output: float, fallback_K: float) -> float:
    """Temperature that brings the operator to an output, as far as it reaches; the goal before where none does."""
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
    except DataError:  # the branch turns back on the way: stay, the observer will tell more
        return fallback_K
