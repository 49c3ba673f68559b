"""The partition of the triangle: nodes at the measured levels, and dense where the output moves.

The widest interval is halved repeatedly. Its width is measured half by input and half by its share of the output
change along the data, so flat segments stay coarse.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.identification.positive.observations import Observations

EDGES = 65  # at which the activity is known
_HALF_TO_WHOLE = 4  # interquartile ranges of a normal density: 99 % of it
SAME_LEVEL = 1e-4  # of the range: closer levels share one node


def adapted_nodes(observations: Observations, intervals: int, extrema: Array | None = None) -> Array:
    """Nodes (about ``intervals`` + 1,) from u₋ to u₊: the measured levels if they are few, and refinements.

    ``extrema`` (m,): the last extremum of each; nodes are then dense where the output differs between extrema, also on
    branches without readings.
    """
    lower, upper = observations.lower, observations.upper
    span = upper - lower
    used = np.concatenate([observations.alpha, observations.beta])
    levels = np.setdiff1d(np.clip(used, lower, upper), observations.passed)
    few = _thinned(np.concatenate([[lower], levels, [upper]]), SAME_LEVEL * span)
    if few.size > intervals / 2:  # a dense scan, not a partition: only its ends are special
        few = _thinned(
            np.array([lower, used.min(), observations.alpha.min(), used.max(), upper]), SAME_LEVEL * span
        )
    if extrema is None:
        return _halved(few, *_activity(observations, span), intervals)
    order = np.argsort(extrema, kind="stable")
    at, y = extrema[order], observations.y[order]
    return _halved(
        few, *_shares(at[:-1], at[1:], np.abs(np.diff(y)), np.array([lower, upper]), span), intervals
    )


def active_width(observations: Observations) -> float:
    """The width over which the output moves, as a share of the range: four times the shortest that holds half of its
    change, which is nearly all of a bell-shaped density. At most 1.
    """
    span = observations.upper - observations.lower
    place, share = _activity(observations, span)
    at = np.interp(np.linspace(0.0, 1.0, 2 * EDGES - 1), share, place)
    return min(_HALF_TO_WHOLE * float((at[EDGES - 1 :] - at[:EDGES]).min()) / span, 1.0)


def nodes_along(inputs: Array, outputs: Array, branch: NDArray[np.int64], intervals: int) -> Array:
    """The same along a dense path: inputs and outputs (k,), and the number of the monotone branch of each.

    Nodes reach from the smallest to the largest input.
    """
    span = float(np.ptp(inputs))
    same = branch[1:] == branch[:-1]
    low, high = (end(inputs[1:], inputs[:-1])[same] for end in (np.minimum, np.maximum))
    ends = np.array([inputs.min(), inputs.max()])
    return _halved(ends, *_shares(low, high, np.abs(np.diff(outputs))[same], ends, span), intervals)


def _halved(few: Array, place: Array, share: Array, intervals: int) -> Array:
    """The nodes with the widest interval halved until there are enough."""
    nodes, span = few.tolist(), few[-1] - few[0]
    while len(nodes) <= intervals:
        at = np.array(nodes)
        width = np.diff(at) / span + np.diff(np.interp(at, place, share))
        k = int(np.argmax(width))
        nodes.insert(k + 1, 0.5 * (nodes[k] + nodes[k + 1]))
    return np.array(nodes)


def _thinned(levels: Array, least: float) -> Array:
    """Increasing levels with at least this distance, with the ends kept."""
    kept = [float(np.min(levels))]
    top = float(np.max(levels))
    for u in np.unique(levels):
        if u - kept[-1] > least and top - u > least:
            kept.append(float(u))
    return np.array([*kept, top])


def _activity(observations: Observations, span: float) -> tuple[Array, Array]:
    """Cumulative share of the output change along the branches, over the input (65,).

    Readings on one branch of one memory are in the order of their input, whenever they were taken: what noise and
    repeats add in an interval cancels, and readings of peaks alone form a branch, too.
    """
    last, memory = _last_terms(observations)
    u, y, start = observations.beta[last], observations.y, observations.alpha[last]
    keys = np.stack([memory, observations.zero, np.where(start > u, start, -np.inf)])
    branch = np.unique(keys, axis=1, return_inverse=True)[1].ravel()
    order = np.lexsort((u, branch))
    u, y, branch = u[order], y[order], branch[order]
    same = branch[1:] == branch[:-1]
    low, high, change = u[:-1][same], u[1:][same], np.diff(y)[same]
    edges = np.linspace(observations.lower, observations.upper, EDGES)
    passed = np.clip((edges - low[:, None]) / np.maximum(high - low, 1e-9 * span)[:, None], 0.0, 1.0)
    starts = np.flatnonzero(np.diff(branch[1:][same], prepend=-1))
    net = (
        np.add.reduceat(change[:, None] * np.diff(passed, axis=1), starts, axis=0)
        if starts.size
        else passed[:, 1:]
    )
    share = np.append(0.0, np.cumsum(np.abs(net).sum(axis=0)))
    return edges, share / share[-1] if share[-1] > 0 else (edges - edges[0]) / span


def _shares(low: Array, high: Array, change: Array, ends: Array, span: float) -> tuple[Array, Array]:
    """Cumulative share (65,) of the output changes between pairs of inputs, over the input (65,)."""
    used = high - low > 1e-9 * span
    low, high, change = low[used], high[used], change[used]
    edges = np.linspace(ends[0], ends[1], EDGES)
    share = np.array([np.sum(change * np.clip((e - low) / (high - low), 0.0, 1.0)) for e in edges])
    return edges, share / share[-1] if share.size and share[-1] > 0 else (edges - edges[0]) / span


def _last_terms(observations: Observations) -> tuple[NDArray[np.intp], Array]:
    """The last term (m,) of each observation, whose β is the present input, and a number (m,) of the memory before.

    The last branch has two terms; those before it are the same on all of it.
    """
    order = np.argsort(observations.term, kind="stable")
    ends = np.cumsum(np.bincount(observations.term, minlength=len(observations))) - 1
    earlier = np.delete(order, np.concatenate([ends, ends - 1]))
    corner = observations.sign * (observations.alpha + np.e * observations.beta)
    before = np.bincount(observations.term[earlier], weights=corner[earlier], minlength=len(observations))
    return order[ends], np.asarray(before, dtype=np.float64)
