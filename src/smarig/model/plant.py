"""The wire as a plant: current in, position out; heating (5.1) → Preisach (3.1), effects at their stages.

One step is one tick at constant current. Knows no instruments, no noise of theirs, no device.
"""

from collections.abc import Sequence

from smarig.model.actuator import Actuator
from smarig.model.effect import Effect, Hook, Moment, Setup, Stage, chains
from smarig.model.feedback import agreed
from smarig.model.given import heating_of
from smarig.preisach.everett import Everett
from smarig.preisach.operator import Initial, Preisach

FINE_K, MOST_PARTS = 0.5, 50  # of a tick of any length, where heat depends on the output


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
        self.heating = heating_of(actuator, dt_s)
        self.operator = Preisach(hysteresis, initial)
        span = hysteresis.everett(hysteresis.upper, hysteresis.lower)
        self._y_lower, self._per_span = hysteresis.y_lower, 1.0 / span if span else 0.0
        self._chains = chains(effects, Setup(actuator, hysteresis, initial))
        self._plain = not any(self._chains.values())
        self._couples = any(self._chains[stage] for stage in (Stage.RESISTANCE, Stage.LAG, Stage.SOURCE))
        self.now = Moment(dt_s=dt_s, output=self.operator.y, austenite=self.austenite)
        self.position = _through(self._chains[Stage.OUTPUT], self.operator.y, self.now)  # where it rests

    def step(self, current_A: float, disturbance_K: float = 0.0) -> float:
        """One tick: current held over it, temperature disturbance added to what the hysteresis feels."""
        if self._plain:
            self.position = self.operator.step(self.heating.step(current_A) + disturbance_K)
            return self.position
        self.now.tick += 1
        return self._with_effects(current_A, disturbance_K, self.now.tick * self.heating.dt_s)

    def advance(self, current_A: float, dt_s: float, disturbance_K: float = 0.0) -> float:
        """As ``step``, for a time of any length."""
        self.heating.tick(dt_s)
        if self._plain:
            return self.step(current_A, disturbance_K)
        parts = self._parts(current_A) if self._couples else 1
        if parts > 1:
            self.heating.tick(dt_s / parts)
        self.now.dt_s = dt_s / parts
        start_s = self.now.t_s
        for k in range(1, parts + 1):
            self._with_effects(current_A, disturbance_K, start_s + dt_s * k / parts)
        self.now.dt_s = dt_s  # the sensor sees whole ticks
        return self.position

    def _parts(self, current_A: float) -> int:
        """How often a tick is cut, so that the heat of a transformation or of another wire acts as it goes."""
        heating = self.heating
        ends = heating.ends(heating.source(current_A))
        far = max(abs(end - now) for end, now in zip(ends, heating.wire_K)) * (1 - heating.decay)
        return min(1 + int(far / FINE_K), MOST_PARTS)

    def _with_effects(self, current_A: float, disturbance_K: float, t_s: float) -> float:
        now, at, heating = self.now, self._chains, self.heating
        now.t_s, now.command_A = t_s, current_A
        now.ambient_K = _through(at[Stage.AMBIENT], 0.0, now)
        now.current_A = _through(at[Stage.CURRENT], current_A, now)
        now.resistance = _through(at[Stage.RESISTANCE], 1.0, now)
        now.input_K = heating.input_K  # before the tick, above the room: what heat is lost and stored by
        now.source_K = _through(at[Stage.SOURCE], heating.source(now.current_A) * now.resistance, now)
        room_K = 0.0 if heating.two_wire else now.ambient_K  # common to both wires: T₁ − T₂ does not see it
        now.input_K = heating.relax(now.source_K, *self._lags()) + room_K + disturbance_K
        now.felt_K = _through(at[Stage.INPUT], now.input_K, now)
        before, now.output = now.output, self._moved()
        now.austenite = self.austenite
        now.travel += abs(now.output - before) * self._per_span
        mapped = _through(at[Stage.OUTPUT], now.output, now)
        self.position = _through(at[Stage.ADDITIVE], mapped, now)
        return self.position

    def _moved(self) -> float:
        """The output at what is felt; where that depends on the output, at the first temperature that both agree on."""
        hooks, now, operator = self._chains[Stage.FEEDBACK], self.now, self.operator
        if not hooks:
            return operator.step(now.felt_K)
        given_K = now.felt_K

        def felt(u: float, *, y: float) -> float:
            now.austenite = (y - self._y_lower) * self._per_span
            return _through(hooks, given_K, now) - u

        now.felt_K = agreed(lambda u: felt(u, y=operator.peek(u)), operator.u, felt(operator.u, y=operator.y))
        return operator.step(now.felt_K)

    def _lags(self) -> tuple[float, ...]:
        """The lag of each wire, none when nothing changes it.

        Wires cool by themselves: to each its own temperature and its own end stand for the source and the input.
        """
        hooks, now, heating = self._chains[Stage.LAG], self.now, self.heating
        if not hooks:
            return ()
        lags, source_K = [], now.source_K
        for k in range(2 if heating.two_wire else 1):
            now.source_K, now.input_K = heating.ends(source_K)[k], heating.wire_K[k]
            lags.append(_through(hooks, 1.0, now))
        now.source_K = source_K
        return tuple(lags)

    def sensed(self, counts: float) -> float:
        """Counts as the sensor sees them, before quantisation."""
        return counts if self._plain else _through(self._chains[Stage.SENSOR], counts, self.now)

    def current(self, command_A: float) -> float:
        """The current that flowed in the last step."""
        return command_A if self._plain else self.now.current_A

    @property
    def felt_K(self) -> float:
        """The temperature the hysteresis felt last."""
        return self.operator.u

    @property
    def austenite(self) -> float:
        """Austenite fraction ξ of wire 1, taken from the output: 0 at y₋, 1 at y₊."""
        return (self.operator.y - self._y_lower) * self._per_span


def _through(hooks: tuple[Hook, ...], value: float, now: Moment) -> float:
    for hook in hooks:
        value = hook(value, now)
    return value
