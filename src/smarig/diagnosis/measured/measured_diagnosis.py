"""The diagnosis of a model on runs with a measured input: data of others, without current and without settled steps.

Every hypothesis, the plain variables included, is judged by its errors on blocks left out of the fit. A name must earn
its place there and on the held-out runs; otherwise the finding is the variable on which the errors depend.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import NotebookDisplay
from smarig.diagnosis.diagnosis_verdict import DiagnosisVerdict
from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.diagnosis.measured.adequacy import held_out_parts, is_adequate, reading_noise
from smarig.diagnosis.measured.extended_measured_model import extended_measured_model, hysteresis_of_first_run
from smarig.diagnosis.measured.held_out_runs import RunOffset, held_out_error, run_offsets
from smarig.diagnosis.measured.held_out_shift import HeldOutShift, held_out_shift, with_held_out_shift
from smarig.diagnosis.measured.learned_extension import WORSE, learned_extension, verdict_with_learned
from smarig.diagnosis.measured.learned_law import LearnedLaw
from smarig.diagnosis.measured.measured_runs import records_of, replayed_error, selected_rows
from smarig.diagnosis.measured.measured_search import SearchStep, search_effects
from smarig.diagnosis.measured.measured_text import measured_lines
from smarig.diagnosis.measured.measured_verdict import MeasuredVerdict, decide, smallest_chance
from smarig.diagnosis.measured.preisach_properties import PropertyTest, preisach_properties
from smarig.diagnosis.suspects import suspects
from smarig.identification import (
    Comparison,
    LoadDependence,
    MeasuredHypothesis,
    compared,
    condition_table,
    fit_load_dependence,
)
from smarig.measurement import (
    InputRecord,
    MeasurementEffect,
    MeasurementEffectType,
    MeasurementPart,
    measurement_effect_types,
)
from smarig.record import Run
from smarig.replay import Model, file_hash, foreign_conditions, pooled_conditions

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MeasuredDiagnosis(NotebookDisplay):
    """The verdict on a model and runs with a measured input, with its evidence.

    ``steps`` are the rounds of the search. ``base`` is the plain model fitted to the training runs, ``best`` the model
    with the effects found or a learned term (None if there is neither). ``noise`` is the standard deviation of one
    reading. ``given_error`` (m,) are the errors of the given model at the readings, NaN where it predicts nothing.
    ``offsets`` are held-out runs whose input disagrees with that of the training runs. ``model`` is the extended model,
    else the given one. ``shift`` says that the held-out runs differ.
    ``learned`` is the law that ``best`` has instead of effects; if None, ``learned_reason`` is a
    clause on why there is none. ``properties`` tests the return point and wiping-out.
    """

    verdict: DiagnosisVerdict
    reason: str
    comparison: Comparison
    train: int
    steps: tuple[SearchStep, ...]
    base: MeasuredHypothesis
    best: MeasuredHypothesis | None
    noise: float
    given_error: Array
    gain: HeldOutGain | None
    offsets: tuple[RunOffset, ...]
    given: Model
    model: Model
    load: LoadDependence | None
    learned: LearnedLaw | None
    learned_reason: str
    shift: HeldOutShift | None
    properties: tuple[PropertyTest, ...]
    p_value: float
    runs: tuple[Run, ...]
    seconds: float

    @property
    def extended(self) -> bool:
        """Whether ``model`` is an extended one."""
        return self.best is not None

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

    def rms(self, found: MeasuredHypothesis | None = None) -> float:
        """Rms error at the training readings: of the plain model, or of a hypothesis."""
        error = (found or self.base).fit.error[self.comparison.train]
        return float(np.sqrt(np.mean(error**2)))

    @property
    def given_rms(self) -> float | None:
        """Rms error of the given model at the training readings, or None if it predicts none of them."""
        error = self.given_error[self.comparison.train]
        known = np.isfinite(error)
        return float(np.sqrt(np.mean(error[known] ** 2))) if known.any() else None

    def effects(self) -> list[dict[str, Any]]:
        """The effects found: name, probability, parameters with 95 % intervals."""
        if self.best is None:
            return []
        amplitudes = iter(self.best.fit.amplitudes.tolist())
        return [self._effect_json(e, amplitudes) for e in self.best.effects]

    def _effect_json(self, effect: MeasurementEffect, amplitudes: Any) -> dict[str, Any]:
        kind, units = effect.kind, {}
        for step in self.steps:
            for h in step.effects:
                if h.effects[-1].kind is kind:
                    units = h.intervals | units
        values = dict(effect.values)
        if self.load is not None and self.load.parameter in values:
            values[self.load.parameter] = self.load.value
            units = units | {self.load.parameter: self.load.interval}
        parameters = {
            name: {
                "value": value,
                "ci95": [x if np.isfinite(x) else None for x in units[name]] if name in units else None,
                "unit": self._unit(kind, name),
            }
            for name, value in values.items()
        }
        for name, unit in kind.amplitudes(self.runs[0].input_unit, self.unit):
            parameters[name] = {"value": next(amplitudes), "ci95": None, "unit": unit}
        probability = self.verdict.probability(kind.name)
        return {"name": kind.name, "probability": probability, "parameters": parameters}

    def _unit(self, kind: MeasurementEffectType, name: str) -> str:
        searched = kind.parameters(self.records[: self.train]) or ()
        unit = next((p.unit for p in searched if p.name == name), "MPa" if name == "reference" else "")
        return unit.replace("input unit", self.runs[0].input_unit)

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the command line."""
        gain = self.gain
        return {
            "verdict": self.verdict.word,
            "effects": self.effects(),
            "set": list(self.verdict.names) if self.extended else [],
            "depends_on": self.verdict.depends_on,
            "reason": self.reason or None,
            "not_identifiable": self.not_testable,
            "error": {
                "unit": self.unit,
                "noise_floor": self.noise,
                "base": self.rms(),
                "extended": self.rms(self.best),
                "given": self.given_rms,
            },
            "adequacy": {
                "times_noise": self.base.rms / self.noise if self.noise else None,
                "where": held_out_parts(self.base),
                "adequate": is_adequate(self.base),
            },
            "learned": self.learned and self.learned.to_json(),
            "preisach_properties": {t.name: t.to_json() for t in self.properties},
            "held_out": gain and gain.to_json(),
            "held_out_shift": self.shift and {"depends_on": self.shift.variable, "ratio": self.shift.ratio},
            "run_offsets": [
                {
                    "run": o.run,
                    "offset": o.offset,
                    "ci95": list(o.interval),
                    "error_without": o.without,
                    "error_with": o.with_offset,
                }
                for o in self.offsets
            ],
            "suspects": [s.to_json() for s in suspects(self.runs)],
            "conditions": self.conditions,
            "separating_run": None,
            "alpha": None,
            "nulls": 0,
            "p_value": self.p_value,
            "stands_out": self.verdict.word != "silent",
            "model": self.model.name,
            "seconds": self.seconds,
        }

    @property
    def base_model(self) -> Model:
        """The given model with its measure fitted again to the same readings, without any effect."""
        hysteresis, train = hysteresis_of_first_run(self.base.fit), self.runs[: self.train]
        plain = extended_measured_model(self.given, hysteresis, MeasurementPart(()), "refitted", "", train)
        return replace(plain, measurement={}, warnings=self.given.warnings)

    @property
    def conditions(self) -> list[str]:
        """Conditions that differ between the runs of the diagnosis, or from those of the model."""
        by = {e.kind.by_condition for e in self.best.effects} if self.best else set()
        pooled = pooled_conditions(self.runs[: self.train], by)
        foreign = [s for run in self.runs for s in foreign_conditions(self.given, run)]
        return list(dict.fromkeys([*pooled, *foreign]))

    @property
    def not_testable(self) -> list[str]:
        """Effects that these records cannot show."""
        records = self.records[: self.train]
        return [k.name for k in measurement_effect_types() if k.parameters(records) is None]

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
) -> MeasuredDiagnosis:
    """Diagnose a model on runs with a measured input; ``select`` as in ``diagnose``.

    Raises DataError if they hold no usable reading.
    """
    started = time.monotonic()
    records, count = records_of(train, held_out)
    selected = None if select is None else selected_rows([*train, *held_out], records, select)
    comparison = compared(records, count, selected)
    plan = comparison.plan
    progress(f"{int(comparison.train.sum())} readings, {np.unique(plan.block[comparison.train]).size} blocks")
    kinds = [k for k in measurement_effect_types() if k.name not in without]
    steps = search_effects(comparison, kinds, count, progress)
    base, last = steps[0].start, steps[-1].start
    noise = reading_noise(base)
    errors = held_out_error(base, count), held_out_error(last, count)
    tested = ~comparison.train
    given = replayed_error(model, [*train, *held_out], comparison)
    limit = _error_to_beat(errors[0][tested], given[tested], model, held_out)
    worse = bool(tested.any() and last.effects and _rms(errors[1][tested]) > WORSE * limit)
    decided = decide(steps, worse_on_held_out=worse)
    best = decided.accepted if decided.accepted.effects else None
    load = _load_dependence(best, plan.records[:count])
    extended = _extended(model, decided, train, count, load) if best else model
    if load is not None:
        errors = errors[0], replayed_error(extended, [*train, *held_out], comparison, about_mean=False)
    learned, learned_reason = None, ""
    if decided.verdict.word == "unknown" and not is_adequate(base):
        sets = list(train), list(held_out)
        learned, learned_reason = learned_extension(model, base, limit, comparison, sets, progress)
    shift = held_out_shift(base, errors[0], comparison, count)
    offsets = tuple(run_offsets(comparison, best.effects if best else (), count))
    extended_error = learned.error if learned else errors[1] if best else errors[0]
    return MeasuredDiagnosis(
        verdict=with_held_out_shift(
            _with_offsets(verdict_with_learned(decided.verdict, learned, steps[0].variables), offsets), shift
        ),
        reason="" if learned and decided.verdict.depends_on is None else decided.reason,
        comparison=comparison,
        train=count,
        steps=tuple(steps),
        base=base,
        best=learned.hypothesis if learned else best,
        noise=noise,
        given_error=given,
        gain=_gain(errors[0], extended_error, given, comparison, noise),
        offsets=offsets,
        given=model,
        model=learned.model if learned else extended,
        load=load,
        learned=learned.law if learned else None,
        learned_reason=learned_reason,
        shift=shift,
        properties=preisach_properties(plan.records[:count], last.effects if best else ()),
        p_value=smallest_chance(steps[0]),
        runs=(*train, *held_out),
        seconds=time.monotonic() - started,
    )


