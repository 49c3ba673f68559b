"""The loop of the Preisach operator: an array of inputs applied to the stack of remembered extrema.

It runs as plain Python on lists; ``compiled_loop.py`` has the form that numba compiles, with the same arithmetic. A
single step is the same loop with one input. A hysteresis provides a ``KeyedEverett``: the keys of an input (as α and
as β), and the Everett function of two keys.

The stack: ``U[1] … U[top]`` are the remembered extrema, alternating maxima and minima. ``K`` are their keys (as α for a
maximum, as β for a minimum) and ``Y`` the outputs at them. The present branch ends where it passes ``U[top − 1]``; the
loop that it closes there is wiped out. The element below the oldest extremum defines the input beyond which that
extremum is wiped out too:

* from saturation ``U[0] = +∞`` and ``U[1] = u₋``: only u₋ itself erases everything;
* from a diagonal state B_ℓ ``U[0]`` is the furthest input so far and ``U[1] = 2ℓ − U[0]`` its mirror image.
  An input beyond either starts again from B_ℓ, with the output given as ``released``.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from math import inf, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.preisach.everett import Everett
from smarig.preisach.state import State

KeyedFunction = Callable[[Any, Any, Any], float]
LoopFunction = Callable[..., int]
CHUNK = 1 << 14


@dataclass(frozen=True, eq=False, slots=True)
class KeyedEverett:
    """A hysteresis as the loop uses it. ``between`` and the functions of ``compiled_keys`` can be compiled by numba.

    ``between(params, a, b)`` is F(α, β) for keys. ``place(params, u)`` gives an input's keys as α and as β.
    ``places(u)`` does the same for an array. ``params`` holds lists and numbers. Inputs lie in [u₋, u₊].
    Without ``compiled_keys`` a hysteresis has no compiled form.
    """

    between: KeyedFunction
    params: Any
    place: Callable[[Any, float], tuple[Any, Any]]
    places: Callable[[Array], tuple[NDArray, NDArray]]
    compiled_keys: "CompiledKeys | None" = None


@dataclass(frozen=True)
class CompiledKeys:
    """How compiled code finds keys: ``above(params, u, rank)`` as α and ``below(params, u, rank)`` as β.

    ``searched`` names the lists of ``params`` that are levels, by index, with a side. In compiled code
    ``rank(params[i], u)`` is np.searchsorted(params[i], u, side).
    """

    above: Callable[[Any, float, Any], Any]
    below: Callable[[Any, float, Any], Any]
    searched: tuple[tuple[int, str], ...] = ()


def input_as_keys(_params: Any, u: float) -> tuple[float, float]:
    """Keys of a hysteresis whose Everett function takes the inputs themselves."""
    return u, u


def inputs_as_keys(u: Array) -> tuple[Array, Array]:
    """``input_as_keys`` for arrays."""
    return u, u


def _input_as_key(_params: Any, u: float, _rank: Any) -> float:
    return u


INPUTS_AS_KEYS = CompiledKeys(_input_as_key, _input_as_key)


def _call_everett(everett: Callable[[float, float], float], alpha: float, beta: float) -> float:
    return everett(alpha, beta)


def keyed(hysteresis: Everett) -> KeyedEverett:
    """The hysteresis's own ``keyed``, or a wrapper that calls its method ``everett`` for each sample."""
    own = getattr(hysteresis, "keyed", None)
    return (
        own
        if isinstance(own, KeyedEverett)
        else KeyedEverett(_call_everett, hysteresis.everett, input_as_keys, inputs_as_keys)
    )


