"""Baseline with gains by position and direction: PI whose gain follows the inverse slope of the present branch."""

import numpy as np

from smarig.control.tracking.controller_model import Controller, ControllerModel, ReferenceFunction
from smarig.control.tracking.pi_feedback import pi_feedback
from smarig.preisach import Preisach

RANGES = {
    "gain_share": (0.05, 100.0),
    "integral_s": (0.1, 200.0),
    "cooling_share": (0.1, 10.0),
}
GRID_POINTS = 200
LARGEST_SLOPE_RATIO = 10.0  # times the mean inverse slope: branches are flat at the ends of the range


def gain_scheduled(
    controller_model: ControllerModel,
    reference: ReferenceFunction,
    *,
    gain_share: float = 55.0,
    integral_s: float = 0.75,
    cooling_share: float = 1.7,
    lead_s: float = 0.0,
) -> Controller:
    """PI with scheduled gains: du/dy of the rising or falling branch of the model's major loop at the present position.

    The thesis cites constant gains switched by the error (Grant & Hayward 1997). Here the error's sign switches, with
    ``cooling_share`` between the two gains, in addition to the model's slope. Integration is as in ``pi``.

        gain_share (1): gain, as a multiple of the model's inverse slope du/dy at the present position
        integral_s (s): integral time T_i
        cooling_share (1): gain when the wire must cool, as a multiple of that when it must heat
        lead_s (s): preview time of the reference; 0: no preview
    """
    positions, heating, cooling = _inverse_slopes(controller_model)

    def gain(error: float, position: float) -> float:
        slopes, share = (heating, 1.0) if error > 0 else (cooling, cooling_share)
        return gain_share * share * float(np.interp(position, positions, slopes))

    return pi_feedback(controller_model, reference, gain, integral_s=integral_s, lead_s=lead_s)


def _inverse_slopes(controller_model: ControllerModel) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions (n,), and du/dy (n,) of the rising and of the falling branch there, K per unit."""
    u = np.linspace(controller_model.setup.lower_K, controller_model.setup.upper_K, GRID_POINTS)
    operator = Preisach(controller_model.hysteresis, "negative")
    rising, falling = operator.simulate(u), operator.follow(u[::-1])[::-1]
    low, high = controller_model.reach
    positions = np.linspace(low, high, GRID_POINTS)[1:-1]
    largest_slope = LARGEST_SLOPE_RATIO * (u[-1] - u[0]) / (high - low)
    found = []
    for branch in (rising, falling):
        input_at_position = np.interp(positions + controller_model.origin, np.maximum.accumulate(branch), u)
        found.append(np.clip(np.gradient(input_at_position, positions), 0.0, largest_slope))
    return positions, found[0], found[1]
