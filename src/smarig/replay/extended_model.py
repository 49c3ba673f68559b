"""The extension of a model (thesis §3.5) as plain values in its file, and the operator that it defines.

A new kind is one line of ``_OPERATORS``. ``hysteresis`` is the classical one of the model; the moving model has another
one, as a function of u + k y.
"""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import NOT_NUMBERS, Array, DataError
from smarig.preisach import Everett, Initial, load_hysteresis
from smarig.theory import (
    AccommodatingPreisach,
    MovingPreisach,
    NonlinearPreisach,
    RestrictedPreisach,
    ReversiblePart,
    ReversiblePreisach,
    SecondOrderExcess,
)


class Operator(Protocol):
    """The predicting operator, classical or extended. ``reset`` and ``step`` return the output."""

    def reset(self, initial: Initial = "negative") -> float: ...
    def step(self, u: float) -> float: ...
    def simulate(self, u: ArrayLike, initial: Initial = "negative") -> Array: ...


def extended_operator(extension: dict[str, Any], hysteresis: Everett, initial: Initial = "negative") -> Any:
    """The operator that ``extension`` = {"kind", values …} makes of a hysteresis. Raises DataError if invalid."""
    kind = extension.get("kind")
    if kind not in _OPERATORS:
        raise DataError(f"unknown extension '{kind}'; expected one of {', '.join(_OPERATORS)}")
    try:
        operator = _OPERATORS[kind](extension, hysteresis)
    except KeyError as error:
        raise DataError(f"extension key {error} is missing") from None
    except NOT_NUMBERS as error:
        raise DataError(f"the extension is damaged: {error}") from None
    operator.reset(initial)
    return operator


def _moving(x: dict[str, Any], _hysteresis: Everett) -> MovingPreisach:
    return MovingPreisach(load_hysteresis(x["hysteresis"]), _number(x["feedback"]))


def _excess(x: dict[str, Any]) -> SecondOrderExcess:
    return SecondOrderExcess(np.array(x["nodes"], dtype=float), np.array(x["values"], dtype=float))


def _number(value: Any) -> float:
    number = float(value)
    if not np.isfinite(number):
        raise ValueError(f"{number} is not finite")
    return number


_OPERATORS: dict[str, Callable[[dict[str, Any], Everett], Any]] = {
    "accommodating": lambda x, h: AccommodatingPreisach(h, _number(x["amount"]), _number(x["path"])),
    "moving": _moving,
    "nonlinear": lambda x, h: NonlinearPreisach(h, _excess(x)),
    "restricted": lambda x, h: RestrictedPreisach.first_order(h, _excess(x)),
    "reversible": lambda x, h: ReversiblePreisach(h, ReversiblePart(x["nodes"], x["values"])),
}
