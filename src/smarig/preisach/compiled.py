"""The Preisach operator's loop compiled by numba (extra ``fast``): ``compiled_loop.py`` for one Everett function.

numba is imported on first use. Each kind of hysteresis is compiled once and kept on disk (``compiled_cache.py``).
Without numba everything runs as plain Python. Only the free functions of a ``KeyedEverett`` are compiled.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache, lru_cache
from importlib.util import find_spec
from typing import Any

import numpy as np

from smarig.core import Array, MissingExtra, UsageError
from smarig.preisach.compiled_cache import cached_on_disk
from smarig.preisach.compiled_loop import (
    bucketed,
    make_batch_loop,
    make_compiled_loop,
    make_tables_loop,
    rank,
)
from smarig.preisach.kernel import CHUNK, CompiledKeys, ExtremaStack, KernelInput, KeyedEverett, KeyedFunction

WORTH = 500_000  # number of samples for which plain Python takes about as long as compiling
WORTH_A_THREAD = 200_000  # samples in a thread, beside which its start takes no time
_compiled: set[KeyedFunction] = set()


@cache
def compiled_available() -> bool:
    """Whether numba is installed."""
    return find_spec("numba") is not None


def worth_compiling(keyed: KeyedEverett, n: int, wanted: bool | None) -> bool:
    """Whether to compile for n samples. UsageError if ``wanted`` is true and compiling is impossible."""
    if wanted is False or (wanted is None and not (keyed.compiled_keys and compiled_available())):
        return False
    if wanted and keyed.compiled_keys is None:
        raise UsageError("This hysteresis has no compiled form. Leave out compiled=True.")
    if wanted and not compiled_available():
        raise MissingExtra("compiled=True", "fast")
    return bool(wanted) or n >= WORTH or keyed.between in _compiled


def follow(keyed: KeyedEverett, stack: ExtremaStack, kernel_input: KernelInput, y: Array) -> None:
    """``kernel.follow``, compiled: write the outputs (n,) of the inputs into y.

    The inputs are followed in pieces, so that the stack needs room for the turning points of one piece only.
    """
    assert keyed.compiled_keys is not None  # noqa: S101 - else this is not called
    run, params = compiled_loop(keyed.between, keyed.compiled_keys), _compiled_params(keyed)
    _compiled.add(keyed.between)
    given, inputs = kernel_input, np.ascontiguousarray(kernel_input.inputs)
    released = inputs if given.released is None else np.ascontiguousarray(given.released)
    top, now, out = stack.top, float(given.u), float(given.y)
    U, K, Y = _as_arrays(keyed, stack, now, min(CHUNK, inputs.size))
    for begin in range(0, inputs.size, CHUNK):
        here = slice(begin, begin + CHUNK)
        missing = top + 1 + min(CHUNK, inputs.size) - U.size
        if missing > 0:
            U, K, Y = (np.concatenate([c, np.zeros(missing + c.size, c.dtype)]) for c in (U, K, Y))
        memory = stack.centre, U, K, Y, top, now, out
        top, now, out = run(params, inputs[here], released[here], given.lower, given.upper, *memory, y[here])
    stack.top = int(top)
    stack.U, stack.K, stack.Y = (c[: top + 1].tolist() for c in (U, K, Y))


def _as_arrays(keyed: KeyedEverett, stack: ExtremaStack, u: float, more: int) -> tuple[Array, Any, Array]:
    """The lists of a stack as arrays, with room for so many more extrema; ``u`` is an input within the range."""
    held = len(stack.U)
    kind = type(keyed.place(keyed.params, u)[0])
    columns = np.empty(held + more + 1), np.empty(held + more + 1, kind), np.empty(held + more + 1)
    for column, values in zip(columns, (stack.U, stack.K, stack.Y)):
        column[:held] = values
    return columns


def follow_batch(keyed: KeyedEverett, stack: ExtremaStack, kernel_input: KernelInput, y: Array) -> None:
    """Write the outputs (n, m) of inputs (n, m) into y, each row from the memory of the stack, which stays as it is.

    The memory must come from saturation. The rows are shared out among the processors.
    """
    assert keyed.compiled_keys is not None  # noqa: S101 - else this is not called
    run, params = _batch_loop(keyed.between, keyed.compiled_keys), _compiled_params(keyed)
    _compiled.add(keyed.between)
    given, inputs = kernel_input, np.ascontiguousarray(kernel_input.inputs)
    memory = _as_arrays(keyed, stack, float(given.u), 0)
    ends = given.lower, given.upper, *memory, stack.top, float(given.u), float(given.y)

    def follow_rows(rows: slice) -> None:
        run(params, inputs[rows], *ends, y[rows])

    in_threads(follow_rows, *inputs.shape)


def in_threads(work: Callable[[slice], None], rows: int, samples: int) -> None:
    """Do work on all rows of so many samples, in as many threads as have enough to do."""
    threads = max(1, min(_processors(), rows, rows * samples // WORTH_A_THREAD))
    ends = np.linspace(0, rows, threads + 1).astype(int).tolist()
    parts = [slice(begin, end) for begin, end in zip(ends, ends[1:])]
    if threads == 1:
        work(parts[0])
        return
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(work, parts))  # raises what a thread raises


def _processors() -> int:
    """The processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@cache
def compiled_loop(between: KeyedFunction, keys: CompiledKeys) -> Callable[..., tuple[int, float, float]]:
    """The compiled loop of an Everett function, from the cache on disk where it is there."""
    import numba

    functions: tuple[Any, ...] = (between, keys.above, keys.below, rank)
    return cached_on_disk(numba.njit(make_compiled_loop(*map(numba.njit, functions)), nogil=True), functions)


@cache
def _batch_loop(between: KeyedFunction, keys: CompiledKeys) -> Callable[..., None]:
    """The compiled loop over the rows of a batch."""
    import numba

    functions: tuple[Any, ...] = (between, keys.above, keys.below, rank, make_compiled_loop)
    return cached_on_disk(numba.njit(make_batch_loop(compiled_loop(between, keys)), nogil=True), functions)


@cache
def compiled_tables(between: KeyedFunction, keys: CompiledKeys) -> Callable[..., None]:
    """The compiled loop over many tables on the same nodes."""
    import numba

    functions: tuple[Any, ...] = (between, keys.above, keys.below, rank, make_compiled_loop)
    return cached_on_disk(numba.njit(make_tables_loop(compiled_loop(between, keys)), nogil=True), functions)


@lru_cache(maxsize=8)
def _compiled_params(keyed: KeyedEverett) -> tuple[Any, ...]:
    """The lists of a hysteresis as arrays, those that are searched as ``bucketed`` levels."""
    sides = dict(keyed.compiled_keys.searched) if keyed.compiled_keys else {}
    arrays = [np.array(p, float) if isinstance(p, list) else p for p in keyed.params]
    return tuple(bucketed(p, sides[i]) if i in sides else p for i, p in enumerate(arrays))
