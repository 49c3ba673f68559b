"""What a Preisach memory holds at each point of a record: the remembered extrema, and nothing else.

The bookkeeping is the operator's own (wiping-out, §3.3.1), run on a hysteresis without output. Knows no
curve, no model and no rig.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from smarig.model.preisach import Preisach, State

Array = NDArray[np.float64]
Start = Literal["negative", "positive", "anhysteretic"]
STARTS: tuple[Start, ...] = ("negative", "positive", "anhysteretic")
SAME_INPUT = 1e-6  # inputs closer than this part of the range are one input


@dataclass(frozen=True, slots=True)
class Memory:
    """A range [u₋, u₊] of relays without any output, for following the extrema alone."""

    lower: float
    upper: float
    y_lower: float = 0.0

    def everett(self, alpha: float, beta: float) -> float:  # noqa: ARG002
        """Zero: only the extrema matter here."""
        return 0.0

    def rise_from_diagonal(self, centre: float, u: float) -> float:  # noqa: ARG002
        """Zero."""
        return 0.0

    def fall_from_diagonal(self, centre: float, u: float) -> float:  # noqa: ARG002
        """Zero."""
        return 0.0


def known_start(meta: dict) -> Start | None:
    """The state a run says it began in, None when it does not say."""
    said = meta.get("initial")
    return said if said in STARTS else None


def follow(inputs: Iterable[float], lower: float, upper: float, start: Start | None) -> list[State | None]:
    """The memory after each input, None while it is unknown.

    An unknown start becomes known at the first input that saturates: at ``lower`` or ``upper``.
    """
    operator = Preisach(Memory(lower, upper), start or "anhysteretic")
    known = start is not None
    states: list[State | None] = []
    for u in inputs:
        operator.step(float(u))
        known = known or not lower < u < upper
        states.append(operator.state if known else None)
    return states


def merged_inputs(inputs: Array) -> Array:
    """Inputs that differ by rounding only (``SAME_INPUT`` of the range) made equal.

    >>> merged_inputs(np.array([0.0, 100.0, 1e-9, 50.0])).tolist()
    [0.0, 100.0, 0.0, 50.0]
    """
    if inputs.size == 0:
        return inputs
    values, where = np.unique(inputs, return_inverse=True)
    first = np.concatenate([[True], np.diff(values) > SAME_INPUT * (values[-1] - values[0])])
    return values[first][np.cumsum(first) - 1][where]
