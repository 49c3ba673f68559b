"""The wire as a plant: current in, position out; heating (5.1) → Preisach (3.1), effects at their stages.

One step is one tick at constant current. Knows no instruments, no noise of theirs, no device.
"""

from collections.abc import Sequence

from smarig.model.actuator import Actuator
from smarig.model.effect import Effect, Hook, Moment, Stage, chain
from smarig.model.heating import Heating
from smarig.preisach.everett import Everett
from smarig.preisach.operator import Initial, Preisach


class Plant:
    """State of the wire(s): temperatures, hysteresis memory, position (rig unit, operator's own zero).

    >>> from smarig.preisach.gorbet_1997 import surface
    >>> plant = Plant(Actuator.named("gorbet_one_wire"), surface("one_e"), "negative", dt_s=0.1)
    >>> for _ in range(1200):
    ...     position_mm = plant.step(1.0)
    >>> round(position_mm, 2)
    12.54
    """

    def __init__(
        self,
        actuator: Actuator,
        hysteresis: Everett,
        initial: Initial,
        dt_s: float,
        effects: Sequence[Effect] = (),
    ) -> None:
        for effect in effects:
            hysteresis = effect.hysteresis(hysteresis)
        self.actuator = actuator
        self.heating = Heating(actuator, dt_s)
        self.operator = Preisach(hysteresis, initial)
        span = hysteresis.everett(hysteresis.upper, hysteresis.lower)
        self._y_lower, self._per_span = hysteresis.y_lower, 1.0 / span if span else 0.0
        self._chains = {stage: chain(effects, stage) for stage in Stage}
        self._plain = not any(self._chains.values())
        self.now = Moment(dt_s=dt_s, output=self.operator.y)
        self.position = self.operator.y

    def step(self, current_A: float, disturbance_K: float = 0.0) -> float:
        """One tick: current held over it, temperature disturbance added to what the hysteresis feels."""
        if self._plain:
            self.position = self.operator.step(self.heating.step(current_A) + disturbance_K)
            return self.position
        return self._step_with_effects(current_A, disturbance_K)

    def _step_with_effects(self, current_A: float, disturbance_K: float) -> float:
        now = self.now
        now.tick += 1
        now.t_s = now.tick * now.dt_s
        now.austenite = self.austenite
        now.current_A = _through(self._chains[Stage.CURRENT], current_A, now)
        source = _through(self._chains[Stage.SOURCE], self.heating.source(now.current_A), now)
        now.input_K = self.heating.relax(source) + disturbance_K
        felt = _through(self._chains[Stage.INPUT], now.input_K, now)
        now.output = self.operator.step(felt)
        mapped = _through(self._chains[Stage.OUTPUT], now.output, now)
        self.position = _through(self._chains[Stage.ADDITIVE], mapped, now)
        return self.position

    def sensed(self, counts: float) -> float:
        """Counts as the sensor sees them, before quantisation."""
        return counts if self._plain else _through(self._chains[Stage.SENSOR], counts, self.now)

    @property
    def austenite(self) -> float:
        """Austenite fraction ξ of wire 1, taken from the output: 0 at y₋, 1 at y₊."""
        return (self.operator.y - self._y_lower) * self._per_span


def _through(hooks: tuple[Hook, ...], value: float, now: Moment) -> float:
    for hook in hooks:
        value = hook(value, now)
    return value
