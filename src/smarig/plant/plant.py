"""The wire as a plant: from current through heating (5.1) and Preisach operator (3.1) to position, with effects.

One step is one tick at constant current. Instruments and their noise are not part of the plant.
"""

from collections.abc import Callable, Sequence

from smarig.plant.actuator import Actuator
from smarig.plant.effect import EffectContext, Hook, PlantState, Stage, SupportsHooks, hook_chains
from smarig.plant.thermal_stages import ThermalStages, apply_hooks
from smarig.plant.wire_phases import WirePhases
from smarig.preisach import Everett, Initial, Preisach

TOLERANCE_K = 1e-6  # K
MAX_ITERATIONS = 60
EQUAL_STEPS, STEP_GROWTH = 10, 1.5


class Plant:
    """State of the wires: temperatures, hysteresis memory, and position in the rig's unit from the operator's zero.

    >>> from smarig.preisach import thesis_surface
    >>> plant = Plant(Actuator.named("gorbet_one_wire"), thesis_surface("one_e"), "negative", dt_s=0.1)
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
        effects: Sequence[SupportsHooks] = (),
        *,
        phase_heating: bool = False,
    ) -> None:
        """``phase_heating``: a current heats with R(ξ), so the heat is V·i; else with R̄, as in the thesis (5.1)."""
        self.actuator = actuator
        self.operator = Preisach(hysteresis, initial)
        span = hysteresis.everett(hysteresis.upper, hysteresis.lower)
        self._y_lower, self._per_stroke = hysteresis.y_lower, 1.0 / span if span else 0.0
        self._chains = hook_chains(effects, EffectContext(actuator, hysteresis, initial))
        self._phase_heating = phase_heating
        if phase_heating:
            self._chains[Stage.RESISTANCE] = (self._with_phase, *self._chains[Stage.RESISTANCE])
        self._no_effects = not any(self._chains.values())
        self._phases = WirePhases(hysteresis) if actuator.two_wire else None
        self.now = PlantState(dt_s=dt_s, output=self.operator.y, share=self.share)
        self._thermal_stages = ThermalStages(actuator, self._chains, self.now, self._phases)
        self.heating = self._thermal_stages.heating
        self.position = apply_hooks(self._chains[Stage.OUTPUT], self.operator.y, self.now)  # position at rest

    def step(self, current_A: float, disturbance_K: float = 0.0) -> float:
        """Advance one tick at constant current. The disturbance is added to the hysteresis input."""
        if self._no_effects:
            self.position = self.operator.step(self.heating.step(current_A) + disturbance_K)
            if self._phases is not None:
                self._phases.step(self.heating.wire_K)
            return self.position
        self.now.tick += 1
        return self._step_with_effects(current_A, disturbance_K, self.now.tick * self.heating.dt_s)

    def advance(self, current_A: float, dt_s: float, disturbance_K: float = 0.0) -> float:
        """Like ``step``, for a time of any length."""
        if self._no_effects:
            self.heating.tick(dt_s)
            return self.step(current_A, disturbance_K)
        parts = self._thermal_stages.parts(current_A, dt_s)
        self.now.dt_s = dt_s / parts
        start_s = self.now.t_s
        for k in range(1, parts + 1):
            self._step_with_effects(current_A, disturbance_K, start_s + dt_s * k / parts)
        self.now.dt_s = dt_s  # the sensor works in whole ticks
        return self.position

    def _step_with_effects(self, current_A: float, disturbance_K: float, t_s: float) -> float:
        now, at = self.now, self._chains
        self._thermal_stages.hysteresis_input(current_A, disturbance_K, t_s)
        before, now.output = now.output, self._output_with_feedback()
        now.share = self.share
        if self._phases is not None:
            self._phases.step(self.heating.wire_K, now.ambient_K)
        now.travel += abs(now.output - before) * self._per_stroke
        mapped = apply_hooks(at[Stage.OUTPUT], now.output, now)
        self.position = apply_hooks(at[Stage.ADDITIVE], mapped, now)
        return self.position

    def _output_with_feedback(self) -> float:
        """The output at the hysteresis input. If that depends on the output, at the first self-consistent input."""
        hooks = self._chains[Stage.FEEDBACK]
        if hooks:
            step_with_feedback(hooks, self.now, self.operator, self._y_lower, self._per_stroke)
            return self.operator.y
        return self.operator.step(self.now.hysteresis_input_K)

    def sensed(self, counts: float) -> float:
        """Counts that the sensor indicates, before quantisation."""
        return counts if self._no_effects else apply_hooks(self._chains[Stage.SENSOR], counts, self.now)

    def current(self, command_A: float) -> float:
        """The current that flowed in the last step."""
        return command_A if self._no_effects else self.now.current_A

    @property
    def hysteresis_input_K(self) -> float:
        """The last hysteresis input."""
        return self.operator.u

    @property
    def alters_current(self) -> bool:
        """Whether an effect changes the commanded current. Then ``step`` must not be given measured currents."""
        return bool(self._chains[Stage.CURRENT])

    @property
    def lag(self) -> float:
        """Time constant of the last tick relative to the constant one; for two wires the mean."""
        lags = self._thermal_stages.lags
        return sum(lags) / len(lags) if lags else 1.0

    @property
    def heating_ratio(self) -> float:
        """Steady temperature of the last tick's current relative to R/hA · i²; 1 at zero current."""
        nominal_K = 0.0 if self._no_effects else self.heating.source(self.now.command_A)
        return self.now.source_K / nominal_K if nominal_K else 1.0

    @property
    def share(self) -> float:
        """The output's share of the stroke: 0 at y₋, 1 at y₊."""
        return (self.operator.y - self._y_lower) * self._per_stroke

    @property
    def austenite(self) -> tuple[float, ...]:
        """Austenite fraction ξ of each wire. That of a single wire is the output's share."""
        return (self.share,) if self._phases is None else self._phases.austenite

    def resistance_ohm(self, current_A: float) -> float:
        """The present resistance of the wire that carries a current. With ``phase_heating``, that which heated it."""
        if self._phase_heating:
            return self.now.resistance * self.actuator.resistance_ohm
        phases = self._phases
        austenite = self.share if phases is None else phases.fraction(1 if current_A < 0 else 0)
        return self.now.resistance * self.actuator.resistance_at_ohm(austenite)

    def _with_phase(self, factor: float, now: PlantState) -> float:
        return factor * self.actuator.resistance_at_ohm(now.austenite) / self.actuator.resistance_ohm


