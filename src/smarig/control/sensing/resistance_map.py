"""The resistance of a wire as a function of position, temperature and phase, with the errors of a position from it.

    R = c_1 + c_y y + c_T T + c_yT y T                                     one wire: its phase is its position
    R = c_1 + c_y y + c_T T + c_xi ξ + c_xiy ξ y + c_m (1 − ξ)(y − y_c)     two wires

ξ is the own phase of the heated wire by the model (thesis §5.5.1), y_c the position when it was last cold: what it has
moved since is strain that it recovered, so austenite, where the model's phase does not say so already. It is the first
order of R = [ρ_A ξ + ρ_M (1 − ξ)] (1 + a (T − T₀)) (1 + ε)² L/A. Position and resistance share the phase, so this map
has little hysteresis, unlike that from temperature to position. T (kelvin above ambient) and ξ are those of the model,
y is the position on the model's scale.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array, DataError

_LARGEST = 1e9  # of any number in a file, in its unit
ONE_WIRE_TERMS = ("1", "y", "T", "yT")
TWO_WIRE_TERMS = ("1", "y", "T", "xi", "xiy", "m")
COLD_SHARE = 0.1  # of the largest input: a cooler wire is cold


class WireCondition(NamedTuple):
    """Kelvin above ambient and ξ of the wire that carries the current, and the position when it was last cold."""

    wire_K: float
    austenite: float
    cold_position: float


def map_terms(y: ArrayLike, states: ArrayLike, *, two_wire: bool) -> Array:
    """The terms (n, p) of the map at positions (n,) and states (n, 3), in the order of their names."""
    y, (T, xi, cold) = np.asarray(y, dtype=float), np.asarray(states, dtype=float).T
    own = [xi, xi * y, (1 - xi) * (y - cold)] if two_wire else [y * T]
    return np.stack([np.ones_like(y), y, T, *own], axis=-1)


@dataclass(frozen=True)
class ResistanceMap:
    """The map of one wire.

    ``coefficients`` and their 95 % ``intervals`` by term, in ohm and the units of the terms. ``error_ohm`` is the
    standard deviation of what the map misses, which does not average out, ``time_s`` its correlation time. ``n``
    readings.
    """

    coefficients: Mapping[str, float]
    intervals: Mapping[str, tuple[float, float]]
    error_ohm: float
    time_s: float
    n: int

    def ohm(self, y: float, state: WireCondition) -> float:
        """The resistance at a position and a state of the wire.

        >>> wire = ResistanceMap({"1": 5.0, "y": -0.04, "T": 0.0, "yT": 0.0}, {}, 0.001, 1.0, 100)
        >>> wire.ohm(10.0, WireCondition(50.0, 0.0, 0.0))
        4.6
        """
        c, (T, xi, cold) = self.coefficients, state
        at_zero = c["1"] + c["T"] * T + c.get("xi", 0.0) * xi - c.get("m", 0.0) * (1 - xi) * cold
        return at_zero + self.per_position(state) * y

    def per_position(self, state: WireCondition) -> float:
        """∂R/∂y at fixed temperature and phase."""
        c, (T, xi, _) = self.coefficients, state
        return c["y"] + c.get("yT", 0.0) * T + c.get("xiy", 0.0) * xi + c.get("m", 0.0) * (1 - xi)


@dataclass(frozen=True)
class SelfSensing:
    """What an observer needs beside the hysteresis: a map for each wire, and the errors of reading and prediction.

    ``noise_V``: standard deviation of a reading in volts, so that a resistance has ``noise_V``/|i|. ``least_A``: a
    smaller current gives no reading. The prediction is wrong by an error of its input, ``input_error_K``, by
    ``output_error`` in the unit of position, with the correlation time ``output_time_s``, and by a share ``lag_error``
    of its own lag. ``interval_factor`` widens
    the intervals, so that they contain 95 % of the positions of each run of the identification; ``reading_factor`` does
    so for the intervals of single readings. ``stroke`` is that of the model.
    """

    wires: tuple[ResistanceMap, ...]
    noise_V: float
    least_A: float
    input_error_K: float
    output_error: float
    output_time_s: float
    lag_error: float
    interval_factor: float
    reading_factor: float
    stroke: float

    def to_json(self) -> dict[str, Any]:
        """As the part ``self_sensing`` of a model file."""
        return asdict(self) | {"wires": [_map_json(wire) for wire in self.wires]}

    @classmethod
    def from_json(cls, table: Mapping[str, Any]) -> "SelfSensing":
        """Read the part of a model file. Raises DataError if it is none."""
        try:
            wires = tuple(_map_of(wire) for wire in table["wires"])
            numbers = {name: float(table[name]) for name in cls.__dataclass_fields__ if name != "wires"}
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            field = f": {error.args[0]!r} is missing" if isinstance(error, KeyError) else ""
            raise DataError(
                f"'self_sensing' is incomplete or wrong{field}. Identify it again with smarig sense."
            ) from None
        positive = [*numbers.values(), *(v for w in wires for v in (w.error_ohm, w.time_s))]
        if not all(0 < v <= _LARGEST for v in positive):
            raise DataError(f"'self_sensing' has a number that is not positive, or is above {_LARGEST:g}.")
        if len(wires) not in (1, 2):
            raise DataError(f"'self_sensing' has {len(wires)} wires; a rig has one or two.")
        terms = ONE_WIRE_TERMS if len(wires) == 1 else TWO_WIRE_TERMS
        for wire in wires:
            values = wire.coefficients
            if set(values) != set(terms) or not all(abs(v) <= _LARGEST for v in values.values()):
                raise DataError(f"'self_sensing' needs the finite coefficients {', '.join(terms)}.")
        return cls(wires=wires, **numbers)


def _map_json(wire: ResistanceMap) -> dict[str, Any]:
    intervals = {name: list(ends) for name, ends in wire.intervals.items()}
    return asdict(wire) | {"intervals": intervals}


def _map_of(table: Mapping[str, Any]) -> ResistanceMap:
    return ResistanceMap(
        {str(name): float(value) for name, value in table["coefficients"].items()},
        {str(name): (float(low), float(high)) for name, (low, high) in table["intervals"].items()},
        float(table["error_ohm"]),
        float(table["time_s"]),
        int(table["n"]),
    )
