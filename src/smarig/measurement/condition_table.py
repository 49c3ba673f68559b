"""Outputs by a condition of the run: monotone cubic between the values that were measured, linear beyond them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from smarig.core import Array, DataError, stored_number

SAME_SHARE = 0.02  # of the range of a condition: closer runs are of one value
LEAST_GAIN = 0.01  # of the largest: a smaller gain beyond the measured values would invert the loop


@dataclass(frozen=True)
class ConditionTable:
    """``gains`` and ``zeros`` (output units) at increasing ``values`` of a ``condition``."""

    condition: str
    values: tuple[float, ...]
    gains: tuple[float, ...]
    zeros: tuple[float, ...]

    @classmethod
    def of(cls, condition: str, values: Sequence[float], gains: Array, zeros: Array) -> "ConditionTable":
        """A table of runs in any order; runs at about one value are averaged."""
        group = condition_groups(values)
        at = [np.array(group) == k for k in range(max(group) + 1)]
        mean = [tuple(float(np.mean(np.asarray(x)[k])) for k in at) for x in (values, gains, zeros)]
        return cls(condition, *mean)

    def outputs(self, shapes: Array, value: float) -> Array:
        """Outputs (n,) at a value of the condition, for shapes (n,) of one hysteresis, or (values, n) of one each.

        They are interpolated between the outputs g·P + z at the values of the table.

        >>> table = ConditionTable("stress", (50.0, 100.0), (1.0, 2.0), (0.0, 1.0))
        >>> table.outputs(np.array([0.0, 2.0]), 75.0).tolist()
        [0.5, 3.5]
        """
        y = np.array(self.gains)[:, None] * shapes + np.array(self.zeros)[:, None]
        x = np.array(self.values)
        if x.size > 2 and x[0] <= value <= x[-1]:
            from scipy.interpolate import PchipInterpolator  # imported here: takes half a second

            return np.asarray(PchipInterpolator(x, y)(value))
        if x.size == 1:
            return y[0]
        k = int(np.clip(np.searchsorted(x, value) - 1, 0, x.size - 2))
        share = self._bounded(k, float((value - x[k]) / (x[k + 1] - x[k])))
        return (1 - share) * y[k] + share * y[k + 1]

    def outputs_along(self, shapes: Array, values: Array) -> Array:
        """Outputs (n,) with a value of the condition for each of n shapes; otherwise as ``outputs``.

        >>> table = ConditionTable("stress", (50.0, 100.0), (1.0, 2.0), (0.0, 1.0))
        >>> table.outputs_along(np.array([0.0, 2.0]), np.array([50.0, 75.0])).tolist()
        [0.0, 3.5]
        """
        if values.size == 0 or np.all(values == values[0]):
            return self.outputs(shapes, float(values[0])) if values.size else np.empty(0)
        y = np.array(self.gains)[:, None] * shapes + np.array(self.zeros)[:, None]
        x, each = np.array(self.values), np.arange(values.size)
        if x.size == 1:
            return y[0]
        k = np.clip(np.searchsorted(x, values) - 1, 0, x.size - 2)
        shares = (values - x[k]) / (x[k + 1] - x[k])
        share = np.array([self._bounded(int(i), float(s)) for i, s in zip(k, shares)])
        found = (1 - share) * y[k, each] + share * y[k + 1, each]
        inside = (values >= x[0]) & (values <= x[-1])
        if x.size > 2 and inside.any():
            from scipy.interpolate import PchipInterpolator  # imported here: takes half a second

            powers, distance = PchipInterpolator(x, y).c, values - x[k]
            cubic = sum(c[k, each] * distance**p for c, p in zip(powers, (3, 2, 1, 0)))
            found = np.where(inside, cubic, found)
        return found

    def _bounded(self, k: int, share: float) -> float:
        """The share at which the gain between values k and k + 1 does not fall below its least."""
        least, a, b = LEAST_GAIN * max(self.gains), self.gains[k], self.gains[k + 1]
        if a + share * (b - a) >= least or a == b:
            return share
        return (least - a) / (b - a)

    def to_json(self) -> dict[str, Any]:
        """Plain values, as stored in a model file."""
        return {
            "condition": self.condition,
            "values": list(self.values),
            "gains": list(self.gains),
            "zeros": list(self.zeros),
        }

    @classmethod
    def from_json(cls, stored: Mapping[str, Any]) -> "ConditionTable":
        """The table of a model file. Raises DataError for a damaged one."""
        try:
            columns = [
                tuple(stored_number(v, f"one of its {key}") for v in stored[key])
                for key in ("values", "gains", "zeros")
            ]
            table = cls(str(stored["condition"]), *columns)
        except (DataError, KeyError, TypeError, ValueError) as error:
            raise DataError(f"a condition table of the model is damaged: {error}") from None
        if not columns[0] or len({len(c) for c in columns}) != 1:
            raise DataError("a condition table of the model is damaged: its columns differ in length")
        if any(a >= b for a, b in pairwise(table.values)):
            raise DataError("a condition table of the model is damaged: its values do not increase")
        return table


def condition_groups(values: Sequence[float]) -> list[int]:
    """The group of each run: runs at about one value of a condition, in increasing order of it.

    >>> condition_groups([99.9, 50.0, 100.1])
    [1, 0, 1]
    """
    x = np.asarray(values, dtype=float)
    order = np.argsort(x, kind="stable")
    apart = np.diff(x[order]) > max(SAME_SHARE * float(np.ptp(x)), 1e-9)
    group = np.empty(x.size, dtype=np.int64)
    group[order] = np.concatenate([[0], np.cumsum(apart)])
    return group.tolist()
