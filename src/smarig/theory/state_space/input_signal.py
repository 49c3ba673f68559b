"""Inputs u ∈ 𝒰 (§6.2.1): continuous, bounded by û, and 0 before their first time. Piecewise linear in time.

Only the extrema and their order matter to a Preisach operator, so straight lines between knots are sufficient.
"""

import math
from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from itertools import pairwise

from smarig.core import UsageError


@dataclass(frozen=True)
class InputSignal:
    """u(t) as straight lines between knots (``times``, ``values``), both (n,); constant before the first knot.

    An input of 𝒰(−∞, T] starts with the value 0. One that starts elsewhere is a part u_[t₀,T], to be joined to a past
    with ``joined_with``. The input is not defined after the last knot. UsageError if times do not increase or values
    are not finite.

    >>> u = InputSignal((0, 1, 3), (0, 4, -2))
    >>> u(-7), u(0.5), u.until(2), u.shifted(1).times
    (0.0, 2.0, InputSignal(times=(0.0, 1.0, 2.0), values=(0.0, 4.0, 1.0)), (-1.0, 0.0, 2.0))
    """

    times: tuple[float, ...]
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        times, values = tuple(map(float, self.times)), tuple(map(float, self.values))
        if not times or len(times) != len(values):
            raise UsageError(
                f"An input has one value per time; got {len(times)} times, {len(values)} values."
            )
        if not all(map(math.isfinite, times + values)):
            raise UsageError("An input has a time or a value that is not finite.")
        if any(later <= earlier for earlier, later in pairwise(times)):
            raise UsageError("The times of an input must increase strictly.")
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)

    @property
    def end(self) -> float:
        """The last time at which the input is defined."""
        return self.times[-1]

    def __call__(self, t: float) -> float:
        """u(t), t ≤ end."""
        if t > self.end:
            raise UsageError(f"The input is defined until t = {self.end:g}, but t = {t:g} was requested.")
        k = bisect_left(self.times, t)
        if k == 0 or self.times[k] == t:
            return self.values[k]
        (t0, t1), (u0, u1) = self.times[k - 1 : k + 1], self.values[k - 1 : k + 1]
        u = u0 + (t - t0) / (t1 - t0) * (u1 - u0)
        return min(max(u, min(u0, u1)), max(u0, u1))  # rounding must not create an extremum

    def until(self, t: float) -> "InputSignal":
        """u_(−∞,t]."""
        k = bisect_left(self.times, t)
        return InputSignal((*self.times[:k], t), (*self.values[:k], self(t)))

    def between(self, t0: float, t1: float) -> "InputSignal":
        """u_[t₀,t₁]."""
        past = self.until(t1)
        k = bisect_right(past.times, t0)
        return InputSignal((t0, *past.times[k:]), (past(t0), *past.values[k:]))

    def shifted(self, T: float) -> "InputSignal":
        """σ_T u(t) = u(t + T) (Def. 6.1)."""
        return InputSignal(tuple(t - T for t in self.times), self.values)

    def joined_with(self, after: "InputSignal", slack: float = 0.0) -> "InputSignal":
        """u ◇ v (§6.3): this input until ``after`` starts, which must be at the time and value at which this one ends.

        A jump larger than ``slack`` is an error, because the operator is defined for continuous inputs (Def. 6.5).
        """
        if after.times[0] != self.end:
            raise UsageError(
                f"Inputs cannot be joined: the first ends at t = {self.end:g}, but the second starts at "
                f"t = {after.times[0]:g}."
            )
        if not abs(after.values[0] - self.values[-1]) <= slack:
            raise UsageError(
                f"The input is not admissible: it starts at u = {after.values[0]:g}, but the past ends at "
                f"u = {self.values[-1]:g}. A Preisach operator needs continuous inputs."
            )
        return InputSignal(self.times + after.times[1:], self.values + after.values[1:])
