"""Measurement effects: changes of a record's input, and terms added to its output.

    y = z + g · P[v] + Σ_k b_k φ_k,        v = v(u, t, conditions)

P is the hysteresis, z the zero of the run's output. An effect gives v, g or the terms φ. Amplitudes b of terms, and
gains g, follow from least squares; only the other parameters are searched for.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from smarig.core import Array, DataError, catalogue_entry, catalogue_names, stored_number
from smarig.measurement.input_record import InputRecord

Values = Mapping[str, float]
EFFECTS = "smarig.measurement.effects"
FORMER_NAMES = {"ratchet_strain": "ratcheting"}  # in model files of earlier versions


@dataclass(frozen=True, eq=False)
class RecordChange:
    """What an effect does to a record: the input (n,) of the hysteresis, and terms (n, k) of the output.

    ``noise`` is the standard deviation of the changed input's noise; None if it is that of the input itself.
    """

    input: Array
    terms: Array
    noise: float | None = None

    @classmethod
    def none(cls, record: InputRecord) -> "RecordChange":
        """The record as it is."""
        return cls(record.u, np.empty((len(record), 0)))


@dataclass(frozen=True)
class SearchedParameter:
    """A parameter that is searched for: unit, and values to start from.

    The search ends at the smallest and largest start; an estimate there determines nothing. ``open_above``: the
    largest start stands for all larger values. ``sudden``: the output changes suddenly with it, so that a value
    between two is like neither.
    """

    name: str
    unit: str
    tries: tuple[float, ...]
    open_above: bool = False
    sudden: bool = False


@dataclass(frozen=True)
class MeasurementEffectType:
    """A measurement effect of the catalogue.

    ``parameters`` gives those searched for in records, None if the effect cannot be tested on them. ``change`` returns
    the changed input and the terms. ``amplitudes`` names the amplitude of each term with its unit, given the units of
    input and output. ``bounds`` are those of parameters with a range of their own, of which a model file must give one.
    ``by_condition``: each run has a gain and a zero of its own, which depend on this condition.
    ``depends_on`` are the variables that the residuals of a model without the effect depend on. ``descriptive``: the
    effect describes an error without naming its cause, so alone it is no finding but a dependence. ``additive``: the
    effect leaves the input as it is and only adds terms.
    """

    name: str
    summary: str
    looks_like: str
    confused_with: tuple[str, ...]
    separated_by: str
    depends_on: tuple[str, ...]
    parameters: Callable[[Sequence[InputRecord]], tuple[SearchedParameter, ...] | None] = field(repr=False)
    change: Callable[[Values, InputRecord], RecordChange] = field(repr=False)
    amplitudes: Callable[[str, str], tuple[tuple[str, str], ...]] = field(
        default=lambda _input_unit, _output_unit: (), repr=False
    )
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    by_condition: str = ""
    descriptive: bool = False
    additive: bool = False

    def __call__(self, **values: float) -> "MeasurementEffect":
        """The effect with these values."""
        return MeasurementEffect(self, dict(values))


@dataclass(frozen=True)
class MeasurementEffect:
    """A measurement effect with its values by parameter."""

    kind: MeasurementEffectType
    values: dict[str, float]

    def to_json(self) -> dict[str, Any]:
        """{"name", "parameters"}, as stored in model files."""
        return {"name": self.kind.name, "parameters": dict(self.values)}


def measurement_effect_types() -> tuple[MeasurementEffectType, ...]:
    """All measurement effects, by name."""
    return tuple(catalogue_entry(EFFECTS, name) for name in catalogue_names(EFFECTS))


def measurement_effects(stored: Sequence[Mapping[str, Any]]) -> tuple[MeasurementEffect, ...]:
    """The effects of a model file. Raises DataError for damaged ones."""
    found = []
    for entry in stored:
        values = entry.get("parameters")
        if not isinstance(values, Mapping):
            raise DataError("a measurement effect of the model has no table of parameters")
        name = str(entry.get("name"))
        kind = catalogue_entry(EFFECTS, FORMER_NAMES.get(name, name))
        numbers = {str(k): stored_number(v, f"{k!s:.40} of effect '{kind.name}'") for k, v in values.items()}
        given = [name for name in kind.bounds if name in numbers] or list(kind.bounds)
        for parameter in given:
            lower, upper = kind.bounds[parameter]
            if not lower <= numbers.get(parameter, -np.inf) <= upper:
                raise DataError(
                    f"effect '{kind.name}' of the model needs {parameter} between {lower:g} and {upper:g}, not "
                    f"{numbers.get(parameter)}"
                )
        found.append(MeasurementEffect(kind, numbers))
    return tuple(found)


def changed(record: InputRecord, effects: Sequence[MeasurementEffect]) -> RecordChange:
    """The changes of several effects: inputs one after the other, terms side by side."""
    u, noise, terms = record.u, record.noise, [np.empty((len(record), 0))]
    for effect in effects:
        step = effect.kind.change(effect.values, record if u is record.u else replace(record, u=u))
        u, noise = step.input, noise if step.noise is None else step.noise
        terms.append(step.terms)
    return RecordChange(u, np.hstack(terms), noise)
