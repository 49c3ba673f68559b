"""A measured wire temperature under a drive of unknown scale, at equally spaced times.

The temperature is the median over a bin. The drive is the mean between two points of a finer grid, so that a step of
the drive within a bin keeps its time.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import DataError
from smarig.identification import valid_rows
from smarig.record import Run

Array = NDArray[np.float64]
MOST_BINS = 240  # a polled, quantised sensor contains no more information
BIN_ROWS = 2
FEWEST_BINS = 40
FINE = 3  # points of the finer grid in a bin
TEMPERATURES = ("K", "degC", "°C")


@dataclass(frozen=True, eq=False)
class ThermalRecord:
    """Times (n,) and temperatures (n,); drive, room (0 if unknown), ξ (None if unknown) at N = ``FINE`` (n − 1) + 1
    times.

    ξ is the transformed share, from the measured position, in [0, 1]. ``unit`` is that of the time: samples if there is
    no clock.
    """

    t: Array
    temperature: Array
    drive: Array
    room: Array
    share: Array | None
    unit: str
    room_known: bool = False

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
        return self.t[0] + self.step * np.arange(self.drive.size)

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
    fine = np.linspace(middle[0], middle[-1], FINE * (bins - 1) + 1)

    def binned(channel: str) -> Array:
        return _medians(t, run[channel], keep, edges)

    drive = run[name] ** 2 if name == "current_A" else run[name]
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
    )


def _medians(t: Array, value: Array, keep: NDArray[np.bool_], edges: Array) -> Array:
    """Medians (n,) over bins; between them where a bin is empty."""
    middle = (edges[1:] + edges[:-1]) / 2
    known = keep & np.isfinite(value)
    which = np.clip(np.searchsorted(edges, t[known], side="right") - 1, 0, middle.size - 1)
    parts = np.split(value[known], np.flatnonzero(np.diff(which)) + 1)
    return np.interp(middle, middle[np.unique(which)], [float(np.median(part)) for part in parts])


def _means(t: Array, value: Array, keep: NDArray[np.bool_], at: Array) -> Array:
    """Means (N,) of a value that is held between rows, each since the time before; spikes of one row left out."""
    known = keep & np.isfinite(value)
    times, held = t[known], _of_three(value[known])
    total = np.r_[0.0, np.cumsum(held[:-1] * np.diff(times))]
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
