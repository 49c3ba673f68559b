"""The diagnosis of a model on runs with a measured input: data of others, without current and without settled steps.

The comparison of hypotheses finds what is wrong; the extended model has its effects, or a law of its variable.
"""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from smarig.core import Array, NotebookDisplay, root_mean_square
from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.finding import Finding
from smarig.diagnosis.comparison.measured.learned_law import LearnedLaw
from smarig.diagnosis.comparison.measured.measured_comparison import (
    MeasuredComparison,
    RunOffset,
    compare_measured,
)
from smarig.diagnosis.comparison.measured.measured_extension import (
    MeasuredExtension,
    PlainModel,
    extended_model,
    extension_by_effects,
    extension_by_law,
    held_out_error,
    hysteresis_of_first_run,
    ratio_by_effects,
    with_proportional_part,
)
from smarig.diagnosis.comparison.measured.measured_json import measured_json
from smarig.diagnosis.comparison.measured.measured_runs import records_of, replayed_error, selected_rows
from smarig.diagnosis.comparison.measured.measured_text import measured_lines
from smarig.diagnosis.comparison.measured.preisach_properties import PropertyTest, preisach_properties
from smarig.diagnosis.comparison.probabilities import Probabilities, probabilities
from smarig.diagnosis.comparison.verdict_rules import Verdict
from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.identification import Comparison, MeasuredHypothesis, compared
from smarig.measurement import InputRecord, LearnedTerm, MeasurementPart, measurement_effect_types
from smarig.record import Run
from smarig.replay import Model, file_hash, foreign_conditions, pooled_conditions


