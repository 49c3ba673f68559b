"""From the current to the hysteresis input: ambient temperature, amplifier, heating, and the effects on them.

The output of the hysteresis matters only to effects that use it. With a ``ThermalState``, which contains no output, the
hysteresis input is the same for every hysteresis.
"""

from collections.abc import Mapping

from smarig.plant.actuator import Actuator
from smarig.plant.effect import Hook, PlantState, Stage
from smarig.plant.measured_input import heating_for
from smarig.plant.wire_phases import WirePhases

MAX_PART_K, MAX_PARTS = 1.0, 50  # limits for the subdivision of a tick if heating depends on the output
MAX_GROWTH = 1.5  # of ticks: limit of extrapolation
EARLY_STAGES = (Stage.AMBIENT, Stage.CURRENT, Stage.RESISTANCE, Stage.SOURCE, Stage.LAG, Stage.INPUT)


class ThermalStages:
    """Temperatures of the wires, with the effects of the early stages.

    ``phases`` has the present austenite fractions of two wires. That of a single wire is the share of the stroke.
    """

    def __init__(
        self,
        actuator: Actuator,
        chains: Mapping[Stage, tuple[Hook, ...]],
        now: PlantState,
        phases: WirePhases | None = None,
    ) -> None:
        self.heating = heating_for(actuator, now.dt_s)
        self.now = now
        self._ambient, self._current, self._resistance, self._source, self._lag, self._input = (
            chains[stage] for stage in EARLY_STAGES
        )
        self.lags: tuple[float, ...] = ()
        self._phases = phases
        self._last_austenite = [(self._austenite(k), now.dt_s) for k in (0, 1)]
        self._output_dependent = any(chains[stage] for stage in (Stage.RESISTANCE, Stage.LAG, Stage.SOURCE))

    def parts(self, current_A: float, dt_s: float) -> int:
        """Number of parts of a tick, so that transformation heat and heat of the other wire act continuously."""
        heating = self.heating
        heating.tick(dt_s)
        if not self._output_dependent:
            return 1
        first_K, second_K = heating.ends(heating.source(current_A))
        wire_1_K, wire_2_K = heating.wire_K
        change_K = max(abs(first_K - wire_1_K), abs(second_K - wire_2_K)) * (1 - heating.decay)
        parts = min(1 + int(change_K / MAX_PART_K), MAX_PARTS)
        if parts > 1:
            heating.tick(dt_s / parts)
        return parts

    def hysteresis_input(self, current_A: float, disturbance_K: float, t_s: float) -> float:
        """Advance one tick and record the intermediate values. Written out in full, because it is called very often."""
        now, heating = self.now, self.heating
        now.t_s, now.command_A = t_s, current_A
        ambient_K, resistance = 0.0, 1.0
        for hook in self._ambient:
            ambient_K = hook(ambient_K, now)
        now.ambient_K = ambient_K
        for hook in self._current:
            current_A = hook(current_A, now)
        now.current_A = current_A
        if self._resistance:
            resistance = self._resistance_of_tick()
        now.resistance = resistance
        now.input_K = heating.input_K  # before the tick, above ambient: determines heat loss and stored heat
        source_K = heating.source(current_A) * resistance
        for hook in self._source:
            source_K = hook(source_K, now)
        now.source_K = source_K
        # an ambient change is common to both wires and cancels in T₁ − T₂
        common_ambient_K = 0.0 if heating.two_wire else ambient_K
        if self._lag:
            self.lags = self._lags()
        hysteresis_input_K = now.input_K = (
            heating.relax(source_K, *self.lags) + common_ambient_K + disturbance_K
        )
        for hook in self._input:
            hysteresis_input_K = hook(hysteresis_input_K, now)
        now.hysteresis_input_K = hysteresis_input_K
        return hysteresis_input_K

    def _resistance_of_tick(self) -> float:
        """The resistance at the austenite expected in the middle of the tick.

        The heating of a tick is constant, so that of its start would be late by half a tick, and a wire whose
        resistance falls overshoots by it. The expectation goes on as in the last tick, which was as long or shorter.
        """
        now = self.now
        if not isinstance(now, PlantState):  # without a hysteresis there is no austenite
            return apply_hooks(self._resistance, 1.0, now)
        now.wire = 1 if self.heating.two_wire and now.current_A < 0 else 0
        austenite, (before, before_s) = self._austenite(now.wire), self._last_austenite[now.wire]
        expected = austenite + 0.5 * (austenite - before) * min(now.dt_s / before_s, MAX_GROWTH)
        now.austenite = min(max(expected, 0.0), 1.0)
        resistance = apply_hooks(self._resistance, 1.0, now)
        now.austenite = austenite
        self._last_austenite = [(self._austenite(k), now.dt_s) for k in (0, 1)]
        return resistance

    def _austenite(self, wire: int) -> float:
        """The present austenite fraction of a wire, 0 without a hysteresis."""
        if self._phases is not None:
            return self._phases.fraction(wire)
        return self.now.share if isinstance(self.now, PlantState) else 0.0

    def _lags(self) -> tuple[float, ...]:
        """The lag of each wire.

        Each wire cools independently: its own temperature and final temperature replace input and source.
        """
        hooks, now, heating = self._lag, self.now, self.heating
        if not heating.two_wire:  # its temperature and source are those of the rig
            if isinstance(now, PlantState):
                now.wire, now.austenite = 0, now.share
            return (apply_hooks(hooks, 1.0, now),)
        lags, source_K = [], now.source_K
        for k in (0, 1):
            now.source_K, now.input_K = heating.ends(source_K)[k], heating.wire_K[k]
            if isinstance(now, PlantState):
                now.wire, now.austenite = k, self._austenite(k)
            lags.append(apply_hooks(hooks, 1.0, now))
        now.source_K = source_K
        return tuple(lags)


def apply_hooks(hooks: tuple[Hook, ...], value: float, now: PlantState) -> float:
    """A value after all hooks of one stage."""
    for hook in hooks:
        value = hook(value, now)
    return value
