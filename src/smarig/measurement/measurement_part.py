"""The measurement effects of a model as plain values in its file."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from smarig.core import DataError, stored_number
from smarig.measurement.condition_table import ConditionTable
from smarig.measurement.learned_term import LearnedTerm
from smarig.measurement.measurement_effect import MeasurementEffect, measurement_effects
from smarig.preisach import FodTable, dump_hysteresis, load_hysteresis


@dataclass(frozen=True, eq=False)
class MeasurementPart:
    """The measurement effects of a model: effects, amplitudes (k,) of their terms, gain and zero by a condition, and
    terms that were learned.

    ``measures`` are one hysteresis for each value of the table, each to be multiplied by its gain; empty if all values
    share that of the model.
    """

    effects: tuple[MeasurementEffect, ...]
    amplitudes: tuple[float, ...] = ()
    table: ConditionTable | None = None
    measures: tuple[FodTable, ...] = ()
    learned: tuple[LearnedTerm, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Plain values, as stored in a model file."""
        stored: dict[str, Any] = {
            "effects": [e.to_json() for e in self.effects],
            "amplitudes": list(self.amplitudes),
        }
        if self.table:
            stored["table"] = self.table.to_json()
        if self.measures:
            stored["measures"] = [dump_hysteresis(m) for m in self.measures]
        if self.learned:
            stored["learned"] = [t.to_json() for t in self.learned]
        return stored

    @classmethod
    def from_json(cls, stored: Mapping[str, Any]) -> "MeasurementPart":
        """The measurement effects of a model file. Raises DataError for damaged ones."""
        try:
            amplitudes = tuple(stored_number(v, "an amplitude") for v in stored.get("amplitudes", ()))
            effects = measurement_effects(stored["effects"])
            learned = tuple(LearnedTerm.from_json(entry) for entry in stored.get("learned", ()))
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise DataError(f"the measurement effects of the model are damaged: {error}") from None
        terms = sum(len(e.kind.amplitudes("", "")) for e in effects)
        if terms != len(amplitudes):
            raise DataError(
                f"the measurement effects of the model need {terms} amplitudes, not {len(amplitudes)}"
            )
        table = ConditionTable.from_json(stored["table"]) if "table" in stored else None
        return cls(effects, amplitudes, table, _measures(stored, table), learned)


def _measures(stored: Mapping[str, Any], table: ConditionTable | None) -> tuple[FodTable, ...]:
    found = [load_hysteresis(m) for m in stored.get("measures", ())]
    tables = tuple(m for m in found if isinstance(m, FodTable))
    if len(tables) != len(found) or (found and (table is None or len(found) != len(table.values))):
        raise DataError(
            "the measurement effects of the model need one table for each value of their condition"
        )
    return tables
