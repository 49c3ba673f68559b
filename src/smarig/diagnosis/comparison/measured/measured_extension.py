"""The given model extended by the effects of a verdict, or by a law; offered if it predicts what it has not seen."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.diagnosis.comparison.measured.learned_fit import LearnedFit
from smarig.diagnosis.comparison.measured.learned_law import LearnedLaw
from smarig.diagnosis.comparison.measured.learned_search import learned_of
from smarig.diagnosis.comparison.measured.measured_runs import replayed_error
from smarig.diagnosis.comparison.verdict_rules import RULES
from smarig.identification import (
    OWN_ADVANTAGE,
    PROPORTIONAL,
    Comparison,
    LoadDependence,
    MeasuredFit,
    MeasuredHypothesis,
    condition_table,
    fit_load_dependence,
    output_sign,
)
from smarig.measurement import (
    InputRecord,
    MeasurementEffect,
    MeasurementPart,
    measurement_effect_types,
    reversals,
)
from smarig.preisach import FodTable
from smarig.record import Run
from smarig.replay import Model, provenance

PART = 0.1  # of the range of the input: long enough for a slope, and short within the transformation
FEWEST_OF_LINE = 6
PROPORTIONAL_WARNING = "A part of the output is proportional to the input; measure identified jointly."


@dataclass(frozen=True, eq=False)
class PlainModel:
    """The given ``model``, the plain one fitted again (``base``), and the readings of ``train`` and ``held_out`` runs.

    ``error_to_beat``: rms error on held-out readings that an extended model must not exceed.
    """

    model: Model
    base: MeasuredHypothesis
    comparison: Comparison
    train: tuple[Run, ...]
    held_out: tuple[Run, ...]
    error_to_beat: float
    _laws: dict[str, LearnedFit | None] = field(default_factory=dict, repr=False)

    def law_of(self, variable: str) -> LearnedFit | None:
        """The law of a variable that predicts blocks left out best, computed once; None if there is none."""
        if variable not in self._laws:
            self._laws[variable] = learned_of(self.comparison, self.base, variable)
        return self._laws[variable]

    @property
    def records(self) -> tuple[InputRecord, ...]:
        """The training records."""
        plan = self.comparison.plan
        return plan.records[: int(plan.record[self.comparison.train].max()) + 1]


@dataclass(frozen=True, eq=False)
class MeasuredExtension:
    """A model with effects or a ``law``: its fit, and its errors (m,) at all readings.

    ``load`` is the model of all loads, if an effect of the load alone was named.
    """

    model: Model
    hypothesis: MeasuredHypothesis
    error: Array
    law: LearnedLaw | None = None
    load: LoadDependence | None = None


def extension_by_effects(
    plain: PlainModel, effects: Sequence[MeasurementEffect], word: str
) -> MeasuredExtension | None:
    """The model with effects; None if it predicts left-out blocks or held-out runs worse than the plain one."""
    return _if_better(plain, _with_effects(plain, effects, word))


def ratio_by_effects(plain: PlainModel, effects: Sequence[MeasurementEffect]) -> float | None:
    """The error on held-out readings of the model with effects over that of the plain one; None without any."""
    tested = ~plain.comparison.train
    before = root_mean_square(held_out_error(plain.base, len(plain.records))[tested]) if tested.any() else 0.0
    return root_mean_square(_with_effects(plain, effects, "named").error[tested]) / before if before else None


def _with_effects(plain: PlainModel, effects: Sequence[MeasurementEffect], word: str) -> MeasuredExtension:
    found = plain.comparison.evaluated(effects, near=plain.base.fit)
    warning = f"Effects by diagnosis ({word}); measure identified jointly."
    condition = effects[0].kind.by_condition if len(effects) == 1 else ""
    if condition:
        load = fit_load_dependence(plain.records, condition)
        model = extended_model(plain, load.hysteresis, load.part, found.name, warning)
        error = replayed_error(model, [*plain.train, *plain.held_out], plain.comparison, about_mean=False)
        return MeasuredExtension(model, found, error, load=load)
    table = condition_table(found, len(plain.records))
    part = MeasurementPart(tuple(effects), tuple(found.fit.amplitudes.tolist()), table)
    hysteresis = found.fit.table if table else hysteresis_of_first_run(found.fit)
    model = extended_model(plain, hysteresis, part, found.name, warning)
    return MeasuredExtension(model, found, held_out_error(found, len(plain.records)))


def extension_by_law(plain: PlainModel, variable: str) -> MeasuredExtension | None:
    """The model with the law of a variable; None if it predicts left-out blocks or held-out runs worse."""
    found = plain.law_of(variable)
    if found is None:
        return None
    run, hypothesis = plain.train[0], found.hypothesis
    law = LearnedLaw(found.terms, 1 - hypothesis.rms / plain.base.rms, run.input_unit, run.unit)
    part = MeasurementPart((), learned=found.terms)
    warning = "Term learned from the errors of a plain model; its cause is unknown."
    model = extended_model(plain, hysteresis_of_first_run(hypothesis.fit), part, "learned", warning)
    replayed = replayed_error(model, [*plain.train, *plain.held_out], plain.comparison)
    error = np.where(np.isfinite(replayed), replayed, hypothesis.fit.error)
    return _if_better(plain, MeasuredExtension(model, hypothesis, error, law=law), tolerance=1.0)


def with_proportional_part(plain: PlainModel) -> MeasuredExtension | None:
    """The model with a part of the output proportional to the input; None unless left-out blocks call for it.

    It is no cause that a diagnosis tests for, as its own plain model contains a reversible part of any sign. A measure
    that is nowhere negative contains one with the sign of the transformation, so only a part against it is determined,
    and of that only the least: a steeper one is balanced by more of the measure.
    """
    against = -output_sign(plain.records)
    slope = against * max((_steepest(r, against) for r in plain.records), default=0.0)
    if slope * against <= 0:
        return None
    found = _without_part(plain, slope)
    if found.misfit > OWN_ADVANTAGE * plain.base.misfit:
        return None
    kinds = {k.name: k for k in measurement_effect_types()}
    part = MeasurementPart((kinds[PROPORTIONAL](),), (slope,))
    model = extended_model(
        plain, hysteresis_of_first_run(found.fit), part, PROPORTIONAL, PROPORTIONAL_WARNING
    )
    return _if_better(plain, MeasuredExtension(model, found, held_out_error(found, len(plain.records))))


def _steepest(record: InputRecord, sign: float) -> float:
    """The steepest slope with a sign of the output along the branches of a record, less twice its standard error.

    Of lines through parts of the branches, each a tenth of the range of the input.
    """
    found = [0.0]
    turns = reversals(record.u)
    for a, b in pairwise(turns):
        u, y = record.u[a : b + 1], record.y[a : b + 1]
        parts = np.linspace(u[0], u[-1], int(abs(u[-1] - u[0]) / (PART * np.ptp(record.u))) + 1)
        for low, high in pairwise(np.sort(parts)):
            own = (u >= low) & (u <= high)
            if own.sum() >= FEWEST_OF_LINE and np.var(u[own]) > 0:
                slope, error = _line(u[own], y[own])
                found.append(sign * slope - 2.0 * error)
    return max(found)


def _line(u: Array, y: Array) -> tuple[float, float]:
    """The slope of a line through readings (n,), with its standard error."""
    x = u - u.mean()
    square = float(x @ x)
    slope = float(x @ y) / square
    rest = y - y.mean() - slope * x
    return slope, float(np.sqrt(rest @ rest / (y.size - 2) / square))


def _without_part(plain: PlainModel, slope: float) -> MeasuredHypothesis:
    """The plain model of the outputs without ``slope`` times their input."""
    plan = plain.comparison.plan
    records = tuple(replace(r, y=r.y - slope * r.u) for r in plan.records)
    return replace(plain.comparison, plan=replace(plan, records=records)).evaluated(())


def _if_better(
    plain: PlainModel, extension: MeasuredExtension, tolerance: float = RULES["worse"].value
) -> MeasuredExtension | None:
    """An extension unless it predicts worse; a law has no cause that speaks for it, so it must predict better."""
    tested = ~plain.comparison.train
    if extension.hypothesis.rms >= plain.base.rms:
        return None
    if tested.any() and root_mean_square(extension.error[tested]) > tolerance * plain.error_to_beat:
        return None
    return extension


def held_out_error(found: MeasuredHypothesis, train: int) -> Array:
    """Errors (m,) at all readings; those of held-out records have the zero and gain of their condition, or are about
    their mean if nothing determines the zero.
    """
    fit, plan = found.fit, found.fit.problem.plan
    error = fit.error
    table = condition_table(found, train)
    for k, record in enumerate(plan.records[train:], start=train):
        own = plan.record == k
        if not own.any():
            continue
        if table is None:
            error = np.where(own, error - error[own].mean(), error)
        else:
            value = record.conditions.get(table.condition, table.values[0])
            terms = (fit.problem.terms @ fit.amplitudes)[own]
            error[own] = plan.y[own] - table.outputs(fit.shape[own], value) - terms
    return error


def hysteresis_of_first_run(fit: MeasuredFit) -> FodTable:
    """The hysteresis of a fit with the zero of its first run."""
    return replace(fit.table, values=fit.table.values + float(fit.zeros[0]))


def extended_model(
    plain: PlainModel, hysteresis: FodTable, part: MeasurementPart, name: str, warning: str
) -> Model:
    """The model ``name`` added to the given one, with another hysteresis."""
    model = plain.model
    return replace(
        model,
        name=f"{model.name} + {name}",
        hysteresis=hysteresis,
        mirrored=False,
        effects=(),
        measurement=part.to_json(),
        parameters=(),
        covariance=np.empty((0, 0)),
        intervals={},
        provenance=tuple(provenance(run) for run in plain.train),
        warnings=(*model.warnings, warning),
    )
