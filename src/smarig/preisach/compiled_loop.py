"""The loop of ``kernel.py`` as numba compiles it: one pass that clips, finds keys and follows the memory.

It differs from the plain loop in form only. A monotone part runs in a loop of its own, in which the end of the branch,
its key and its output are local numbers. An input has one key: as α where the input rises, as β where it falls. That is
also its key if the input turns there. Arrays of both keys would cost more than the loop itself.

Indices are unsigned, because numba checks signed ones for negative values, which takes a quarter of the time. A signed
number in their arithmetic would make them floats. A loop without branches, by selects, has half the speed on smooth
inputs.

Levels are searched by buckets of equal width: a bucket gives the first rank, and halving gives the rest.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array

Levels = tuple[Array, NDArray[np.int32], float, float, float, int]
_ONE, _TWO = np.uint64(1), np.uint64(2)


def bucketed(levels: Array, side: str) -> Levels:
    """For ``rank``: padded levels, first rank of each bucket, origin and scale of the buckets, number of the last
    bucket, most levels in one bucket. ``side`` as for np.searchsorted."""
    if side == "right":  # levels ≤ u are those whose next lower float is < u
        levels = np.nextafter(levels, -np.inf)
    if levels.size == 0:
        return np.array([np.inf]), np.zeros(1, np.int32), 0.0, 0.0, 0.0, 1
    count = min(8 * levels.size, 1 << 16)
    low, width = float(levels[0]), float(levels[-1] - levels[0])
    scale = count / width if width > 0 else 0.0
    # computed as in ``rank``, so that rounding puts an input and its level into buckets in the right order
    own = np.minimum(np.maximum((levels - low) * scale, 0.0), count - 1.0).astype(np.int64)
    begins = np.searchsorted(own, np.arange(count))
    most = int(np.max(np.bincount(own)))
    padded = np.append(levels, np.full(most, np.inf))
    return padded, begins.astype(np.int32), low, scale, count - 1.0, most


def rank(table: Levels, u: float) -> Any:
    """The number of levels < u."""
    levels, begins, low, scale, last, most = table
    found = np.int64(begins[np.uint64(min(max((u - low) * scale, 0.0), last))])
    size = most
    while size > 1:
        half = size >> 1
        found += half if levels[np.uint64(found + half - 1)] < u else 0
        size -= half
    return found + (1 if levels[np.uint64(found)] < u else 0)


def make_compiled_loop(
    between: Callable[..., Any],
    above: Callable[..., Any],
    below: Callable[..., Any],
    rank: Callable[..., Any],
) -> Callable[..., tuple[int, float, float]]:
    """The loop for one Everett function; all arguments are compiled functions.

    ``run(params, u, released, lower, upper, centre, U, K, Y, top, now, out, y)`` follows the inputs ``u`` (n,) from the
    present point (now, out), writes the outputs into ``y`` (n,) and returns the new top, input and output. The stack
    is that of ``kernel.py``.
    """

    def run(params, u, released, lower, upper, centre, U, K, Y, top, now, out, y):
        i, n, top = np.uint64(0), np.uint64(u.size), np.uint64(top)
        # the key of the present point, as α if the input was rising, as β if it was falling
        here = above(params, now, rank) if now > U[top] else below(params, now, rank)
        while i < n:
            v = min(max(u[i], lower), upper)
            if v > now:
                if now < U[top]:  # the input was falling: the present point is a minimum
                    top += _ONE
                    U[top], K[top], Y[top] = now, here, out
                end, key, base = U[top - _ONE], K[top], Y[top]
                while v > now:
                    here = above(params, v, rank)
                    if v < end:
                        out = base + between(params, here, key)
                    else:
                        while v >= U[top - _ONE]:
                            if top < 3:
                                top, U[0], U[1], out = _ONE, v, 2 * centre - v, released[i]
                                break
                            top -= _TWO
                        else:
                            out = Y[top] + between(params, here, K[top])
                        end, key, base = U[top - _ONE], K[top], Y[top]
                    y[i] = out
                    now = v
                    i += _ONE
                    if i < n:
                        v = min(max(u[i], lower), upper)
            elif v < now:
                if now > U[top]:  # the input was rising: the present point is a maximum
                    top += _ONE
                    U[top], K[top], Y[top] = now, here, out
                end, key, base = U[top - _ONE], K[top], Y[top]
                while v < now:
                    here = below(params, v, rank)
                    if v > end:
                        out = base - between(params, key, here)
                    else:
                        while v <= U[top - _ONE]:
                            if top > 2:
                                top -= _TWO
                            elif centre == centre:
                                top, U[0], U[1], out = _ONE, v, 2 * centre - v, released[i]
                                break
                            else:  # negative saturation
                                top, out = _ONE, Y[1]
                                break
                        else:
                            out = Y[top] - between(params, K[top], here)
                        end, key, base = U[top - _ONE], K[top], Y[top]
                    y[i] = out
                    now = v
                    i += _ONE
                    if i < n:
                        v = min(max(u[i], lower), upper)
            else:
                y[i] = out
                i += _ONE
        return int(top), now, out

    return run


def make_batch_loop(follow: Callable[..., Any]) -> Callable[..., None]:
    """A function that follows each row of inputs (n, m) from the same memory, with the loop ``follow``.

    ``batch(params, u, lower, upper, U, K, Y, top, now, out, y)`` writes the outputs into ``y`` (n, m).
    """

    def batch(params, u, lower, upper, U, K, Y, top, now, out, y):
        held, room = U.size, U.size + u.shape[1] + 1
        extrema, keys, outputs = np.empty(room, U.dtype), np.empty(room, K.dtype), np.empty(room, Y.dtype)
        for i in range(u.shape[0]):
            extrema[:held], keys[:held], outputs[:held] = U, K, Y
            follow(params, u[i], u[i], lower, upper, np.nan, extrema, keys, outputs, top, now, out, y[i])

    return batch


def make_tables_loop(follow: Callable[..., Any]) -> Callable[..., None]:
    """A function that follows one row of inputs (m,) with each of many tables on the same nodes, in ``follow``.

    ``tables(params, drops, u, lower, upper, keys, base, now, out, y)``: ``params`` are those of a table without its
    ``drops`` (n, k); ``base`` and ``out`` (n,) are outputs at saturation and at the present input ``now``.
    """

    def tables(params, drops, u, lower, upper, key, base, now, out, y):
        room = u.size + 3
        U, K, Y = np.empty(room), np.empty(room), np.empty(room)
        nodes, inner, width = params
        for i in range(drops.shape[0]):
            U[0], U[1], K[0], K[1], Y[0], Y[1] = np.inf, lower, key, key, base[i], base[i]
            follow((nodes, inner, drops[i], width), u, u, lower, upper, np.nan, U, K, Y, 1, now, out[i], y[i])

    return tables
