"""Reduced memory sequences s ∈ 𝒮 (§6.3.1): the extrema of an input that have not been wiped out.

s₁ is the extremum of largest |u|. Later extrema alternate about the present input and approach it. The thesis's
sequences are infinite. Here a sequence is a finite prefix with one of two continuations: the constant s_N if N(s) (6.3)
is finite, or a remainder within ``remainder`` of s_N if an infinite sequence was truncated. The times of the extrema
have no influence.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from smarig.core import UsageError

MAX_ELEMENTS = 1_000_000


@dataclass(frozen=True)
class MemorySequence:
    """s₁ … s_N (``values``) with |s_i| ≤ û (``bound``), then s_i = s_N, or within ``remainder`` of it.

    Definition 6.4 requires that the even and odd subsequences are strictly monotone in opposite directions and converge
    to one limit: each s_i lies strictly between its two predecessors. It must also require |s₂| < |s₁|, which the
    thesis omits. Otherwise (1, −5) would be allowed, although −5 wipes out 1. A repeated end (the thesis's tail) is
    dropped. UsageError names the element that violates this.

    >>> s = MemorySequence((5, -3, 2), bound=10)
    >>> s.N, s.limit, [s.at(i) for i in range(6)]
    (3, 2.0, [0.0, 5.0, -3.0, 2.0, 2.0, 2.0])
    """

    values: tuple[float, ...]
    bound: float
    remainder: float = 0.0

    def __post_init__(self) -> None:
        values = [float(v) for v in self.values]
        while len(values) > 1 and values[-1] == values[-2]:
            values.pop()
        _check(values, self.bound)
        object.__setattr__(self, "values", tuple(values))

    @classmethod
    def truncated(cls, elements: Iterable[float], bound: float, within: float) -> "MemorySequence":
        """An infinite sequence, truncated as soon as neighbours differ by no more than ``within`` (or at its end).

        All later elements lie between the last two. The omitted part therefore changes the boundary by an area of at
        most ``truncation_area`` and the present input by at most ``remainder``.

        >>> from itertools import count
        >>> s = MemorySequence.truncated((8 * (-0.5) ** i for i in count()), bound=10, within=1e-3)
        >>> s.N, s.remainder, s.truncation_area < 1e-6
        (16, 0.000732421875, True)
        """
        if not within > 0:
            raise UsageError(
                f"An infinite memory sequence needs a positive difference at which it is cut off, got {within:g}."
            )
        values: list[float] = []
        for element in elements:
            if len(values) == MAX_ELEMENTS:
                raise UsageError(
                    f"Memory sequence: neighbours still differ by more than {within:g} after {MAX_ELEMENTS} "
                    "elements. Give a sequence that converges (Def. 6.4), or a larger difference."
                )
            values.append(element)
            if len(values) > 1 and abs(values[-1] - values[-2]) <= within:
                return cls(tuple(values), bound, abs(values[-1] - values[-2]))
        return cls(tuple(values), bound)

    @property
    def N(self) -> int:
        """N(s) (6.3): the index from which s is constant; for a truncated sequence, the retained length."""
        return len(self.values)

    @property
    def limit(self) -> float:
        """lim s_i = u(τ) (6.2), to within ``remainder``."""
        return self.values[-1]

    @property
    def truncation_area(self) -> float:
        """Largest area between the boundary of this prefix and that of the whole sequence."""
        return 0.5 * self.remainder**2

    def at(self, i: int) -> float:
        """s_i for any i ≥ 0; s₀ = 0."""
        return 0.0 if i == 0 else self.values[min(i, self.N) - 1]


def _check(values: list[float], bound: float) -> None:
    if not values:
        raise UsageError("A memory sequence needs at least one element, the present input.")
    for i, s in enumerate(values, start=1):
        if not abs(s) <= bound:
            raise UsageError(f"Memory sequence: s_{i} = {s:g} is outside [−û, û], û = {bound:g}.")
    if len(values) > 1 and not abs(values[1]) < abs(values[0]):
        raise UsageError(
            f"Memory sequence: s_1 = {values[0]:g} must be the extremum of largest modulus, "
            f"but s_2 = {values[1]:g} would wipe it out."
        )
    for i in range(2, len(values)):
        low, high = sorted(values[i - 2 : i])
        if not low < values[i] < high:
            raise UsageError(
                f"Memory sequence: s_{i + 1} = {values[i]:g} is not strictly between s_{i - 1} = "
                f"{values[i - 2]:g} and s_{i} = {values[i - 1]:g}. Leave out extrema that are wiped out."
            )
