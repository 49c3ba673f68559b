"""How well each reading is known by itself: noise of its instrument, what it shares with others, its unit.

Positions of one sitting share a zero, a resistance has a zero and a scale of its own, other channels stand apart.
Knows neither density nor draughts.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis import given
from smarig.story.retelling import Retelling
from smarig.story.subject import Subject
from smarig.story.told import Readings, Story

Array = NDArray[np.float64]
ANY = 30.0  # sd of a zero, in ranges of the output: whatever it likes
INEXACT = 0.01  # of what an effect adds: no mechanism is exactly its equation
UNSEEN = 0.03  # of the stroke: what may lie beyond the farthest hold, and is part of what a resistance tells
JITTER_S = 0.02  # of a time stamp: what moves fast is known no better


def units(
    story: Story, told: Retelling, subject: Subject, coupled: list[Readings], speed: Array, added: Array
) -> tuple[Array, Array, Array, Array]:
    """Per coupled reading: own white noise (scaled), covariance of free zeros, scale, slope to y (scaled)."""
    raw, span = raw_noise(story, subject), subject.stroke
    white, scale, zero, at = [], [], [], 0
    for k, r in enumerate(coupled):
        y = r.value - told.values[r.kind]
        own = {"settled": 0.0, "moving": raw}.get(r.kind)
        noise = max(_local_noise(y), _FINEST["resistance"]) if own is None else own
        scale.append(np.full(len(r), noise if own is None else span))
        late = JITTER_S * speed[at : at + len(r)] if r.kind == "moving" else np.zeros(len(r))
        late = given.scatter(story, told, subject) if story.given else late
        rough = INEXACT * np.abs(added[at : at + len(r)])
        white.append(np.full(len(r), 1.0) if own is None else np.sqrt(noise**2 + late**2 + rough**2) / span)
        at += len(r)
        shared = story.zero[r.step] if story.zero.size else np.zeros(len(r), dtype=np.int64)
        zero.append(np.full(len(r), -1 - k) if own is None else shared)
    own_zero, scales = np.concatenate(zero), np.concatenate(scale)
    same = own_zero[:, None] == own_zero[None, :]
    size = np.where(own_zero >= 0, ANY, _ANY_ZERO)
    slope = told.follows * span / scales
    free = np.where(same, np.outer(size, size), 0.0)
    beyond = np.where(own_zero >= 0, 0.0, UNSEEN * slope * (told.output - subject.hysteresis.y_lower) / span)
    return np.concatenate(white), free + np.outer(beyond, beyond), scales, slope


def speed(told: Retelling, path: Array) -> Array:
    """Output per second at each coupled reading, over the tick before it; ``path`` (m,) is the output at ticks."""
    at, before = told.marks, np.maximum(told.marks - 1, 0)
    return np.abs(path[at] - path[before]) / np.maximum(told.t_s[at] - told.t_s[before], 1e-9)


def raw_noise(story: Story, subject: Subject) -> float:
    """Sd of a single position reading, from the scatter within settled windows; half a count at least."""
    return float(np.sqrt(max(_scatter(story), (0.5 * subject.per_count) ** 2, 1e-12)))


@lru_cache(maxsize=8)
def _scatter(story: Story) -> float:
    """Variance of neighbours in settled windows, the usual one; it is asked for at every refit."""
    spread = []
    for run in story.runs:
        for step in run.settled[:: max(1, len(run.settled) // 40)]:
            rows = np.flatnonzero(run["step"] == step.index)[-max(step.n, 1) :]
            if rows.size > 20:
                spread.append(float(np.var(np.diff(run["position"][rows])) / 2))
    return float(np.median(spread)) if spread else 0.0


_FINEST = {"resistance": 5e-4, "current": 5e-5, "room": 0.005}  # ohm, A, K: no instrument is better
_ANY_ZERO = 1e3  # sd of a block's own zero, in noises: sure to be absorbed, and no trouble for rounding


def apart(readings: Readings, story: Story, told: Retelling) -> tuple[Array, Array, Array]:
    """A block of its own, white noise judged by what a smooth curve leaves; free constants but for currents."""
    y = readings.value - told.values[readings.kind]
    noise = max(_local_noise(y), _FINEST[readings.kind])
    if readings.kind == "current":
        return np.eye(y.size), np.full(y.size, noise), y
    sitting = story.sitting[readings.step]
    same = np.where(sitting[:, None] == sitting, _ANY_ZERO**2, 0.0)
    return same + np.eye(y.size), np.full(y.size, noise), y - own_means(y, readings, story)


def own_means(y: Array, readings: Readings, story: Story) -> Array:
    """The mean (n,) of each sitting."""
    sitting = story.sitting[readings.step]
    return (np.bincount(sitting, y) / np.maximum(np.bincount(sitting), 1))[sitting]


def _local_noise(y: Array) -> float:
    """Sd of white noise from second differences of neighbours, robustly."""
    bends = y[:-2] - 2 * y[1:-1] + y[2:]
    return max(
        float(np.median(np.abs(bends))) / 0.6745 / np.sqrt(6.0), 1e-9 * max(float(np.abs(y).max()), 1e-9)
    )