def _error_to_beat(base: Array, given: Array, model: Model, held_out: Sequence[Run]) -> float:
    """The least error on held-out readings of the plain model and of the given one, unless that was identified from
    them.
    """
    known = {p.sha256 for p in model.provenance}
    if not base.size or not np.isfinite(given).all() or any(file_hash(run) in known for run in held_out):
        return _rms(base) if base.size else np.inf
    return min(_rms(base), _rms(given))


def _with_offsets(verdict: DiagnosisVerdict, offsets: Sequence[RunOffset]) -> DiagnosisVerdict:
    """The verdict; if nothing else is known, the errors depend on the run whose input is shifted."""
    if offsets and verdict.word in ("silent", "unknown") and verdict.depends_on is None:
        return DiagnosisVerdict("unknown", depends_on="run")
    return verdict


def _gain(
    base: Array, extended: Array, given: Array, comparison: Comparison, noise: float
) -> HeldOutGain | None:
    tested = ~comparison.train
    if not tested.any():
        return None
    known = given[tested]
    floor = min(noise, _rms(extended[tested]), _rms(base[tested]))  # no error is below the noise
    return HeldOutGain(
        base[tested],
        extended[tested],
        comparison.plan.block[tested],
        floor,
        None,
        known if np.isfinite(known).all() else None,
    )


def _load_dependence(
    best: MeasuredHypothesis | None, records: Sequence[InputRecord]
) -> LoadDependence | None:
    """The model of all loads, if an effect of the load alone was named: it predicts other loads better than one fit."""
    condition = best.effects[0].kind.by_condition if best and len(best.effects) == 1 else ""
    return fit_load_dependence(records, condition) if condition else None


def _extended(
    model: Model, decided: MeasuredVerdict, train: Sequence[Run], count: int, load: LoadDependence | None
) -> Model:
    """The given model with the measure of the accepted hypothesis, and with its effects."""
    found = decided.accepted
    warning = f"Effects by diagnosis ({decided.verdict.word}); measure identified jointly."
    if load is not None:
        return extended_measured_model(model, load.hysteresis, load.part, found.name, warning, train)
    part = MeasurementPart(found.effects, tuple(found.fit.amplitudes.tolist()), condition_table(found, count))
    hysteresis = found.fit.table if part.table else hysteresis_of_first_run(found.fit)
    return extended_measured_model(model, hysteresis, part, found.name, warning, train)


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))
