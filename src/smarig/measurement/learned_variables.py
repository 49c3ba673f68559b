"""The variables that a learned term may depend on, at every row of a record.

None needs the record beyond itself, so that a law learned from some runs can be evaluated on any other.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from smarig.core import Array, DataError
from smarig.measurement.input_record import InputRecord, reversals

LEVEL = "level"  # the output of the hysteresis: no property of the record
NEED_CLOCK = ("rate", "time", "time_since_reversal")
VARIABLES = ("rate", "time", "cycle", "history", "time_since_reversal", LEVEL, "input")
SLOWEST_RATE_SHARE = 1e-6  # of the largest rate: a slower branch counts as this fast


@lru_cache(maxsize=64)
def learned_variables(record: InputRecord) -> Mapping[str, Array]:
    """Values (n,) by variable, and by name of each condition of the run.

    ``rate`` is log₁₀ of the mean |du/dt| of the branch, ``time`` and ``cycle`` count from the start of the run,
    ``history`` is the input at the last reversal. Those that need a clock are left out without one.
    """
    turns = np.array(reversals(record.u))
    branch = np.clip(np.searchsorted(turns, np.arange(len(record)), side="left") - 1, 0, turns.size - 2)
    found = {
        "input": record.u,
        "cycle": record.cycle - record.cycle[0],
        "history": record.u[turns[branch]],
        **{name: np.full(len(record), value) for name, value in record.conditions.items()},
    }
    if record.clock:
        rate = np.abs(np.diff(record.u[turns])) / np.maximum(np.diff(record.t[turns]), 1e-12)
        slowest = max(SLOWEST_RATE_SHARE * float(rate.max()), 1e-300)
        found["rate"] = np.log10(np.maximum(rate, slowest))[branch]
        found["time"] = record.elapsed
        found["time_since_reversal"] = record.t - record.t[turns[branch]]
    return MappingProxyType(found)


@lru_cache(maxsize=64)
def branch_directions(record: InputRecord) -> Array:
    """1 on rising and −1 on falling branches, (n,); a reversal belongs to the branch that ends there."""
    turns = np.array(reversals(record.u))
    branch = np.clip(np.searchsorted(turns, np.arange(len(record)), side="left") - 1, 0, turns.size - 2)
    return np.sign(np.diff(record.u[turns]))[branch]


def variable_of(record: InputRecord, name: str) -> Array:
    """A variable (n,) of a record. Raises DataError if the record does not have it."""
    values = learned_variables(record).get(name)
    if values is None:
        missing = "a clock" if name in NEED_CLOCK else f"the condition '{name}'"
        raise DataError(
            f"The model has a learned term that depends on the {name.replace('_', ' ')}, but run {record.name} does "
            f"not state {missing}. Import it with a mapping that does."
        )
    return values


def shared_variables(records: Sequence[InputRecord]) -> list[str]:
    """Names of the variables that all records have."""
    names = set.intersection(*(set(learned_variables(r)) for r in records))
    return sorted(names, key=lambda n: (VARIABLES.index(n) if n in VARIABLES else len(VARIABLES), n))


def variable_unit(name: str, input_unit: str) -> str:
    """Unit of a variable; that of ``rate`` belongs to the number whose logarithm it is."""
    units = {
        "rate": f"{input_unit or '1'}/s",
        "time": "s",
        "time_since_reversal": "s",
        "cycle": "1",
        "history": input_unit,
        "input": input_unit,
    }
    return units.get(name, "")
