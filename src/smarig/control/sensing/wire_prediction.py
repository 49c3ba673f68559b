"""Position, temperatures and phases by the model from the measured current, with the effect of an offset of the input.

The hysteresis is simulated three times: at the input of the heating model, and a few kelvin above and below it. The
differences are the derivatives with respect to an error that has always been there: an offset of the ambient
temperature or of R/hA. Of two wires the ambient cancels, so theirs is in proportion to the temperature, ``offset_K`` at
the end of the range. The derivatives contain the memory: after a reversal an offset changes less. ``lag`` is how far
the prediction lags behind itself after another time constant of the heating, the direction of errors of a wire that
moves later than predicted (latent heat).
"""

from collections.abc import Sequence
from typing import NamedTuple

from smarig.control.sensing.resistance_map import COLD_SHARE, WireCondition
from smarig.plant import Actuator, JouleHeating, WirePhases
from smarig.preisach import Everett, Initial, Preisach


class PredictedWire(NamedTuple):
    """One member of the three: position, and the state of the wire that carries the current."""

    position: float
    wire: WireCondition


class WirePrediction:
    """``step(current_A)`` gives the predictions at errors of the input of 0, ``offset_K`` and −``offset_K``.

    ``corrected(position)`` after every step tells it the best estimate of the position.

    >>> from smarig.preisach import thesis_surface
    >>> model = WirePrediction(Actuator.named("gorbet_one_wire"), thesis_surface("one_e"), "negative", 0.1, 2.0)
    >>> for _ in range(600):
    ...     here, warmer, colder = model.step(0.4)
    >>> colder.position < here.position < warmer.position
    True
    """

    def __init__(
        self, actuator: Actuator, hysteresis: Everett, initial: Initial, period_s: float, offset_K: float
    ) -> None:
        self.offsets_K = (0.0, offset_K, -offset_K)
        self.heating = JouleHeating(actuator, period_s)
        self.lag = 0.0
        self._end_K = max(hysteresis.upper, -hysteresis.lower)
        self._cold_K = COLD_SHARE * self._end_K
        self._operators = [Preisach(hysteresis, initial) for _ in self.offsets_K]
        self._late = self._operators[0].y
        self._cold_positions = [self._late, self._late]
        self._phases = [WirePhases(hysteresis) if actuator.two_wire else None for _ in self.offsets_K]

    def wire_of(self, current_A: float) -> int:
        """0 or 1: the wire that carries a current."""
        return 1 if current_A < 0 and self.heating.two_wire else 0

    def step(self, current_A: float) -> Sequence[PredictedWire]:
        """Advance one tick at a constant current."""
        input_K, wire = self.heating.step(current_A), self.wire_of(current_A)
        first_K, second_K = self.heating.wire_K
        found = []
        for offset_K, operator, phases in zip(self.offsets_K, self._operators, self._phases):
            factor, added_K = (1 + offset_K / self._end_K, 0.0) if phases else (1.0, offset_K)
            y, xi = operator.step(input_K * factor + added_K), 0.0
            own_K = (first_K * factor + added_K, second_K * factor)
            if phases is not None:
                phases.step(own_K)
                xi = phases.austenite[wire]
            found.append(PredictedWire(y, WireCondition(own_K[wire], xi, self._cold_positions[wire])))
        y = found[0].position
        self._late = y + (self._late - y) * self.heating.decay
        self.lag = self._late - y
        return found

    def corrected(self, position: float) -> None:
        """Take a better value of the present position as that of the wires that are cold."""
        for wire, wire_K in enumerate(self.heating.wire_K):
            if wire_K < self._cold_K:
                self._cold_positions[wire] = position
