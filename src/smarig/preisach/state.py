"""The memory of a Preisach operator as a value, from which a later run can continue.

The boundary B of the Preisach plane is a staircase whose corners are the remembered extrema (thesis §3.1, §6.1). The
range of a hysteresis is needed to check whether a state fits it.
"""

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from smarig.core import DataError


@dataclass(frozen=True, slots=True)
class State:
    """The memory: remembered extrema (oldest first) with the output at each, and the present point.

    ``extrema[0]`` is the base: u₋ for a history from negative saturation, or the centre ℓ of the diagonal
    boundary B_ℓ = {α = 2ℓ − β} (then ``diagonal`` is true; ℓ = 0 is the anhysteretic state B*).

    >>> State((0.0, 80.0), (0.0, 5.0), 40.0, 4.5).to_json()
    '{"extrema": [0.0, 80.0], "outputs": [0.0, 5.0], "u": 40.0, "y": 4.5, "diagonal": false}'
    """

    extrema: tuple[float, ...]
    outputs: tuple[float, ...]
    u: float
    y: float
    diagonal: bool = False

    def to_json(self) -> str:
        """One JSON object. ``from_json`` restores the same state bit for bit."""
        return json.dumps(asdict(self), allow_nan=False)

    @classmethod
    def from_json(cls, text: str) -> "State":
        """The state in a JSON object. DataError if it is not a state, is not finite or is not nested."""
        try:
            data = json.loads(text)
        except (TypeError, ValueError, RecursionError) as error:  # not text, not JSON, or nested too deeply
            raise DataError(f"This is not a Preisach state: {error}.") from None
        if not isinstance(data, dict):
            raise DataError("This is not a Preisach state: expected a JSON object.")
        try:
            state = cls(
                _numbers(data["extrema"], "extrema"),
                _numbers(data["outputs"], "outputs"),
                *_numbers([data["u"], data["y"]], "u, y"),
                diagonal=data["diagonal"],
            )
        except KeyError as error:
            raise DataError(f"This is not a Preisach state: {error} is missing.") from None
        if not isinstance(state.diagonal, bool):
            raise DataError("This is not a Preisach state: 'diagonal' must be true or false.")
        state.check()
        return state

    def reduced(self) -> "State":
        """The same memory as plain floats. The present point is not stored as an extremum."""
        keep = len(self.extrema) - (len(self.extrema) > 1 and self.extrema[-1] == self.u)
        extrema, outputs = (tuple(map(float, x[:keep])) for x in (self.extrema, self.outputs))
        return State(extrema, outputs, float(self.u), float(self.y), self.diagonal)

    def check(self) -> None:
        """Raise DataError unless all values are finite and each extremum lies between the two before it."""
        if not self.extrema or len(self.extrema) != len(self.outputs):
            raise DataError(
                f"A Preisach state needs at least one extremum and one output for each; "
                f"got {len(self.outputs)} for {len(self.extrema)}."
            )
        if not all(map(math.isfinite, (*self.extrema, *self.outputs, self.u, self.y))):
            raise DataError("A Preisach state contains a number that is not finite.")
        path = [*self.extrema, self.u] if self.u != self.extrema[-1] else [*self.extrema]
        for k, (low, high) in enumerate(self._ranges(path), start=1):
            if not low < path[k] < high:
                raise DataError(
                    f"A Preisach state's extrema must alternate and be nested: {path[k]:g} does not lie "
                    f"between {low:g} and {high:g}."
                )

    def _ranges(self, path: list[float]) -> Iterator[tuple[float, float]]:
        """Limits for each point after the base: its direction, and the remembered extrema."""
        low, high, up = path[0], math.inf, True
        if self.diagonal:
            up = len(path) > 1 and path[1] > path[0]
            low, high = (path[0], math.inf) if up else (-math.inf, path[0])
        for k, here in enumerate(path[1:]):
            yield low, high
            low, high, up = (low, here, False) if up else (here, high, True)
            if self.diagonal and k == 0:  # from B_ℓ the memory ends at the mirror image
                low, high = (2 * path[0] - here, here) if here > path[0] else (here, 2 * path[0] - here)


def _numbers(values: Any, where: str) -> tuple[float, ...]:
    if not isinstance(values, Sequence) or isinstance(values, str):
        raise DataError(f"This is not a Preisach state: {where} must be numbers.")
    if not all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in values):
        raise DataError(f"This is not a Preisach state: {where} must be numbers.")
    try:
        return tuple(float(v) for v in values)
    except OverflowError:
        raise DataError(
            f"This is not a Preisach state: {where} contains a number too large for an input."
        ) from None
