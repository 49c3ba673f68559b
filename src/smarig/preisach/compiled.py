"""The Preisach operator's loop compiled by numba (extra ``fast``): ``compiled_loop.py`` for one Everett function.

numba is imported on first use. Each kind of hysteresis is compiled once and kept on disk (``compiled_cache.py``).
Without numba everything runs as plain Python. Only the free functions of a ``KeyedEverett`` are compiled.
"""

from collections.abc import Callable
from functools import cache, lru_cache
from importlib.util import find_spec
from typing import Any

import numpy as np

from smarig.core import Array, MissingExtra, UsageError
from smarig.preisach.compiled_cache import cached_on_disk
from smarig.preisach.compiled_loop import bucketed, make_compiled_loop, rank
from smarig.preisach.kernel import CHUNK, CompiledKeys, ExtremaStack, KernelInput, KeyedEverett, KeyedFunction

WORTH = 500_000  # number of samples for which plain Python takes about as long as compiling
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
    U, Y = np.array(stack.U, float), np.array(stack.Y, float)
    K = np.array(stack.K, type(keyed.place(keyed.params, now)[0]))
    for begin in range(0, inputs.size, CHUNK):
        here = slice(begin, begin + CHUNK)
        missing = top + 1 + CHUNK - U.size
        if missing > 0:
            U, K, Y = (np.concatenate([c, np.zeros(missing + c.size, c.dtype)]) for c in (U, K, Y))
        memory = stack.centre, U, K, Y, top, now, out
        top, now, out = run(params, inputs[here], released[here], given.lower, given.upper, *memory, y[here])
    stack.top = int(top)
    stack.U, stack.K, stack.Y = (c[: top + 1].tolist() for c in (U, K, Y))


@cache
def compiled_loop(between: KeyedFunction, keys: CompiledKeys) -> Callable[..., tuple[int, float, float]]:
    """The compiled loop of an Everett function, from the cache on disk where it is there."""
    import numba

    functions: tuple[Any, ...] = (between, keys.above, keys.below, rank)
    return cached_on_disk(numba.njit(make_compiled_loop(*map(numba.njit, functions)), nogil=True), functions)


@lru_cache(maxsize=8)
def _compiled_params(keyed: KeyedEverett) -> tuple[Any, ...]:
    """The lists of a hysteresis as arrays, those that are searched as ``bucketed`` levels."""
    sides = dict(keyed.compiled_keys.searched) if keyed.compiled_keys else {}
    arrays = [np.array(p, float) if isinstance(p, list) else p for p in keyed.params]
    return tuple(bucketed(p, sides[i]) if i in sides else p for i, p in enumerate(arrays))
