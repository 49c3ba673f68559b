"""The heat balance of a wire and what its thermometer shows, with the parameters of every effect.

    dT/dt = g p(t) − (θ/τ)(θ/θ₀)ⁿ − Λ dξ/dt,    θ = T − T_room − b − D t − s (M − T_room − b − D t),
    dM/dt = (T − M)/τ₂,    reading = T through a first-order lag λ and a dead time d

p is the drive (duty cycle, power) in its own unit. Λ is the latent heat over the heat capacity in kelvin, one for
heating (dξ > 0) and one for cooling. Without effects (Λ = n = s = D = λ = d = 0) the balance is a plain exponential,
thesis (5.1).
"""

from dataclasses import dataclass
from math import exp

import numpy as np

from smarig.core import Array
from smarig.diagnosis.comparison.thermal.thermal_record import FINE, ThermalRecord

REFERENCE_K = 20.0  # θ₀: here the loss does not depend on n
LEAST_EXCESS_K = 0.5  # below it, the loss is linear


@dataclass(frozen=True)
class HeatBalance:
    """Parameters of the heat balance; times in the unit of the record, g in kelvin per time and unit of drive."""

    start: float
    offset: float
    gain: float
    tau: float
    latent_K: float = 0.0
    cooling_K: float = 0.0
    exponent: float = 0.0
    mass_share: float = 0.0
    mass_tau: float = 1.0
    drift: float = 0.0
    lag: float = 0.0
    dead: float = 0.0

    def predicted_temperature(self, x: ThermalRecord) -> Array:
        """Means (n,) over bins of what the thermometer shows; exact for a constant drive between two fine times."""
        reading = self._reading(x, self._wire_temperature(x))
        return (0.5 * (reading[1:] + reading[:-1])).reshape(-1, FINE).mean(axis=1)

    def _wire_temperature(self, x: ThermalRecord) -> Array:
        still = x.room + self.offset + self.drift * (x.fine_t - x.fine_t[0])
        if self.exponent or self.mass_share:
            return self._stepwise(x, still)
        decay = exp(-x.step / self.tau)
        forcing = (1 - decay) * (still + self.gain * self.tau * x.drive) - self._latent(x)
        return _recursion(forcing, decay, self.start)

    def _stepwise(self, x: ThermalRecord, still: Array) -> Array:
        """The temperature step by step, if the loss depends on the temperature or there is a second mass."""
        step, rate = x.step, 1 / self.tau
        decay, keep = exp(-step / self.tau), exp(-step / self.mass_tau)
        share, n = self.mass_share, self.exponent
        wire, mass, out = self.start, float(still[0]), [self.start]
        rows = np.column_stack([still, self.gain * x.drive, self._latent(x)])[1:]
        for base, heating, latent in rows.tolist():
            end = base + share * (mass - base)
            if n:
                rate = (max(abs(wire - end), LEAST_EXCESS_K) / REFERENCE_K) ** n / self.tau
                decay = exp(-step * rate)
            end += heating / rate
            wire = end + (wire - end) * decay - latent
            mass = wire + (mass - wire) * keep
            out.append(wire)
        return np.array(out)

    def _latent(self, x: ThermalRecord) -> Array:
        """Temperature drop (N,) by latent heat in each step, kelvin; negative on cooling."""
        if x.share is None:
            return np.zeros(x.drive.size)
        change = np.diff(x.share, prepend=x.share[0])
        return np.where(change > 0, self.latent_K, self.cooling_K) * change

    def _reading(self, x: ThermalRecord, wire: Array) -> Array:
        if self.dead:
            wire = np.interp(x.fine_t - self.dead, x.fine_t, wire)
        if self.lag <= 1e-3 * x.step:
            return wire
        left = exp(-x.step / self.lag)
        now = 1 - (1 - left) * self.lag / x.step  # exact for a linear change within a step
        before = np.append(wire[:1], wire[:-1])
        return _recursion((1 - left - now) * before + now * wire, left, float(wire[0]))


def wire_response(x: ThermalRecord, tau: float) -> Array:
    """Temperature (n, n) at each time by a heating rate of one in each bin before it."""
    past = (x.t[:, None] - x.t) / tau
    return np.where(past > 0, np.exp(-np.maximum(past, 0.0)), 0.0) * tau * (np.exp(x.dt / tau) - 1)


def _recursion(forcing: Array, keep: float, start: float) -> Array:
    """y_k = keep · y_{k−1} + forcing_k, y_0 = ``start``, (N,)."""
    from scipy.signal import lfilter  # imported here: takes most of a second

    return np.asarray(lfilter([1.0], [1.0, -keep], np.r_[start, forcing[1:]]))
