"""By how much an explanation misses the readings of each channel, in units of the channel's noise."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from smarig.diagnosis.refit.refit import Refit
from smarig.replay import OUTPUT_DEPENDENT_KINDS, PlantModel, Timeline, predict

CHANNELS = ("resistance", "current")  # whose noise is known from neighbouring readings
EQUATION_ERROR = 0.02  # of the change by effects: their equations are approximations


@dataclass(frozen=True)
class ChannelMisfit:
    """The rms of a channel's errors over their noise, without and with effects, and the number of readings.

    ``expected`` is the rms that noise and approximate equations leave.
    """

    channel: str
    readings: int
    before: float
    after: float
    expected: float = 1.0

    @property
    def nats(self) -> float:
        """What the effects gain in this channel."""
        return 0.5 * self.readings * (self.before**2 - self.after**2)


def channel_misfits(
    timeline: Timeline, plain: tuple[PlantModel, Refit], extended: tuple[PlantModel, Refit]
) -> tuple[ChannelMisfit, ...]:
    """The misfit of each channel besides the positions, from plant models and refits without and with effects."""
    without, with_effects = (predict(timeline, model).values for model, _ in (plain, extended))
    found = []
    for kind, rows in _rows(timeline):
        if kind not in CHANNELS or rows.start == rows.stop:
            continue
        before, after = (_rms(fit.data[rows]) for _, fit in (plain, extended))
        change = (with_effects[kind] - without[kind]) / extended[1].scale[rows]
        expected = float(np.hypot(1.0, EQUATION_ERROR * _rms(change)))
        found.append(ChannelMisfit(kind, rows.stop - rows.start, before, after, expected))
    return tuple(found)


def _rows(timeline: Timeline) -> Iterator[tuple[str, slice]]:
    """The rows of each kind of readings in a refit: first those that depend on the output."""
    at = 0
    for readings in sorted(timeline.all_readings, key=lambda r: r.kind not in OUTPUT_DEPENDENT_KINDS):
        yield readings.kind, slice(at, at + len(readings))
        at += len(readings)


def _rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(x**2)))