def step_with_feedback(
    hooks: tuple[Hook, ...], now: PlantState, operator: Preisach, y_lower: float, per_stroke: float
) -> None:
    """Move the operator, and ``now.hysteresis_input_K``, to the first input that agrees with the output it causes."""
    before_feedback_K = now.hysteresis_input_K

    def hysteresis_input(u: float, *, y: float) -> float:
        now.share = (y - y_lower) * per_stroke
        return apply_hooks(hooks, before_feedback_K, now) - u

    now.hysteresis_input_K = self_consistent_input(
        lambda u: hysteresis_input(u, y=operator.peek(u)),
        operator.u,
        hysteresis_input(operator.u, y=operator.y),
    )
    operator.step(now.hysteresis_input_K)


def self_consistent_input(drive: Callable[[float], float], u: float, drive_at_u: float) -> float:
    """The first zero of ``drive``, f(u) − u, on the way from ``u``, where its value is ``drive_at_u``.

    >>> round(self_consistent_input(lambda u: 10.0 - 2.5 * u, 0.0, 10.0), 5)
    4.0
    """
    if abs(drive_at_u) < TOLERANCE_K:
        return u
    other, drive_at_other = u + drive_at_u, drive(u + drive_at_u)
    for k in range(MAX_ITERATIONS):  # in the direction of the drive, finally with growing steps
        if drive_at_other * drive_at_u <= 0 or abs(drive_at_other) < TOLERANCE_K:
            break
        u, drive_at_u = other, drive_at_other
        other = u + drive_at_u * STEP_GROWTH ** max(0, k - EQUAL_STEPS)
        drive_at_other = drive(other)
    return (
        _bracketed_root(drive, u, drive_at_u, other, drive_at_other)
        if drive_at_other * drive_at_u < 0
        else other
    )


def _bracketed_root(
    drive: Callable[[float], float], u: float, drive_at_u: float, other: float, drive_at_other: float
) -> float:
    """The root between two inputs, found by the Illinois variant of false position."""
    new = other
    for _ in range(MAX_ITERATIONS):
        new = (u * drive_at_other - other * drive_at_u) / (drive_at_other - drive_at_u)
        drive_at_new = drive(new)
        if abs(drive_at_new) < TOLERANCE_K or abs(other - u) < TOLERANCE_K:
            return new
        if drive_at_new * drive_at_other < 0:
            u, drive_at_u = other, drive_at_other
        else:
            drive_at_u *= 0.5
        other, drive_at_other = new, drive_at_new
    return new