def make_loop(between: KeyedFunction) -> LoopFunction:
    """The loop for one Everett function.

    ``run(params, u, a, b, y, released, centre, U, K, Y, top)`` follows the inputs ``u[1:]`` with keys ``a`` and ``b``
    from the present point (u[0], y[0]), writes the outputs into ``y`` and returns the new ``top``. ``U``, ``K`` and
    ``Y`` must have room for one more extremum per input. ``centre`` is ℓ, or NaN if the memory holds no diagonal
    state; then ``released`` is not read.
    """

    def run(params, u, a, b, y, released, centre, U, K, Y, top):
        now, out = u[0], y[0]
        for i in range(1, len(u)):
            v = u[i]
            if v > now:
                if now < U[top]:  # the input was falling: the present point is a minimum
                    top += 1
                    U[top], K[top], Y[top] = now, b[i - 1], out
                while v >= U[top - 1]:
                    if top < 3:
                        top, U[0], U[1], out = 1, v, 2 * centre - v, released[i]
                        break
                    top -= 2
                else:
                    out = Y[top] + between(params, a[i], K[top])
            elif v < now:
                if now > U[top]:  # the input was rising: the present point is a maximum
                    top += 1
                    U[top], K[top], Y[top] = now, a[i - 1], out
                while v <= U[top - 1]:
                    if top > 2:
                        top -= 2
                    elif centre == centre:
                        top, U[0], U[1], out = 1, v, 2 * centre - v, released[i]
                        break
                    else:  # negative saturation
                        top, out = 1, Y[1]
                        break
                else:
                    out = Y[top] - between(params, K[top], b[i])
            y[i] = out
            now = v
        return top

    return run


python_loop = cache(make_loop)  # one closure per Everett function


class ExtremaStack:
    """``U``, ``K``, ``Y`` and ``top`` of the module's docstring as lists; ``centre`` is ℓ or NaN."""

    __slots__ = ("K", "U", "Y", "centre", "top")

    def __init__(
        self, below: float, extrema: Sequence[float], keys: Sequence, outputs: Sequence, centre: float
    ) -> None:
        self.U, self.K, self.Y = [below, *extrema], [keys[0], *keys], [outputs[0], *outputs]
        self.top, self.centre = len(extrema), centre

    @classmethod
    def from_state(cls, state: State, place: Callable[[float], tuple[Any, Any]]) -> "ExtremaStack":
        """The memory of a state. Its present point is not stored as an extremum; ``place`` gives keys."""
        extrema, below, centre = [*state.extrema], inf, nan
        if state.diagonal:
            below, centre = (*extrema, state.u)[1], extrema[0]
            extrema[0] = 2 * centre - below
        first_is_minimum = below > extrema[0]
        keys = [place(u)[(i % 2 == 0) == first_is_minimum] for i, u in enumerate(extrema)]
        return cls(below, extrema, keys, state.outputs, centre)

    def reserve(self, more: int) -> None:
        """Make room for this many more extrema."""
        missing = self.top + 1 + more - len(self.U)
        if missing > 0:
            for column in (self.U, self.K, self.Y):
                column.extend(column[:1] * missing)


@dataclass(frozen=True, slots=True)
class KernelInput:
    """The input of the loop: present point, inputs (n,), saturations that clip them, and ``released`` (n,)."""

    u: float
    y: float
    inputs: Array
    lower: float
    upper: float
    released: Array | None = None

    def chunks(self) -> Iterator[tuple[slice, Array, Array]]:
        """Slices of ``inputs``, each with its clipped inputs after the preceding one, and with ``released``."""
        before = self.u
        for begin in range(0, self.inputs.size, CHUNK):
            where = slice(begin, begin + CHUNK)
            part = np.concatenate([[before], self.inputs[where]])
            np.clip(part, self.lower, self.upper, out=part)
            released_part = part if self.released is None else np.concatenate([[0.0], self.released[where]])
            yield where, part, released_part
            before = part[-1]


def follow(keyed: KeyedEverett, stack: ExtremaStack, kernel_input: KernelInput, y: Array) -> None:
    """Write the outputs (n,) of the inputs into y, in plain Python.

    It works in chunks, so that Python numbers never take more than a few megabytes.
    """
    run, last = python_loop(keyed.between), kernel_input.y
    for where, part, released_part in kernel_input.chunks():
        u = part.tolist()
        a, b = (u if key is part else key.tolist() for key in keyed.places(part))
        released = u if released_part is part else released_part.tolist()
        out = [last, *u[1:]]
        stack.reserve(len(u))
        memory = stack.centre, stack.U, stack.K, stack.Y, stack.top
        stack.top = run(keyed.params, u, a, b, out, released, *memory)
        y[where] = out[1:]
        last = out[-1]
