"""The wire as a plant: current in, position out; heating (5.1) → Preisach (3.1), effects at their stages.

One step is one tick at constant current. Knows no instruments, no noise of theirs, no device.
"""

from collections.abc import Sequence

from smarig.model.actuator import Actuator
from smarig.model.effect import Effect, Moment, Setup, Stage, chains
from smarig.model.feedback import agreed
from smarig.model.warming import Warming, through
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
        self.actuator = actuator
        self.operator = Preisach(hysteresis, initial)
        span = hysteresis.everett(hysteresis.upper, hysteresis.lower)
        self._y_lower, self._per_span = hysteresis.y_lower, 1.0 / span if span else 0.0
        self._chains = chains(effects, Setup(actuator, hysteresis, initial))
        self._plain = not any(self._chains.values())
        self.now = Moment(dt_s=dt_s, output=self.operator.y, austenite=self.austenite)
        self._warming = Warming(actuator, self._chains, self.now)
        self.heating = self._warming.heating
        self.position = through(self._chains[Stage.OUTPUT], self.operator.y, self.now)  # where it rests

    def step(self, current_A: float, disturbance_K: float = 0.0) -> float:
        """One tick: current held over it, temperature disturbance added to what the hysteresis feels."""
        if self._plain:
            self.position = self.operator.step(self.heating.step(current_A) + disturbance_K)
            return self.position
        self.now.tick += 1
        return self._with_effects(current_A, disturbance_K, self.now.tick * self.heating.dt_s)

    def advance(self, current_A: float, dt_s: float, disturbance_K: float = 0.0) -> float:
        """As ``step``, for a time of any length."""
        if self._plain:
            self.heating.tick(dt_s)
            return self.step(current_A, disturbance_K)
        parts = self._warming.parts(current_A, dt_s)
        self.now.dt_s = dt_s / parts
        start_s = self.now.t_s
        for k in range(1, parts + 1):
            self._with_effects(current_A, disturbance_K, start_s + dt_s * k / parts)
        self.now.dt_s = dt_s  # the sensor sees whole ticks
        return self.position

    def _with_effects(self, current_A: float, disturbance_K: float, t_s: float) -> float:
        now, at = self.now, self._chains
        self._warming.felt(current_A, disturbance_K, t_s)
        before, now.output = now.output, self._moved()
        now.austenite = self.austenite
        now.travel += abs(now.output - before) * self._per_span
        mapped = through(at[Stage.OUTPUT], now.output, now)
        self.position = through(at[Stage.ADDITIVE], mapped, now)
        return self.position

    def _moved(self) -> float:
        """The output at what is felt; where that depends on the output, at the first temperature that both agree on."""
        hooks, now, operator = self._chains[Stage.FEEDBACK], self.now, self.operator
        if not hooks:
            return operator.step(now.felt_K)
        given_K = now.felt_K

        def felt(u: float, *, y: float) -> float:
            now.austenite = (y - self._y_lower) * self._per_span
            return through(hooks, given_K, now) - u

        now.felt_K = agreed(lambda u: felt(u, y=operator.peek(u)), operator.u, felt(operator.u, y=operator.y))
        return operator.step(now.felt_K)

    def sensed(self, counts: float) -> float:
        """Counts as the sensor sees them, before quantisation."""
        return counts if self._plain else through(self._chains[Stage.SENSOR], counts, self.now)

    def current(self, command_A: float) -> float:
        """The current that flowed in the last step."""
        return command_A if self._plain else self.now.current_A

    @property
    def felt_K(self) -> float:
        """The temperature the hysteresis felt last."""
        return self.operator.u

    @property
    def asks_for_commands(self) -> bool:
        """Whether an effect says what becomes of a command: then ``step`` is not for measured currents."""
        return bool(self._chains[Stage.CURRENT])

    @property
    def lag(self) -> float:
        """The time constant of the last tick over the constant one; of two wires their mean."""
        lags = self._warming.lags
        return sum(lags) / len(lags) if lags else 1.0

    @property
    def heat_gain(self) -> float:
        """The steady temperature of the last tick's current, over what R/hA says of it; 1 where none flowed."""
        by_constants_K = 0.0 if self._plain else self.heating.source(self.now.command_A)
        return self.now.source_K / by_constants_K if by_constants_K else 1.0

    @property
    def austenite(self) -> float:
        """Austenite fraction ξ of wire 1, taken from the output: 0 at y₋, 1 at y₊."""
        return (self.operator.y - self._y_lower) * self._per_span
