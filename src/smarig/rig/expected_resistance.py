"""The resistance that a heated wire can have, from its phase, as limits for the measured one.

    R(ξ) = R_M + ξ (R_A − R_M)        ξ between both branches of the major loop, at the predicted input

The measured resistance contains the measured current, so a shunt that reads low shows as a resistance that is too
high: V/I = k R, with the true current k times the reading. That is the dangerous side, so the upper limit follows the
phase. The lower limit is that of the whole wire: a wire may still be warm when its host believes it cold.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.plant import Actuator
from smarig.preisach import Everett, Preisach, thesis_surface

INPUT_MARGIN = 0.1  # of the range: uncertainty of the predicted input
GRID = 200  # points of the major loop


class ExpectedResistance:
    """``band_ohm(input_K, current_A)`` is the smallest and the largest plausible resistance.

    ``tolerance``: share of the resistance that it may differ from the actuator's constants.

    >>> wire = ExpectedResistance(Actuator.named("gorbet_one_wire"), tolerance=0.1)
    >>> [round(ohm, 2) for ohm in wire.band_ohm(0.0, 0.5)], [round(ohm, 2) for ohm in wire.band_ohm(170.0, 0.5)]
    ([4.05, 5.5], [4.05, 4.95])
    """

    def __init__(self, actuator: Actuator, tolerance: float) -> None:
        hysteresis = thesis_surface(actuator.file.hysteresis.surface)
        self._lower_K, range_K = hysteresis.lower, hysteresis.upper - hysteresis.lower
        self._per_K = GRID / range_K
        least, most = austenite_limits(hysteresis, INPUT_MARGIN * range_K)
        self._first = self._bands(actuator, tolerance, least, most)
        self._second = self._bands(actuator, tolerance, 1 - most, 1 - least)
        self._two_wire = actuator.two_wire
        lows, highs = zip(*self._first, *self._second)
        self.any_phase_ohm = min(lows), max(highs)

    @staticmethod
    def _bands(
        actuator: Actuator, tolerance: float, least: NDArray[np.float64], most: NDArray[np.float64]
    ) -> list[tuple[float, float]]:
        ends = np.array([[actuator.resistance_at_ohm(xi) for xi in share] for share in (least, most)])
        low = (1 - tolerance) * actuator.resistance_range_ohm[0]
        return [(low, high) for high in ((1 + tolerance) * ends.max(axis=0)).tolist()]

    def band_ohm(self, input_K: float, current_A: float) -> tuple[float, float]:
        """The limits at a predicted input, for the wire that carries this current."""
        bands = self._second if self._two_wire and current_A < 0 else self._first
        k = int((input_K - self._lower_K) * self._per_K + 0.5) if input_K == input_K else 0
        return bands[min(max(k, 0), GRID)]


def austenite_limits(hysteresis: Everett, margin_K: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Least and most austenite of wire 1 on a grid of inputs, whatever the history, with a margin of the input.

    Every output lies between the ascending and the descending branch of the major loop.
    """
    lower, upper = hysteresis.lower, hysteresis.upper
    u = np.linspace(lower, upper, GRID + 1)
    rising = np.clip(u - margin_K, lower, upper)
    falling = np.clip(u + margin_K, lower, upper)[::-1]
    least = Preisach(hysteresis).simulate(np.concatenate([[lower], rising]), "negative")[1:]
    most = Preisach(hysteresis).simulate(np.concatenate([[upper], falling]), "negative")[1:][::-1]
    span = float(most[-1]) - hysteresis.y_lower
    return (least - hysteresis.y_lower) / span, (most - hysteresis.y_lower) / span
