"""The resistance that a heated wire can have, from its phase, as limits for the measured one.

    R(ξ) = R_M + ξ (R_A − R_M)        ξ between heating and cooling branch, at the predicted temperature

The measured resistance contains the measured current, so a shunt that reads low shows as a resistance that is too high:
V/I = k R, with the true current k times the reading. That is the dangerous side, so the upper limit follows the phase.
A temperature from V²/R instead would be wrong by 23 % while the wire is martensite. The lower limit is that of the
whole wire: a wire may still be warm when its host believes it cold.
"""

import numpy as np

from smarig.core import Array
from smarig.plant import Actuator, WirePhases
from smarig.preisach import Everett, Preisach

INPUT_MARGIN = 0.1  # of the range: uncertainty of the predicted temperature
GRID = 200  # points of a branch


class ExpectedResistance:
    """``band_ohm(input_K, current_A)`` is the smallest and the largest plausible resistance.

    ``tolerance``: share of the resistance that it may differ from the actuator's constants.

    >>> wire = ExpectedResistance(Actuator.named("gorbet_one_wire"), tolerance=0.1)
    >>> [round(ohm, 2) for ohm in wire.band_ohm(0.0, 0.5)], [round(ohm, 2) for ohm in wire.band_ohm(170.0, 0.5)]
    ([4.05, 5.5], [4.05, 4.95])
    """

    def __init__(self, actuator: Actuator, tolerance: float) -> None:
        hysteresis = actuator.hysteresis
        limits = two_wire_limits(hysteresis) if actuator.two_wire else [one_wire_limits(hysteresis)]
        self._lowest_K = 0.0 if actuator.two_wire else hysteresis.lower
        ends = (hysteresis.upper, -hysteresis.lower)[: len(limits)]
        self._per_K = [GRID / (end - self._lowest_K) for end in ends]
        low = (1 - tolerance) * actuator.resistance_range_ohm[0]
        self._bands = [[(low, high) for high in _highest_ohm(actuator, tolerance, *x)] for x in limits]
        self.any_phase_ohm = low, max(high for bands in self._bands for _, high in bands)

    def band_ohm(self, input_K: float, current_A: float) -> tuple[float, float]:
        """The limits at a predicted input, for the wire that carries this current.

        Of two wires, it is at least as hot as the input says: T₁ ≥ T₁ − T₂.
        """
        wire = 1 if current_A < 0 and len(self._bands) > 1 else 0
        hot_K = -input_K if wire else input_K
        k = int((hot_K - self._lowest_K) * self._per_K[wire] + 0.5) if hot_K == hot_K else 0
        return self._bands[wire][min(max(k, 0), GRID)]


def without_voltage_text(low_ohm: float, high_ohm: float) -> str:
    """What it means for a rig that its source measures no voltage."""
    return (
        "The source measures no voltage, so nobody sees another wire, a bad clamp, or a shunt that reads low, which "
        "overheats the wire. Check the current with a meter of your own, and the wire with an ohmmeter: "
        f"{low_ohm:.2f} to {high_ohm:.2f} ohm."
    )


def _highest_ohm(actuator: Actuator, tolerance: float, least: Array, most: Array) -> list[float]:
    ends = np.array([[actuator.resistance_at_ohm(xi) for xi in share] for share in (least, most)])
    return ((1 + tolerance) * ends.max(axis=0)).tolist()


def one_wire_limits(hysteresis: Everett) -> tuple[Array, Array]:
    """Least and most austenite of a single wire on a grid of inputs, whatever the history, with a margin of the input.

    Every output lies between the ascending and the descending branch of the major loop.
    """
    lower, upper = hysteresis.lower, hysteresis.upper
    margin_K, u = INPUT_MARGIN * (upper - lower), np.linspace(lower, upper, GRID + 1)
    rising = np.clip(u - margin_K, lower, upper)
    falling = np.clip(u + margin_K, lower, upper)[::-1]
    least = Preisach(hysteresis).simulate(np.concatenate([[lower], rising]), "negative")[1:]
    most = Preisach(hysteresis).simulate(np.concatenate([[upper], falling]), "negative")[1:][::-1]
    span = float(most[-1]) - hysteresis.y_lower
    return (least - hysteresis.y_lower) / span, (most - hysteresis.y_lower) / span


def two_wire_limits(hysteresis: Everett) -> list[tuple[Array, Array]]:
    """The same of each of two wires, on grids of their own temperatures."""
    found = []
    for wire, end in enumerate((hysteresis.upper, -hysteresis.lower)):
        phases, T = WirePhases(hysteresis), np.linspace(0.0, end, GRID + 1)
        margin_K = INPUT_MARGIN * end
        heating = np.maximum(T - margin_K, 0.0)
        cooling = np.minimum(T + margin_K, end)[::-1]
        branches = [np.array([_own(phases, wire, hot_K) for hot_K in path]) for path in (heating, cooling)]
        found.append((branches[0], branches[1][::-1]))
    return found


def _own(phases: WirePhases, wire: int, hot_K: float) -> float:
    phases.step([0.0, hot_K] if wire else [hot_K, 0.0])
    return phases.austenite[wire]
