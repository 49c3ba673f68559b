"""A measured wire temperature under a drive of unknown scale, in equal bins of time.

Temperatures are means over a bin. The drive is the mean between two points of a finer grid, so that a step of the drive
within a bin keeps its time; else a bin's width would be credited to the thermometer.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError
from smarig.identification import valid_rows
from smarig.record import Run

MOST_BINS = 200  # a polled, quantised sensor contains no more information
BIN_ROWS = 2
FEWEST_BINS = 40
FINE = 4  # steps of the finer grid in a bin
TEMPERATURES = ("K", "degC", "°C")
CURRENTS = ("A", "mA")  # heat with their squares


@dataclass(frozen=True, eq=False)
class ThermalRecord:
    """Middles of bins (n,) and temperatures (n,); drive, room (0 if unknown), ξ (None if unknown) at N = ``FINE`` n + 1
    times, the ends of the bins included.

    ξ is the transformed share, from the measured position, in [0, 1]. ``unit`` is that of the time: samples if there is
    no clock. ``quantum``: the least difference of two readings, kelvin.
    """

    t: Array
    temperature: Array
    drive: Array
    room: Array
    share: Array | None
    unit: str
    room_known: bool
    quantum: float

    @property
    def dt(self) -> float:
        """Length of a bin."""
        return float(self.t[1] - self.t[0])

    @property
    def step(self) -> float:
        """Spacing of the finer grid."""
        return self.dt / FINE

    @property
    def length(self) -> float:
        """Length of the record."""
        return float(self.t[-1] - self.t[0])

    @property
    def fine_t(self) -> Array:
        """Times (N,) of the finer grid."""
        return self.t[0] + self.step * (np.arange(self.drive.size) - FINE / 2)

    @property
    def bin_drive(self) -> Array:
        """Mean drive (n,) of each bin."""
        return self.drive[1:].reshape(-1, FINE).mean(axis=1)

    @property
    def bin_room(self) -> Array:
        """Mean room temperature (n,) of each bin."""
        return self.room[1:].reshape(-1, FINE).mean(axis=1)

    @property
    def span(self) -> float:
        """Range of the temperature, kelvin."""
        return float(np.ptp(self.temperature))


def thermal_record_of(run: Run) -> ThermalRecord:
    """The thermal record of a run: temperature and drive; position and room if measured.

    Raises DataError without a temperature that changes, or without an input that is a drive.
    """
    name = "current_A" if run.input_unit in TEMPERATURES else "input"
    if not (run.has("temperature_degC") and run.has(name)):
        raise DataError(
            f"{run.path} lacks the wire temperature or the input that heats the wire. A thermal diagnosis needs both."
        )
    clock = run.has("t_s")
    t = run["t_s"] if clock else np.arange(float(len(run)))
    keep = valid_rows(run) & np.isfinite(run["temperature_degC"]) & np.isfinite(t)
    bins = min(MOST_BINS, int(keep.sum()) // BIN_ROWS)
    if bins < FEWEST_BINS or not np.ptp(run["temperature_degC"][keep]):
        raise DataError(
            f"{run.path} holds {int(keep.sum())} temperatures, too few or too steady for a diagnosis."
        )
    edges = np.linspace(t[keep][0], t[keep][-1], bins + 1)
    middle = (edges[1:] + edges[:-1]) / 2
    fine = np.linspace(edges[0], edges[-1], FINE * bins + 1)

    def binned(channel: str) -> Array:
        return _binned(t, run[channel], keep, edges)

    drive = run[name] ** 2 if name == "current_A" or run.input_unit in CURRENTS else run[name]
    room = binned("ambient_degC") if run.has("ambient_degC") else np.zeros(bins)
    share = _share(binned("position")) if run.has("position") else None
    return ThermalRecord(
        t=middle,
        temperature=binned("temperature_degC"),
        drive=_means(t, drive, keep, fine),
        room=np.interp(fine, middle, room),
        share=None if share is None else np.interp(fine, middle, share),
        unit="s" if clock else "sample",
        room_known=run.has("ambient_degC"),
        quantum=float(np.diff(np.unique(run["temperature_degC"][keep])).min()),
    )


def _binned(t: Array, value: Array, keep: NDArray[np.bool_], edges: Array) -> Array:
    """Means (n,) over bins of a value that is linear between rows; spikes of one row left out."""
    known = keep & np.isfinite(value)
    times, y = t[known], _of_three(value[known])
    total = np.r_[0.0, np.cumsum(0.5 * (y[1:] + y[:-1]) * np.diff(times))]
    return np.diff(np.interp(edges, times, total)) / np.diff(edges)


def _means(t: Array, value: Array, keep: NDArray[np.bool_], at: Array) -> Array:
    """Means (N,) of a value that was held up to the time of its row; spikes of one row left out."""
    known = keep & np.isfinite(value)
    times, held = t[known], _of_three(value[known])
    total = np.r_[0.0, np.cumsum(held[1:] * np.diff(times))]
    grown = np.diff(np.interp(at, times, total)) / np.diff(at)
    return np.r_[grown[:1], grown]


def _of_three(y: Array) -> Array:
    """Medians (n,) of three neighbours."""
    padded = np.pad(y, 1, mode="edge")
    return np.median([padded[:-2], padded[1:-1], padded[2:]], axis=0)


def _share(y: Array) -> Array:
    """Position as a share of its range; a spike of one bin is no transformation."""
    smooth = _of_three(y)
    return (smooth - smooth.min()) / (np.ptp(smooth) or 1.0)