@dataclass(frozen=True, eq=False)
class MeasuredDiagnosis(NotebookDisplay):
    """The verdict on a model and runs with a measured input, with its evidence.

    ``plain`` is the model without effects, fitted to the training runs; ``extension`` the model with the effects of the
    verdict or a law of its variable (None: none predicts better). ``given_error`` (m,) are the errors of the given
    model at the readings, NaN where it predicts nothing. ``gain`` on held-out runs is None without any.
    """

    evidence: MeasuredComparison
    plain: PlainModel
    extension: MeasuredExtension | None
    given_error: Array
    gain: HeldOutGain | None
    seconds: float

    @property
    def verdict(self) -> Verdict:
        """The verdict of the comparison."""
        return self.evidence.verdict

    @property
    def base(self) -> MeasuredHypothesis:
        """The plain model fitted to the training runs."""
        return self.plain.base

    @property
    def best(self) -> MeasuredHypothesis | None:
        """The fit of the extended model, or None if there is none."""
        return self.extension.hypothesis if self.extension else None

    @property
    def comparison(self) -> Comparison:
        """The readings that the plain and the extended model are fitted to."""
        return self.plain.comparison

    @property
    def noise(self) -> float:
        """Standard deviation of one reading, output units."""
        return self.evidence.noise

    @property
    def offsets(self) -> tuple[RunOffset, ...]:
        """Runs whose input disagrees with that of the first training run, held-out ones first."""
        return self.evidence.offsets

    @property
    def given(self) -> Model:
        """The model that was diagnosed."""
        return self.plain.model

    @property
    def model(self) -> Model:
        """The extended model, else the given one."""
        return self.extension.model if self.extension else self.given

    @property
    def runs(self) -> tuple[Run, ...]:
        """All runs, training first."""
        return (*self.plain.train, *self.plain.held_out)

    @property
    def measured_once(self) -> tuple[str, ...]:
        """The conditions through which a named effect acts, if no value of them was measured in two runs.

        What else changes from run to run, such as the zero of a thermometer, may then go with them by chance.
        """
        kinds = {k.name: k.by_condition for k in measurement_effect_types()}
        acting = dict.fromkeys(c for n in self.verdict.names if (c := kinds.get(n)))
        values = {c: [r.conditions[c] for r in self.records if c in r.conditions] for c in acting}
        return tuple(c for c, several in values.items() if len(set(several)) == len(several) > 1)

    @property
    def train(self) -> int:
        """Number of training records."""
        return len(self.plain.records)

    @property
    def extended(self) -> bool:
        """Whether ``model`` is an extended one."""
        return self.extension is not None

    @property
    def unit(self) -> str:
        """Unit of the output."""
        return self.runs[0].unit

    @property
    def records(self) -> tuple[InputRecord, ...]:
        """All records, training first."""
        return self.comparison.plan.records

    def lines(self) -> list[str]:
        """The findings, one or two sentences each; the verdict first."""
        return list(measured_lines(self))

    def text(self) -> str:
        """The findings as text."""
        return "\n".join(self.lines())

    @property
    def probabilities(self) -> Probabilities:
        """The probabilities that the verdict states."""
        return probabilities(self.verdict, self.evidence.weights)

    @property
    def causes(self) -> Mapping[Part, float]:
        """The probability of each cause, likeliest first."""
        return self.probabilities.causes

    def rms(self, found: MeasuredHypothesis | None = None) -> float:
        """Rms error at the training readings: of the plain model, or of a hypothesis."""
        return root_mean_square((found or self.base).fit.error[self.comparison.train])

    @property
    def given_rms(self) -> float | None:
        """Rms error of the given model at the training readings, or None if it predicts none of them."""
        error = self.given_error[self.comparison.train]
        return root_mean_square(error[np.isfinite(error)]) if np.isfinite(error).any() else None

    @cached_property
    def properties(self) -> tuple[PropertyTest, ...]:
        """The tests of return point and wiping-out on the training records."""
        return preisach_properties(self.records[: self.train], self.best.effects if self.best else ())

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """The effects of the verdict, with the values that the extended model has; none if it is unknown."""
        return tuple(self._findings()) if self.verdict.word in ("named", "ambiguous") else ()

    def effects(self) -> list[dict[str, Any]]:
        """The findings as plain values: name, probability, parameters with 95 % intervals."""
        return [f.to_json() for f in self.findings]

    @property
    def learned(self) -> LearnedLaw | None:
        """The law that the extended model has instead of effects."""
        return self.extension.law if self.extension else None

    def _findings(self) -> Iterator[Finding]:
        jump = self.evidence.jump
        amplitudes = iter(self.best.fit.amplitudes.tolist() if self.best else [] if jump is None else [jump])
        for effect in self.evidence.effects:
            kind, intervals = effect.kind, self.evidence.parameters.get(effect.kind.name, {})
            units = {p.name: p.unit for p in kind.parameters(self.records) or ()}
            values = dict(effect.values)
            ends = {name: [low, high] for name, (_, low, high) in intervals.items()}
            load = self.extension.load if self.extension else None
            if load is not None and load.parameter in values:
                values[load.parameter], ends[load.parameter] = load.value, list(load.interval)
            parameters = {
                name: {
                    "value": value,
                    "ci95": ends.get(name),
                    "unit": units.get(name, "MPa" if name == "reference" else "").replace(
                        "input unit", self.runs[0].input_unit
                    ),
                }
                for name, value in values.items()
            }
            for (name, unit), value in zip(kind.amplitudes(self.runs[0].input_unit, self.unit), amplitudes):
                parameters[name] = {"value": value, "ci95": None, "unit": unit}
            yield Finding(kind.name, self.causes[Part("effect", kind.name)], parameters)

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the command line."""
        return measured_json(self)

    @cached_property
    def with_proportional_part(self) -> MeasuredExtension | None:
        """The given model with a part of the output proportional to the input, where blocks left out call for it and
        nothing else extends it.
        """
        return None if self.extended else with_proportional_part(self.plain)

    @property
    def base_model(self) -> Model:
        """The given model with its measure fitted again to the same readings, without any effect."""
        hysteresis = hysteresis_of_first_run(self.base.fit)
        plain = extended_model(self.plain, hysteresis, MeasurementPart(()), "refitted", "")
        return replace(plain, measurement={}, warnings=self.given.warnings)

    @property
    def conditions(self) -> list[str]:
        """Conditions that differ between the runs of the diagnosis, or from those of the model."""
        by = {e.kind.by_condition for e in self.evidence.effects}
        pooled = pooled_conditions(self.runs[: self.train], by)
        foreign = [s for run in self.runs for s in foreign_conditions(self.given, run)]
        return list(dict.fromkeys([*pooled, *foreign]))

    @property
    def not_testable(self) -> list[str]:
        """Effects that these records cannot show."""
        return [
            k.name
            for k in measurement_effect_types()
            if not k.descriptive and k.name not in (*self.evidence.testable, *self.verdict.names)
        ]

    def __repr__(self) -> str:
        found = " + ".join(self.verdict.names) or self.verdict.depends_on or ""
        return f"MeasuredDiagnosis({self.verdict.word}{': ' if found else ''}{found})"


def diagnose_measured(
    model: Model,
    train: Sequence[Run],
    held_out: Sequence[Run],
    without: Sequence[str] = (),
    progress: Callable[[str], None] = lambda _: None,
    select: str | None = None,
    seed: int = 0,
) -> MeasuredDiagnosis:
    """Diagnose a model on runs with a measured input; ``select`` and ``seed`` as in ``diagnose``.

    Raises DataError if they hold no usable reading.
    """
    started = time.monotonic()
    records, count = records_of(train, held_out)
    selected = None if select is None else selected_rows([*train, *held_out], records, select)
    comparison = compared(records, count, selected)
    base = comparison.evaluated([])
    error = held_out_error(base, count)
    given = replayed_error(model, [*train, *held_out], comparison)
    tested = ~comparison.train
    limit = _error_to_beat(error[tested], given[tested], model, held_out)
    plain = PlainModel(model, base, comparison, tuple(train), tuple(held_out), limit)
    evidence = compare_measured(
        train,
        held_out,
        without,
        progress,
        selected,
        lambda v: next(iter(_terms(plain, v)), None),
        partial(ratio_by_effects, plain),
        seed,
    )
    extension = _extension(plain, evidence)
    gain = _gain(error, extension.error if extension else error, given, comparison, evidence.noise)
    if gain and extension and extension.law and gain.by_chance:  # no cause speaks for a law
        extension, gain = None, gain.without_extension()
    return MeasuredDiagnosis(
        evidence=evidence,
        plain=plain,
        extension=extension,
        given_error=given,
        gain=gain,
        seconds=time.monotonic() - started,
    )


def _terms(plain: PlainModel, variable: str) -> tuple[LearnedTerm, ...]:
    law = plain.law_of(variable)
    return law.terms if law else ()


def _extension(plain: PlainModel, evidence: MeasuredComparison) -> MeasuredExtension | None:
    """The extended model of the verdict. What lies between training and held-out runs changes no model, and a law of
    one of several variables that go together would hold for such runs only.
    """
    verdict = evidence.verdict
    if evidence.between_runs:
        return None
    if verdict.word in ("named", "ambiguous"):
        return extension_by_effects(plain, evidence.effects, verdict.word)
    if verdict.word == "unknown" and verdict.depends_on and verdict.reason != "confounded":
        return extension_by_law(plain, verdict.depends_on)
    return None


def _error_to_beat(base: Array, given: Array, model: Model, held_out: Sequence[Run]) -> float:
    """The least error on held-out readings of the plain model and of the given one, unless that was identified from
    them.
    """
    known = {p.sha256 for p in model.provenance}
    if not base.size or not np.isfinite(given).all() or any(file_hash(run) in known for run in held_out):
        return root_mean_square(base) if base.size else np.inf
    return min(root_mean_square(base), root_mean_square(given))


def _gain(
    base: Array, extended: Array, given: Array, comparison: Comparison, noise: float
) -> HeldOutGain | None:
    tested = ~comparison.train
    if not tested.any():
        return None
    known = given[tested]
    floor = min(
        noise, root_mean_square(extended[tested]), root_mean_square(base[tested])
    )  # no error is below the noise
    return HeldOutGain(
        base[tested],
        extended[tested],
        comparison.plan.block[tested],
        floor,
        None,
        known if np.isfinite(known).all() else None,
    )
