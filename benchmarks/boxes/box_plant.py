"""The wire of a box in motion: current → heat → hysteresis input → relays, step by step.

The position is computed afterwards, because it does not act back on the wire.
"""

import math

from benchmarks.boxes.box_effects import Hidden
from benchmarks.boxes.heat import WireTemperatures
from benchmarks.boxes.input_effects import StepState, build_input_effects
from benchmarks.boxes.kinetic_hysteresis import BoxHysteresis
from benchmarks.boxes.relays import Relays
from benchmarks.boxes.unlisted_effects import BenchFaults
from benchmarks.boxes.wire import BoxWire

_FINE = 0.1  # of the time constant, if relays act back on the heat


class BoxPlant:
    """The wire(s) with the hidden effects; cold with all relays off, or two wires after a decaying
    oscillation."""

    def __init__(self, wire: BoxWire, hysteresis: BoxHysteresis, hidden: Hidden) -> None:
        self.wire, self.hidden = wire, hidden
        self.relays = hysteresis.initial(two_wire=wire.two_wire)
        self.heat = WireTemperatures(wire.reference_K, hidden.get("convection", {}).get("exponent", 0.0))
        self.now = StepState(share=self.relays.share)
        self._input_effects, coupled = build_input_effects(
            hidden, hysteresis, self.relays.share, two_wire=wire.two_wire
        )
        self._bench = BenchFaults(hidden, abs(wire.reference_A))
        self._input_effects += self._bench.input_effects()
        self._latent = hidden.get("latent_heat")
        self._thermal = self._latent is not None or "resistance_phase" in hidden
        self._coupled = coupled or self._latent is not None
        top = max(hysteresis.upper, -hysteresis.lower)
        self._max_A = abs(wire.command(top)) * (1 - _parameter(hidden, "saturation", "clip_percent") / 100)
        self.current_A = self.ambient_shift_K = self.input_K = self.hysteresis_input_K = 0.0
        self._powers_K = (0.0, 0.0)

    def step(self, command_A: float, dt_s: float, fluctuation_K: float) -> float:
        """Advance at constant command; returns the share of relays that are on at the end."""
        self.current_A = self._bench.current(self._amplified(command_A), self.now.t_s, dt_s)
        parts = max(1, math.ceil(dt_s / (_FINE * self.wire.tau_s))) if self._thermal else 1
        for _ in range(parts):
            self._substep(dt_s / parts, fluctuation_K)
        return self.now.share

    @property
    def distance_to_steady_K(self) -> float:
        """The distance of the wires from their steady temperatures."""
        return self.heat.distance_to_steady_K(self._powers_K)

    @property
    def resistance(self) -> float:
        """Resistance of the heated wire divided by its mean."""
        if "resistance_phase" not in self.hidden:
            return 1.0
        return 1 + self.hidden["resistance_phase"]["change_percent"] / 100 * (self._austenite() - 0.5)

    def _austenite(self) -> float:
        """That of the wire that carries the current."""
        if isinstance(self.relays, Relays) and self.wire.two_wire:
            return self.relays.own_austenite(1 if self.current_A < 0 else 0)
        return self.now.share

    def _amplified(self, i: float) -> float:
        """The current that flows: gain and offset, then diodes, then the limit of the supply."""
        gain = self.hidden.get("amplifier_gain")
        if gain and i:
            i = i * (1 + gain["gain_percent"] / 100) + gain["offset_A"]
        i = math.copysign(max(abs(i) - _parameter(self.hidden, "dead_zone", "below_A"), 0.0), i)
        return min(max(i, -self._max_A), self._max_A) if "saturation" in self.hidden else i

    def _substep(self, dt_s: float, fluctuation_K: float) -> None:
        now, heat = self.now, self.heat
        now.t_s, now.dt_s = now.t_s + dt_s, dt_s
        loss = self._bench.loss(now.t_s)
        power_K = self.wire.gain_K_per_A2 * self.current_A**2 * self.resistance / loss
        second = self.wire.two_wire and self.current_A < 0
        self._powers_K = (0.0, power_K) if second else (power_K, 0.0)
        steady = heat.steady_K(power_K)
        now.source_K = -steady if second else steady
        heat.step(self._powers_K, dt_s, self._tau_s() / loss)
        self.ambient_shift_K = self._ambient_shift_K() + self._bench.room_K(now.t_s)
        ambient_total_K = fluctuation_K + (0.0 if self.wire.two_wire else self.ambient_shift_K)
        share = (
            self._coupled_move(ambient_total_K) if self._coupled else self._uncoupled_move(ambient_total_K)
        )
        now.travel += abs(share - now.share)
        now.share = share

    def _tau_s(self) -> float:
        slow = 1 + _parameter(self.hidden, "wire_lag", "change_percent") / 100
        return self.wire.tau_s * slow * self._capacity()

    def _capacity(self) -> float:
        """Specific heat divided by its mean; it depends on the phase."""
        change = _parameter(self.hidden, "latent_heat", "specific_heat_change_percent") / 100
        return 1 + change * (self._austenite() - 0.5) if change else 1.0

    def _ambient_shift_K(self) -> float:
        """Change of the ambient temperature since the start."""
        p = self.hidden.get("ambient_drift")
        if p is None:
            return 0.0
        begin = 2 * math.pi * p["phase"]
        return p["swing_K"] * (
            math.sin(2 * math.pi * self.now.t_s / 3600 / p["period_h"] + begin) - math.sin(begin)
        )

    def _uncoupled_move(self, ambient_total_K: float) -> float:
        """Advance if the hysteresis input does not depend on the relays."""
        now = self.now
        self.input_K = u = self.heat.input_K + ambient_total_K
        for effect in self._input_effects:
            before, u = u, float(effect.hysteresis_input(u, now.share, now))
            effect.finish_step(before, now.share, now)
        self.hysteresis_input_K = u
        return self.relays.move(u)

    def _coupled_move(self, ambient_total_K: float) -> float:
        """Advance until relays, their latent heat and the hysteresis input agree."""
        now, trial_K, latent_K = self.now, self.heat.input_K + ambient_total_K, self._latent_K()

        def hysteresis_input(share):
            u = trial_K - latent_K * (share - now.share)
            for effect in self._input_effects:
                u = effect.hysteresis_input(u, share, now)
            return u

        share = self.relays.move_coupled(hysteresis_input)
        if latent_K:
            self.heat.add_temperature(-latent_K * (share - now.share))
        self.input_K = u = self.heat.input_K + ambient_total_K
        for effect in self._input_effects:
            before, u = u, float(effect.hysteresis_input(u, share, now))
            effect.finish_step(before, share, now)
        self.hysteresis_input_K = u
        return share

    def _latent_K(self) -> float:
        """Temperature that a complete transformation costs the wire."""
        p = self._latent
        if p is None:
            return 0.0
        heating = abs(self.now.source_K) >= abs(self.heat.input_K)
        joules = p["latent_J_per_g"] * (1.0 if heating else p["cooling_ratio"])
        return 1000 * joules / (self.wire.specific_heat * self._capacity())


def _parameter(hidden: Hidden, name: str, parameter: str) -> float:
    return hidden.get(name, {}).get(parameter, 0.0)
