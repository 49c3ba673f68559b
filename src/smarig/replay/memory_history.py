"""The memory of a Preisach operator at each point of a record: its remembered extrema.

The operator's own wiping-out (§3.3.1) is run on a hysteresis without output. Reversals between settled points count
too: a waveform or a closed loop leaves its extrema like any step.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError
from smarig.measurement import STARTS, Start, may_assume_start, noise_at_start, starting_state
from smarig.preisach import Preisach, RelayMeasure, State
from smarig.record import Run, continues_run
from smarig.replay.measured_input import driven_by_input

INPUT_TOLERANCE = 1e-6  # of the range: inputs that are closer count as equal
MIN_REVERSAL = 0.01  # of the range of settled inputs: smaller reversals are noise of the current
_MIRROR: dict[Start, Start] = {"negative": "positive", "positive": "negative", "anhysteretic": "anhysteretic"}


def memory_states(
    inputs: Iterable[float], lower: float, upper: float, start: Start | State | None
) -> list[State | None]:
    """The memory after each input, None while it is unknown.

    An unknown start becomes known at the first input that saturates, at ``lower`` or ``upper``.
    """
    operator = Preisach(RelayMeasure.zero(lower, upper), start or "anhysteretic")
    known = start is not None
    states: list[State | None] = []
    for u in inputs:
        operator.step(float(u))
        known = known or not lower < u < upper
        states.append(operator.state if known else None)
    return states


@dataclass(frozen=True)
class MemoryHistory:
    """Inputs and outputs (k,) of one run's settled points, with the memory at its start, at each point and at its end.

    A memory is None while it is unknown. ``turns`` are turning points of the input between the settled points.
    ``continued``: the run starts in the final state of the run before it.
    """

    inputs: Array
    outputs: Array
    start: State | None
    states: tuple[State | None, ...]
    final_state: State | None
    turns: Array
    continued: bool


def memory_histories(
    runs: Sequence[Run], *, mirrored: bool = False
) -> tuple[float, float, list[MemoryHistory]]:
    """Range (u₋, u₊) of all runs together, and the history of each; with inverted signs if ``mirrored``.

    A run starts in the final state of the run before it if it continues that run, else in its ``starting_state``. That
    of a run with a heating current is unknown if it is neither recorded nor evident from the first sample.
    """
    sign = -1.0 if mirrored else 1.0
    records = [run.points() for run in runs]
    named: list[Start | None] = [recorded_start(run, mirrored=mirrored) for run in runs]
    inputs = merged_inputs(sign * np.concatenate([u for u, _ in records]))
    lower, upper = _range(inputs, named, absolute=not driven_by_input(runs))
    found: list[MemoryHistory] = []
    at = 0
    for k, (run, (_, y)) in enumerate(zip(runs, records)):
        continued = named[k] is None and k > 0 and continues_run(runs[k - 1], run)
        start: Start | State | None = found[-1].final_state if continued else None
        first_known = 0
        if start is None:
            seen = starting_state(
                named[k],
                sign * run.points()[0],
                (lower, upper),
                first_input=sign * float(run["input"][0]) if len(run) else None,
                may_assume=may_assume_start(run),
                outputs=y,
                noise=noise_at_start(run),
            )
            start, first_known = seen.state, seen.first
        u = inputs[at : at + y.size]
        at += y.size
        first = Preisach(RelayMeasure.zero(lower, upper), start).state if start is not None else None
        traversed, where = input_path(run)
        path = np.clip(
            sign * traversed, lower, upper
        )  # a turning point beyond all relays only saturates them
        path[where] = u
        states, final_state = _states_at_points(path, where, sign * run["input"][-1:], (lower, upper), first)
        found.append(
            MemoryHistory(
                inputs=u,
                outputs=sign * y,
                start=first,
                states=(*(None,) * first_known, *states[first_known:]),
                final_state=final_state,
                turns=np.delete(path, where),
                continued=continued,
            )
        )
    return lower, upper, found


def _states_at_points(
    path: Array, where: NDArray[np.intp], end: Array, ends: tuple[float, float], start: State | None
) -> tuple[tuple[State | None, ...], State | None]:
    """The memory at the settled points of a path, and at its last input (1,)."""
    states = memory_states([*path, *end[np.isfinite(end)]], *ends, start)
    return tuple(states[k] for k in where), states[-1] if states else start


def recorded_start(run: Run, *, mirrored: bool = False) -> Start | None:
    """The recorded initial state of a run, None if not recorded."""
    for start in STARTS:
        if run.info.initial == start:
            return _MIRROR[start] if mirrored else start
    return None


def _range(inputs: Array, starts: Sequence[Start | None], *, absolute: bool) -> tuple[float, float]:
    """Range of the relays: that of the inputs, including zero for a run from rest, symmetric around B*.

    ``absolute``: zero input is the rest state, which it is for a current, but not for a temperature in °C.
    """
    if inputs.size == 0:
        raise DataError("The runs contain no settled points. A model needs settled points.")
    lower, upper = float(inputs.min()), float(inputs.max())
    if "negative" in starts and absolute:  # a cold wire rests at zero input
        lower = min(lower, 0.0)
    if "positive" in starts and absolute:
        upper = max(upper, 0.0)
    if "anhysteretic" in starts:
        reach = max(-lower, upper)
        lower = lower if -lower >= reach * (1 - INPUT_TOLERANCE) else -reach
        upper = upper if upper >= reach * (1 - INPUT_TOLERANCE) else reach
    return lower, upper


def merged_inputs(inputs: Array) -> Array:
    """Inputs that differ only by rounding (``INPUT_TOLERANCE`` of the range), made equal.

    >>> merged_inputs(np.array([0.0, 100.0, 1e-9, 50.0])).tolist()
    [0.0, 100.0, 0.0, 50.0]
    """
    if inputs.size == 0:
        return inputs
    values, where = np.unique(inputs, return_inverse=True)
    first = np.concatenate([[True], np.diff(values) > INPUT_TOLERANCE * (values[-1] - values[0])])
    return values[first][np.cumsum(first) - 1][where]


def input_path(run: Run) -> tuple[Array, NDArray[np.intp]]:
    """Inputs (m,) in time order, with the turning points between settled points, and the rows of settled points (k,).

    A reversal within ``MIN_REVERSAL`` of a settled level counts as that level, because a predicted input only
    approaches its target.
    """
    points = run.points()[0]
    if not run.settled:
        return points, np.arange(points.size)
    min_reversal = MIN_REVERSAL * float(np.ptp(points))
    inputs: list[float] = []
    where = []
    for before, point, traversed in zip([None, *points[:-1]], points.tolist(), _inputs_before_points(run)):
        inputs += _snapped_to_levels(
            reversals_between(traversed, before, point, min_reversal), points, min_reversal
        )
        where.append(len(inputs))
        inputs.append(point)
    inputs += _snapped_to_levels(
        reversals_between(_inputs_after_last_point(run), inputs[-1], None, min_reversal), points, min_reversal
    )
    return np.array(inputs), np.array(where)


def _snapped_to_levels(found: list[float], levels: Array, min_reversal: float) -> list[float]:
    nearest = [float(levels[np.argmin(np.abs(levels - u))]) for u in found]
    return [level if abs(level - u) <= min_reversal else u for u, level in zip(found, nearest)]


def reversals_between(
    traversed: Array, before: float | None, after: float | None, min_reversal: float
) -> list[float]:
    """The turning points of a record (n,) between two inputs, larger than ``min_reversal``, without its ends.

    >>> reversals_between(np.array([0.0, 5.0, 80.0, 41.0, 20.0, 40.0]), 0.0, 43.0, 1.0)
    [80.0, 20.0]
    """
    ends = [[] if u is None else [u] for u in (before, after)]
    u = np.concatenate([ends[0], traversed[np.isfinite(traversed)], ends[1]])
    if u.size < 3 or _is_monotone(u, min_reversal) or min_reversal <= 0:
        return []
    found = [float(u[0])]
    up = None
    for v in u[1:].tolist():
        if up is None:
            if abs(v - found[0]) > min_reversal:
                up = v > found[0]
                found.append(v)
        elif (v > found[-1]) == up:
            found[-1] = v
        elif abs(v - found[-1]) > min_reversal:
            found.append(v)
            up = not up
    return found[1:] if after is None else found[1:-1]


def _is_monotone(u: Array, min_reversal: float) -> bool:
    """Whether u never reverses by more than ``min_reversal``; true for most steps, and quick to check."""
    back = (np.maximum.accumulate(u) - u).max() if u[-1] >= u[0] else (u - np.minimum.accumulate(u)).max()
    return bool(back <= min_reversal)


def _inputs_before_points(run: Run) -> list[Array]:
    """Predicted inputs before each settled point, since the previous one."""
    t, inputs = run["t_s"], run["input"]
    ends = np.searchsorted(t, [s.t_end_s if s.t_end_s is not None else np.nan for s in run.settled], "left")
    return np.split(inputs, ends)[:-1]


def _inputs_after_last_point(run: Run) -> Array:
    last = run.settled[-1].t_end_s
    return run["input"][run["t_s"] > last] if last is not None else np.empty(0)
