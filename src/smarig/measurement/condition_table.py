"""Gain and zero of the output by a condition of the run, linear between the runs that were measured."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import DataError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ConditionTable:
    """``gains`` and ``zeros`` (output units) at increasing ``values`` of a ``condition``."""

    condition: str
    values: tuple[float, ...]
    gains: tuple[float, ...]
    zeros: tuple[float, ...]

    @classmethod
    def of(cls, condition: str, values: Sequence[float], gains: Array, zeros: Array) -> "ConditionTable":
        """A table of runs in any order; runs at one value are averaged."""
        levels = np.unique(np.round(values, 9))
        at = [np.isclose(values, level, rtol=0, atol=1e-9) for level in levels]
        return cls(
            condition,
            tuple(levels.tolist()),
            tuple(float(np.mean(gains[k])) for k in at),
            tuple(float(np.mean(zeros[k])) for k in at),
        )

    def at(self, value: float) -> tuple[float, float]:
        """(gain, zero) at a value, continued linearly beyond the ends; the gain is at least a hundredth of the largest.

        >>> ConditionTable("stress", (50.0, 100.0), (1.0, 2.0), (0.0, 1.0)).at(75.0)
        (1.5, 0.5)
        """
        gain, zero = (_linear(self.values, y, value) for y in (self.gains, self.zeros))
        return max(gain, 0.01 * max(self.gains)), zero

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
            columns = [tuple(float(v) for v in stored[key]) for key in ("values", "gains", "zeros")]
            table = cls(str(stored["condition"]), *columns)
        except (KeyError, TypeError, ValueError) as error:
            raise DataError(f"a condition table of the model is damaged: {error}") from None
        if not columns[0] or len({len(c) for c in columns}) != 1:
            raise DataError("a condition table of the model is damaged: its columns differ in length")
        return table


def _linear(x: Sequence[float], y: Sequence[float], at: float) -> float:
    if len(x) == 1:
        return y[0]
    k = int(np.clip(np.searchsorted(x, at) - 1, 0, len(x) - 2))
    share = (at - x[k]) / (x[k + 1] - x[k])
    return float((1 - share) * y[k] + share * y[k + 1])
