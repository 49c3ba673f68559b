"""The measurement effects of a model as plain values in its file."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from smarig.core import DataError
from smarig.measurement.condition_table import ConditionTable
from smarig.measurement.learned_term import LearnedTerm
from smarig.measurement.measurement_effect import MeasurementEffect, measurement_effects


@dataclass(frozen=True, eq=False)
class MeasurementPart:
    """The measurement effects of a model: effects, amplitudes (k,) of their terms, gain and zero by a condition, and
    terms that were learned.
    """

    effects: tuple[MeasurementEffect, ...]
    amplitudes: tuple[float, ...] = ()
    table: ConditionTable | None = None
    learned: tuple[LearnedTerm, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Plain values, as stored in a model file."""
        stored: dict[str, Any] = {
            "effects": [e.to_json() for e in self.effects],
            "amplitudes": list(self.amplitudes),
        }
        stored |= {"table": self.table.to_json()} if self.table else {}
        return stored | ({"learned": [t.to_json() for t in self.learned]} if self.learned else {})

    @classmethod
    def from_json(cls, stored: Mapping[str, Any]) -> "MeasurementPart":
        """The measurement effects of a model file. Raises DataError for damaged ones."""
        try:
            amplitudes = tuple(float(v) for v in stored.get("amplitudes", ()))
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
        return cls(effects, amplitudes, table, learned)
