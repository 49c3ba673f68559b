"""Finds steps in a piecewise constant current, for a recording without steps of its own (§5.2.1).

The position of a step is its mean over the last 25 s of the hold, or over the last quarter of a shorter hold. A
step is settled as on the rig: the means of 25 blocks of a full 25 s window stay within one count.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from smarig.core import Array
from smarig.exchange.runs.reader_result import directions, step_row

WINDOW_S = 25.0
BLOCKS = 25  # of a window, as on a rig, but of few rows each would be noise
PER_BLOCK = 5  # rows at least
MIN_SAMPLES = 5
COMMAND_A = 1e-5  # a command is exact: any change beyond rounding starts another step


@dataclass(frozen=True)
class Recording:
    """Time (n,) s, position (n,) and its resolution (None if unknown)."""

    t_s: Array
    position: Array
    resolution: float | None


def holds(current_A: Array, tolerance_A: float) -> list[tuple[int, int]]:
    """Index ranges [a, b) in which the current stays within ± tolerance of the range's running mean.

    >>> holds(np.array([0.0] * 6 + [0.5] * 7 + [0.6]), 1e-3)
    [(0, 6), (6, 13), (13, 14)]
    """
    if not current_A.size:
        return [(0, 0)]
    begins = np.concatenate([[0], np.flatnonzero(np.diff(current_A)) + 1])  # of runs of equal values
    lengths = np.diff(begins, append=current_A.size)
    edges, mean, n = [0], 0.0, 0
    for k, length, i in zip(begins.tolist(), lengths.tolist(), current_A[begins].tolist(), strict=True):
        if n and abs(i - mean) > tolerance_A:
            edges.append(k)
            n = 0
        mean = (mean * n + i * length) / (n + length)
        n += length
    return list(zip(edges, [*edges[1:], current_A.size]))


def tolerance(measured_A: Array) -> float:
    """Six times the noise of a measured current, at least 0.5 mA and one and a half of its finest steps.

    The noise comes from the median of second differences, so that a ramp has none. For white noise their standard
    deviation is √6 times as large, and the median of |x| is 0.6745 standard deviations.
    """
    noise = np.median(np.abs(np.diff(measured_A, 2))) / (0.6745 * np.sqrt(6)) if measured_A.size > 2 else 0.0
    change = np.abs(np.diff(measured_A))
    finest = change[change > 0].min(initial=np.inf)
    resolution = 1.5 * finest if finest < 2e-3 else 0.0
    return max(5e-4, 6 * float(noise), float(resolution))


def found_steps(
    recording: Recording, ranges: Sequence[tuple[int, int]], target: Callable[[int, int], float]
) -> tuple[list[tuple], Array, list[str]]:
    """Step rows, the step column (n,), and findings; ranges of fewer than 5 samples are not holds."""
    kept = [r for r in ranges if r[1] - r[0] >= MIN_SAMPLES]
    column = np.full(recording.t_s.size, np.nan)
    targets = [target(a, b) for a, b in kept]
    rows, short = [], 0
    for index, ((a, b), branch) in enumerate(zip(kept, directions(targets))):
        column[a:b] = index
        position, n, verdict, is_short = _settle(recording, a, b)
        short += is_short
        span = (float(recording.t_s[a]), float(recording.t_s[b - 1]))
        rows.append(
            step_row(
                index,
                branch=branch,
                target=targets[index],
                span_s=span,
                verdict=verdict,
                position=position,
                n=n,
            )
        )
    return rows, column, _remarks(rows, short, len(ranges) - len(kept), recording.resolution)


def _settle(recording: Recording, a: int, b: int) -> tuple[float | None, int, str, bool]:
    t_s = recording.t_s[a:b]
    usual_s = (t_s[-1] - t_s[0]) / (t_s.size - 1)
    held_s = t_s[-1] - t_s[0] + usual_s
    short = held_s < WINDOW_S * (1 - 1e-6)
    window_s = held_s / 4 if short else WINDOW_S
    inside = recording.position[a:b][t_s > t_s[-1] - window_s + 1e-9 * held_s]
    known = inside[np.isfinite(inside)]
    if not known.size:
        return None, 0, "elapsed", short
    blocks = min(BLOCKS, max(known.size // PER_BLOCK, 2))
    means = [float(block.mean()) for block in np.array_split(known, min(blocks, known.size))]
    still = recording.resolution is not None and max(means) - min(means) <= recording.resolution
    return float(known.mean()), known.size, "settled" if still and not short else "elapsed", short


def _remarks(rows: list[tuple], short: int, dropped: int, resolution: float | None) -> list[str]:
    if not rows:
        return ["No step was found: the current is never held for five samples."]
    moving = sum(row[7] != "settled" for row in rows) - short
    out = [
        f"{len(rows)} steps were found from the current. Positions are means over the last 25 s of each hold."
    ]
    if short:
        out.append(
            f"{short} holds are shorter than 25 s. Their last quarter was averaged, "
            f"and they count as elapsed."
        )
    if moving > 0 and resolution is None:
        out.append("The resolution of the position is unknown, so no step counts as settled. Give --rig.")
    elif moving > 0:
        out.append(f"{moving} holds still moved by more than one count ({resolution:.3g}) at their end.")
    if dropped:
        out.append(f"{dropped} segments of fewer than five samples at one current do not count as steps.")
    return out
