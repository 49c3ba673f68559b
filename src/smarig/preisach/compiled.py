"""The loop of ``kernel.py`` compiled by numba (extra ``fast``): the same source, on arrays instead of lists.

numba is imported on first use, and each kind of hysteresis is compiled once. Without numba everything runs as plain
Python. Only the free functions of a ``KeyedEverett`` are compiled.
"""

from functools import cache, lru_cache
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import UsageError
from smarig.preisach.kernel import (
    Array,
    ExtremaStack,
    KernelInput,
    KeyedEverett,
    KeyedFunction,
    LoopFunction,
    Search,
    make_loop,
)

WORTH = 500_000  # number of samples for which plain Python takes about as long as compiling
_compiled: set[KeyedFunction] = set()


@cache
def compiled_available() -> bool:
    """Whether numba is installed."""
    return find_spec("numba") is not None


def worth_compiling(keyed: KeyedEverett, n: int, wanted: bool | None) -> bool:
    """Whether to compile for n samples. UsageError if ``wanted`` is true and compiling is impossible."""
    if wanted is False or (wanted is None and not (keyed.compilable and compiled_available())):
        return False
    if wanted and not keyed.compilable:
        raise UsageError("This hysteresis has no compiled form. Leave out compiled=True.")
    if wanted and not compiled_available():
        raise UsageError("numba is not installed. Install smarig[fast], or leave out compiled=True.")
    return bool(wanted) or n >= WORTH or keyed.between in _compiled


def follow(keyed: KeyedEverett, stack: ExtremaStack, kernel_input: KernelInput, y: Array) -> None:
    """``kernel.follow``, compiled: write the outputs (n,) of the inputs into y."""
    run, (params, search), last = _loop(keyed.between), _prepared_arrays(keyed), kernel_input.y
    _compiled.add(keyed.between)
    top, U, Y = stack.top, np.array(stack.U), np.array(stack.Y)
    K = np.array(stack.K, dtype=keyed.places(np.array([kernel_input.u]), search)[0].dtype)
    for where, u, released in kernel_input.chunks():
        missing = top + u.size - U.size
        if missing > 0:
            U, K, Y = (np.concatenate([c, np.zeros(missing + c.size, c.dtype)]) for c in (U, K, Y))
        a, b = keyed.places(u, search)
        out = np.full(u.size, last)
        top = run(params, u, a, b, out, released, stack.centre, U, K, Y, top)
        y[where] = out[1:]
        last = out[-1]
    stack.top = int(top)
    stack.U, stack.K, stack.Y = (c[: top + 1].tolist() for c in (U, K, Y))


@cache
def _loop(between: KeyedFunction) -> LoopFunction:
    import numba

    return numba.njit(make_loop(numba.njit(between)), nogil=True)


@lru_cache(maxsize=8)
def _prepared_arrays(keyed: KeyedEverett) -> tuple[tuple[Any, ...], Search]:
    """The hysteresis's lists as arrays, and a search that caches the tables of its levels."""
    buckets: dict[tuple[int, str], tuple] = {}

    def search(levels: Array, u: Array, side: str) -> NDArray[np.intp]:
        # the levels exist as long as the hysteresis, which exists as long as ``keyed``
        key = id(levels), side
        if key not in buckets:
            buckets[key] = _buckets(levels, side)
        return _ranks()(*buckets[key], u)

    return tuple(np.array(p) if isinstance(p, list) else p for p in keyed.params), search


def _buckets(levels: Array, side: str) -> tuple[Array, NDArray[np.int32], float, float, int]:
    """Padded levels, first rank of each bucket, origin and scale of the buckets, most levels in one bucket."""
    if side == "right":  # levels ≤ u are those whose next lower float is < u
        levels = np.nextafter(levels, -np.inf)
    if levels.size == 0:
        return np.array([np.inf]), np.zeros(1, np.int32), 0.0, 0.0, 1
    count = min(8 * levels.size, 1 << 16)
    low, width = float(levels[0]), float(levels[-1] - levels[0])
    scale = count / width if width > 0 else 0.0
    # computed as in ``ranks``, so that rounding puts an input and its level into buckets in the right order
    own = np.minimum(np.maximum((levels - low) * scale, 0.0), count - 1.0).astype(np.int64)
    begins = np.searchsorted(own, np.arange(count))
    most = int(np.max(np.bincount(own)))
    return np.append(levels, np.full(most, np.inf)), begins.astype(np.int32), low, scale, most


@cache
def _ranks() -> Any:
    """Numbers of levels < u for an array. Each step handles all inputs, so no branch is mispredicted."""
    import numba

    def ranks(levels, begins, low, scale, most, u):
        rank = np.empty(u.size, np.int64)
        last = begins.size - 1.0
        for i in range(u.size):
            rank[i] = begins[int(min(max((u[i] - low) * scale, 0.0), last))]
        size = most
        while size > 1:
            half = size >> 1
            for i in range(u.size):
                rank[i] += half if levels[rank[i] + half - 1] < u[i] else 0
            size -= half
        for i in range(u.size):
            rank[i] += 1 if levels[rank[i]] < u[i] else 0
        return rank

    return numba.njit(ranks, nogil=True)
