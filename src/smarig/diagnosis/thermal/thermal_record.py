"""A measured wire temperature under a drive of unknown scale: one heat balance with named extensions.

    dT/dt = g p(t) − (θ/τ)(θ/θ₀)ⁿ − Λ dξ/dt,    θ = T − T_room − b − s (M − T_room − b),    dM/dt = (T − M)/τ₂
    reading = T through a first-order lag λ and a dead time d

p is the drive (duty cycle, power) in its own unit. ξ is the transformed share from the measured position, in [0,
1]. Λ is the latent heat over the heat capacity in kelvin, one for heating (dξ > 0) and one for cooling. Without
extensions (Λ = n = s = λ = d = 0) the balance is a plain exponential, thesis (5.1). Time is in samples if there is
no clock.
"""

from dataclasses import dataclass
from math import exp

import numpy as np
from numpy.typing import NDArray

from smarig.core import DataError
from smarig.identification import valid_rows
from smarig.record import Run

Array = NDArray[np.float64]
MAX_BINS = 200  # a polled, quantised sensor contains no more information
REFERENCE_K = 20.0  # θ₀: here h does not depend on n
MIN_EXCESS_K = 0.5  # h is constant below this temperature
MIN_BINS = 40


@dataclass(frozen=True, eq=False)
class ThermalRecord:
    """Medians over equal bins of a run: time (n,), temperature, drive, room (0 if unknown), ξ (None if unknown)."""

    t: Array
    temperature: Array
    drive: Array
    room: Array
    share: Array | None
    unit: str

    @property
    def dt(self) -> float:
        """Length of a bin."""
        return float(self.t[1] - self.t[0])

    @property
    def length(self) -> float:
        """Length of the record."""
        return float(self.t[-1] - self.t[0])


def thermal_record_of(run: Run) -> ThermalRecord:
    """The thermal record of a run: temperature and drive; position and room if measured.

    Raises DataError without a temperature, or without an input that is a drive.
    """
    name = "input" if run.input_unit not in ("K", "degC", "°C") else "current_A"
    if not (run.has("temperature_degC") and run.has(name)):
        raise DataError(
            f"{run.path} lacks the wire temperature or the input that heats the wire. A thermal diagnosis needs both."
        )
    clock = run.has("t_s")
    t = run["t_s"] if clock else np.arange(float(len(run)))
    keep = valid_rows(run) & np.isfinite(run["temperature_degC"]) & np.isfinite(t)
    edges = np.linspace(t[keep][0], t[keep][-1], min(MAX_BINS, max(keep.sum() // 4, 1)) + 1)
    middle = (edges[1:] + edges[:-1]) / 2
    if middle.size < MIN_BINS:
        raise DataError(f"{run.path} holds {int(keep.sum())} temperatures, too few for a diagnosis.")

    def binned(channel: str) -> Array:
        value = run[channel]
        known = keep & np.isfinite(value)
        which = np.clip(np.searchsorted(edges, t[known], side="right") - 1, 0, middle.size - 1)
        order = np.split(value[known], np.flatnonzero(np.diff(which)) + 1)
        return np.interp(
            middle, middle[np.unique(which)], [float(np.median(hold_weight)) for hold_weight in order]
        )

    drive = binned(name)
    share = _share(binned("position")) if run.has("position") else None
    room = binned("ambient_degC") if run.has("ambient_degC") else np.zeros(middle.size)
    drive = drive**2 if name == "current_A" else drive
    return ThermalRecord(middle, binned("temperature_degC"), drive, room, share, "s" if clock else "sample")


def _share(y: Array) -> Array:
    """Position as a share of its range, smoothed over three bins, because single-row spikes are not a
    transformation.
    """
    padded = np.pad(y, 1, mode="edge")
    smooth = np.median([padded[:-2], padded[1:-1], padded[2:]], axis=0)
    return (smooth - smooth.min()) / (np.ptp(smooth) or 1.0)


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
    lag: float = 0.0
    dead: float = 0.0

    def predicted_temperature(self, x: ThermalRecord) -> Array:
        """Temperatures (n,) that the sensor shows; exact for a constant drive in each bin."""
        return self._sensor_response(x, self._wire_temperature(x))

    def _wire_temperature(self, x: ThermalRecord) -> Array:
        equilibrium, heat = x.room + self.offset, self._heat(x)
        if self.exponent or self.mass_share:
            return self._nonlinear_wire(x, equilibrium, heat)
        decay = exp(-x.dt / self.tau)
        forcing = (1 - decay) * (equilibrium + self.gain * self.tau * x.drive) - heat
        return _recursion(forcing, decay, self.start)

    def _nonlinear_wire(self, x: ThermalRecord, equilibrium: Array, heat: Array) -> Array:
        """The temperature bin by bin, if the loss depends on the temperature or there is a second mass."""
        dt, rate, decay = x.dt, 1 / self.tau, exp(-x.dt / self.tau)
        keep, share, n = exp(-dt / self.mass_tau), self.mass_share, self.exponent
        wire, mass, out = self.start, float(equilibrium[0]), []
        for base, heating_rate, h in zip(equilibrium.tolist(), (self.gain * x.drive).tolist(), heat.tolist()):
            end = base + share * (mass - base)
            if n:
                rate = (max(abs(wire - end), MIN_EXCESS_K) / REFERENCE_K) ** n / self.tau
                decay = exp(-dt * rate)
            end += heating_rate / rate
            wire = end + (wire - end) * decay - h
            mass = wire + (mass - wire) * keep
            out.append(wire)
        return np.array(out)

    def _heat(self, x: ThermalRecord) -> Array:
        """Temperature drop (n,) by latent heat in each bin, kelvin; negative on cooling."""
        if x.share is None:
            return np.zeros(x.t.size)
        share_change = np.diff(x.share, prepend=x.share[0])
        return np.where(share_change > 0, self.latent_K, self.cooling_K) * share_change

    def _sensor_response(self, x: ThermalRecord, wire: Array) -> Array:
        if self.dead:
            wire = np.interp(x.t - self.dead, x.t, wire)
        if self.lag <= 1e-3 * x.dt:
            return wire
        left = exp(-x.dt / self.lag)
        hold_weight = 1 - (1 - left) * self.lag / x.dt  # exact for a linear change within a bin
        before = np.append(wire[:1], wire[:-1])
        return _recursion((1 - left - hold_weight) * before + hold_weight * wire, left, float(wire[0]))


def _recursion(forcing: Array, keep: float, start: float) -> Array:
    """y_k = keep · y_{k−1} + forcing_k, from ``start``, (n,)."""
    from scipy.signal import lfilter  # imported here: takes most of a second

    return lfilter([1.0], [1.0, -keep], forcing, zi=[keep * start])[0]
