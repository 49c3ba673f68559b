"""A heated wire with a thermometer, integrated in small steps; it shares no code with what diagnoses it.

dT/dt = [heating − loss]/capacity;  every mechanism is a plain formula on the temperature, the time or the power.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from smarig.record import Run
from smarig.record.schema import SAMPLE_COLUMNS

ROW_S, STEPS = 0.1, 4
ROOM, RISE_K, TAU_S = 22.0, 60.0, 12.0


@dataclass(frozen=True)
class Wire:
    """What is hidden in the wire and its thermometer; nothing by default."""

    lag_s: float = 0.0
    dead_s: float = 0.0
    loss_exponent: float = 0.0
    latent_K: float = 0.0
    room_K_per_s: float = 0.0
    room_wave_K: float = 0.0
    second_mass: float = 0.0
    resistance_peak: float = 0.0
    pickup_K: float = 0.0
    noise_K: float = 0.1
    shows_share: bool = False

    def run(self, steps: int, seconds: float, seed: int = 0) -> Run:
        """A record of random steps of the power, with the noise of a seed."""
        rng = np.random.default_rng(seed)
        t = np.arange(0.0, seconds, ROW_S)
        power = _power(t, steps, seconds, rng)
        shown, share = self._shown(t, power)
        dead = round(self.dead_s / ROW_S)
        shown = np.r_[np.full(dead, shown[0]), shown[: shown.size - dead]] + self.pickup_K * power**2
        columns = {name: np.full(t.size, np.nan) for name in SAMPLE_COLUMNS}
        columns |= {"tick": np.arange(float(t.size)), "t_s": t, "input": 10 * power}
        columns["temperature_degC"] = shown + self.noise_K * rng.standard_normal(t.size)
        if self.latent_K or self.shows_share:
            columns["position"] = 5 * share + 0.005 * rng.standard_normal(t.size)
        meta = {"input": {"quantity": "power", "unit": "W"}, "output": {"quantity": "position", "unit": "mm"}}
        return Run(Path("heated.run.sqlite"), {**meta, "source": "twin"}, columns, (), ())

    def _shown(self, t, power):
        """(what the thermometer shows, transformed share), a row each."""
        wire = shown = mass = ROOM
        share, rows, dt = 0.0, [], ROW_S / STEPS
        for now, p in zip(t.tolist(), power.tolist()):
            room = ROOM + self.room_K_per_s * now + self.room_wave_K * np.sin(now / 160.0)
            for _ in range(STEPS):
                slope = (self._heating(wire, p) - self._loss(wire - room, mass - room)) / TAU_S
                ends = _sigmoid((wire - 52) / 3), _sigmoid((wire - 40) / 3)  # on heating, on cooling
                edge = ends[0] if slope > 0 else ends[1]
                moving = edge > share if slope > 0 else edge < share
                slope /= 1 + self.latent_K * edge * (1 - edge) / 3 * moving
                wire += dt * slope
                share = min(max(share, ends[0]), ends[1])
                mass += dt * (wire - mass) / 90.0
                shown = shown + dt * (wire - shown) / self.lag_s if self.lag_s else wire
            rows.append((shown, share))  # the power of a row flowed up to its time
        return np.array(rows).T

    def _heating(self, wire, p):
        return RISE_K * p * (1 + self.resistance_peak * np.exp(-(((wire - 50) / 8) ** 2)))

    def _loss(self, excess, mass_excess):
        return (excess - self.second_mass * mass_excess) * (max(excess, 0.5) / 30) ** self.loss_exponent


def _sigmoid(x):
    return 1 / (1 + np.exp(-x))


def _power(t, steps, seconds, rng):
    """Random levels between 0 and 1, each at least a quarter from the one before."""
    levels = [0.0]
    while len(levels) <= steps:
        level = rng.uniform()
        if abs(level - levels[-1]) > 0.25:
            levels.append(level)
    at = (np.arange(steps) + 0.5 + rng.uniform(-0.3, 0.3, steps)) * seconds / steps
    return np.array(levels)[np.searchsorted(at, t, side="right")]
