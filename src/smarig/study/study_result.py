"""The result of a study as a value: what was read, how good the model is, and what to do now."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from smarig.core import capitalised
from smarig.diagnosis import CommandedDiagnosis, MeasuredDiagnosis
from smarig.identification import (
    BETTER,
    GOOD_RATIO,
    HARDLY_BETTER,
    LARGE_PLACE,
    LITTLE_UNPREDICTED,
    POOR_RATIO,
    SMALL_SHARE,
    AgainstCurves,
    ErrorLevel,
    ErrorParts,
    ErrorVerdict,
    RunVerification,
    error_verdict,
)
from smarig.study.baselines import BRANCHES
from smarig.study.candidate_models import (
    EXTENDED,
    NOISE_OF_A_READING,
    Evaluation,
    noise_of_neighbours,
    noise_of_repeats,
)
from smarig.study.column_hints import NO_TIME, column_hints
from smarig.study.data_split import DataSplit
from smarig.study.error_reasons import (
    differing_conditions,
    error_reasons,
    false_readings,
    mended,
    noisy_input,
    one_way,
    wrong_direction,
)
from smarig.study.field_loops import FieldLoops, field_loops
from smarig.study.function_of_input import FunctionOfInput
from smarig.study.heat_flow_sentences import heat_flow_sentences
from smarig.study.held_out_parts import BranchError, branch_errors, unpredicted_share, worst_place
from smarig.study.imported_runs import ImportedTable
from smarig.study.noise_of_input import noise_by_input
from smarig.study.other_zeros import zeros_of_held_out
from smarig.study.runs_by_condition import differing
from smarig.study.study_json import study_json
from smarig.study.study_sentences import (
    LEVEL_WORDS,
    InnerLoops,
    branch_name,
    error_sentence,
    finding_sentence,
    function_sentences,
    left_out_sentence,
    measure,
    place_text,
    proportional_sentence,
    simple_curve_sentence,
    unpredicted_sentence,
    where_sentence,
)
from smarig.study.temperatures_over_rates import rate_trend, readings_of
from smarig.study.transformation_figures import Transformation
from smarig.study.understanding import Understanding
from smarig.study.undetermined_states import UndeterminedStates, inside, new_turns, turns_of
from smarig.transformation import Calorimetry

_LESS = 0.97  # of the error without a cause: less of a gain is hardly one
GOOD, FAIR, POOR = str(ErrorLevel.GOOD), str(ErrorLevel.FAIR), str(ErrorLevel.POOR)


@dataclass(frozen=True, eq=False)
class StudyResult:
    """What a study found.

    ``evaluation`` and ``split`` are None for data without an output; ``heating`` then describes the temperature record.
    ``diagnosis`` is None if it was not requested or failed, with ``diagnosis_reason``. ``mapping`` is a mapping file
    that was given, None if one was drafted. ``without_cause``: the least rms error on held-out data of models without a
    named cause, in the measure of ``evaluation``; None without one. ``transformation``: None for an input that is no
    temperature. ``undetermined``: what the fitted data leave open, if the held-out error is that. ``calorimetry``: what
    curves of heat flow show; None for any other output. ``function``: the output as a function of the input; None for
    data that show hysteresis. ``assumed``: which unit is, and how to state another; "" for none.
    """

    name: str
    folder: Path
    files: tuple[Path, ...]
    understood: Understanding
    tables: tuple[ImportedTable, ...]
    left_out: dict[str, str]
    split: DataSplit | None
    evaluation: Evaluation | None
    diagnosis: CommandedDiagnosis | MeasuredDiagnosis | None
    diagnosis_reason: str
    heating: str
    seconds: float
    key: str
    transformation: Transformation | None = None
    mapping: str | None = None
    without_cause: float | None = None
    undetermined: UndeterminedStates | None = None
    calorimetry: Calorimetry | None = None
    function: FunctionOfInput | None = None
    assumed: str = ""

    @property
    def unit(self) -> str:
        """Unit of the output."""
        return self.tables[0].run.unit

    @property
    def _held_out(self) -> tuple[RunVerification, ...]:
        return self.evaluation.best.held_out if self.evaluation else ()

    @property
    def span(self) -> float:
        """The range of the output in the held-out data, also where the model has no prediction; NaN without a model."""
        parts = [r.measured[r.counted | ~np.isfinite(r.predicted)] for r in self._held_out]
        return float(np.ptp(np.concatenate(parts))) if parts else np.nan

    @property
    def nrmse(self) -> float:
        """Rms error on held-out data over the range of their output."""
        return self.evaluation.best.rms / self.span if self.evaluation and self.span else np.nan

    @property
    def unpredicted(self) -> float:
        """The share of the held-out data for which the model has no prediction."""
        return unpredicted_share(self._held_out)

    @cached_property
    def branches(self) -> list[BranchError]:
        """The errors on the wide branches of the held-out data, the largest first."""
        return branch_errors(self._held_out)

    @cached_property
    def _noise(self) -> tuple[float | None, str]:
        """The noise by which errors are judged, and its name: of repeats, else as the diagnosis estimates it, else from
        neighbouring readings; that of the input is part of it.
        """
        known = noise_of_repeats(self._held_out)
        if known is not None or self.evaluation is None:
            return known or (None, NOISE_OF_A_READING)
        best = self.evaluation.best
        output = (
            self.diagnosis.noise
            if isinstance(self.diagnosis, MeasuredDiagnosis)
            else noise_of_neighbours(best)
        )
        return output and float(np.hypot(output, noise_by_input(best))), NOISE_OF_A_READING

    @property
    def noise(self) -> float | None:
        """The noise by which errors are judged, in the unit of the output; None if unknown."""
        return self._noise[0]

    @property
    def noise_name(self) -> str:
        """What that noise is: of a reading, or the scatter of repeats."""
        return self._noise[1]

    @property
    def gain(self) -> float:
        """Error of the best simple curve over that of the model; where nothing is held out, over that on blocks left
        out of the fit: a curve has too few parameters to gain from them.
        """
        if self.evaluation is None or not self.evaluation.simple:
            return np.nan
        error = self.evaluation.best.rms if self._left_out is None else self._left_out
        return min(self.evaluation.simple.values()) / max(error, 1e-300)

    @property
    def at_noise(self) -> bool:
        """Whether the noise is known and the error on held-out data is hardly larger."""
        found, noise = self.evaluation, self.noise
        if self._left_out_is_worse:
            return False
        return bool(found and noise is not None and found.best.rms <= GOOD_RATIO * noise)

    @property
    def _left_out_is_worse(self) -> bool:
        """Whether nothing is held out, and blocks left out of the fit are predicted worse than noise would."""
        found = self._left_out
        return found is not None and bool(self.noise) and found > GOOD_RATIO * (self.noise or 0.0)

    @property
    def compared_on_left_out(self) -> bool:
        """Whether simple curves are compared with the error of the model on blocks left out of its fit."""
        return self._left_out is not None

    @property
    def _left_out(self) -> float | None:
        """The rms error of the model on blocks left out of its fit; None where data were held out, or if unknown."""
        d = self.diagnosis
        if not self._is_fitted or not isinstance(d, MeasuredDiagnosis) or self.evaluation is None:
            return None
        other, best = d.with_proportional_part, self.evaluation.best
        if other is not None and best.proportional_slope is not None:
            return other.hypothesis.rms
        return d.best.rms if d.best and best.name == EXTENDED else d.base.rms

    @property
    def _as_a_branch_pair(self) -> bool:
        """Whether the best simple curve is a rising and a falling branch, as of data that hold full loops only."""
        simple = self.evaluation.simple if self.evaluation else {}
        return bool(simple) and min(simple, key=simple.__getitem__) == BRANCHES

    @property
    def curves_as_good(self) -> bool:
        """Whether a rising and a falling branch do about as well as the model, or better than a very good one."""
        near = self.gain >= 1 / HARDLY_BETTER or self.nrmse <= SMALL_SHARE
        return self._as_a_branch_pair and near and self.gain < BETTER

    @cached_property
    def _fitted_turns_inside(self) -> bool:
        """Whether the fitted data hold inner loops, too."""
        e = self.evaluation
        return e is not None and inside(turns_of(e.plain.train), e.plain.train)

    @cached_property
    def _new_turns_inside(self) -> bool:
        """Whether the held-out data turn inside the loops of the fitted data, where those never turned."""
        e, split = self.evaluation, self.split
        return e is not None and split is not None and inside(new_turns(split, e.plain), e.plain.train)

    @property
    def inner_loops(self) -> InnerLoops:
        """Which of the data hold inner loops."""
        if self._fitted_turns_inside:
            return "fitted"
        return "held out" if self._new_turns_inside else "none"

    @property
    def _level_on_average(self) -> ErrorLevel:
        return self._error_verdict().level

    @property
    def verdict(self) -> str:
        """ "good", "fair" or "poor"; "" without a model. The thresholds are those of ``verify``."""
        if self.evaluation is None:
            return ""
        place = worst_place(self.branches)
        parts = ErrorParts(
            worst_branch=self._share(self.branches[0].rms) if self.branches else 0.0,
            worst_place=self._share(place.worst) if place else 0.0,
            unpredicted=self.unpredicted,
            doubtful=self.goes_one_way or self._left_out_is_worse,
        )
        return str(self._error_verdict(parts).level)

    def _error_verdict(self, parts: ErrorParts | None = None) -> ErrorVerdict:
        curves = AgainstCurves(self.gain, self._as_a_branch_pair)
        if self.goes_one_way:  # a curve is all that one branch can show
            curves = AgainstCurves(max(self.gain, 1.0), full_loops=True)
        if self.evaluation is None:
            return error_verdict(np.nan, self.noise, self.nrmse, curves=curves, parts=parts)
        found = self.evaluation.best
        unsteady = [r.repeatability for r in found.held_out if r.repeatability.over_readings is not None]
        return error_verdict(found.rms, self.noise, self.nrmse, *unsteady[:1], curves=curves, parts=parts)

    @cached_property
    def goes_one_way(self) -> bool:
        """Whether the input of all data goes one way only."""
        return self.evaluation is not None and one_way(self.evaluation.best)

    def _share(self, error: float) -> float:
        """An error over the range of the output; 0 if it is that of noise."""
        return error / self.span if self.span and error > POOR_RATIO * (self.noise or 0.0) else 0.0

    @property
    def reasons(self) -> list[str]:
        """What the data say about an error that is not good: sentences, the most certain first."""
        if self.evaluation is None or self.split is None or self.verdict == GOOD or self.function is not None:
            return []
        explained = error_reasons(
            self.split, self.evaluation.best, undetermined=self.undetermined is not None
        )
        return [*wrong_direction(self.tables), *self._where(), *noisy_input(self.tables), *explained]

    def sentences(self) -> list[str]:
        """Three sentences: how good the model is, against what, and what to do now."""
        if self.calorimetry is not None:
            return heat_flow_sentences(self.calorimetry)
        if self.evaluation is None:
            return [self.heating]
        if self.function is not None:
            return function_sentences(self.function, self.unit, fitted=self._is_fitted)
        first = error_sentence(
            self.evaluation.best.name,
            self.evaluation.best.rms,
            self.unit,
            share=self.nrmse,
            noise=self._noise,
            verdict=self._verdict_words(),
            unpredicted=self.unpredicted,
            fitted=self._is_fitted,
        )
        first += self._proportional_sentence()
        if self._left_out is not None:
            first += f" {left_out_sentence(self._left_out, self.unit, self._noise)}"
        return [first, self._simple_sentence(), self._next_sentence()]

    def _proportional_sentence(self) -> str:
        """How large the part of the output is that is proportional to the input, where the model has one."""
        slope = self.evaluation.best.proportional_slope if self.evaluation else None
        if slope is None:
            return ""
        return f" {proportional_sentence(slope, self.unit, self.tables[0].run.input_unit)}"

    @cached_property
    def field_loops(self) -> tuple[FieldLoops, ...]:
        """The coercive field and remanence of loops over a field, for each condition of the runs."""
        return field_loops([table.run for table in self.tables])

    def false_readings(self) -> list[str]:
        """Which readings are clipped or were masked: what to know before any other sentence."""
        return list(false_readings(self.tables))

    def hints(self) -> list[str]:
        """What would show more, one sentence each."""
        found = [*column_hints(self.understood, of_mapping=self.mapping is not None), *mended(self.tables)]
        if self.evaluation is not None and self.split is not None:
            found += zeros_of_held_out(self.split, self.evaluation.best)
        runs = [table.run for table in self.tables]
        trend = None if differing(runs) else rate_trend(readings_of(self._temperatures(), runs))
        found += [trend.sentence()] if trend else []
        timed = any(table.run.has("t_s") or table.run.settled for table in self.tables)
        if not timed and not self.understood.forc and self.evaluation is not None and self.verdict != GOOD:
            found.append(NO_TIME)
        return [self.assumed, *found] if self.assumed else found

    def _temperatures(self) -> dict[str, Any]:
        """The temperatures of loops and of curves of heat flow, as JSON."""
        own = {"calorimetry": self.calorimetry, "transformation": self.transformation}
        return {name: found and found.to_json() for name, found in own.items()}

    @property
    def _is_fitted(self) -> bool:
        """Whether nothing is held out, so that the model is judged on the data that it was fitted to."""
        return self.split is not None and self.split.kind == "none"

    @property
    def _hot(self) -> bool:
        return self.tables[0].run.input_unit in ("K", "degC")

    @property
    def _mostly_silent(self) -> bool:
        return self.unpredicted > LITTLE_UNPREDICTED

    def _verdict_words(self) -> str:
        """The verdict, with the branch that decides it, or with the place that it excepts."""
        level, place = ErrorLevel(self.verdict), worst_place(self.branches)
        if level is ErrorLevel.GOOD and self.curves_as_good and self.inner_loops == "none":
            return "good for full loops; inner loops were not tested"
        if level is ErrorLevel.FAIR and self._level_on_average is ErrorLevel.GOOD and self._left_out_is_worse:
            return "fair, as blocks left out of the fit are predicted less well"
        if self.undetermined is not None and self.undetermined.explains and level is not ErrorLevel.GOOD:
            return f"{level}, in states that no fitted data determine"
        if place is None or not self.span:
            return LEVEL_WORDS[level]
        if level is ErrorLevel.FAIR and self.goes_one_way:
            return "no loop to judge it by"
        if level is ErrorLevel.POOR and self._level_on_average is not level and not self.unpredicted > 0.5:
            return f"{LEVEL_WORDS[level]} on {branch_name(self.branches[0], temperature=self._hot)}"
        if level is ErrorLevel.FAIR and place.worst > LARGE_PLACE * self.span:
            return (
                f"fair, except on {place_text(place, self.tables[0].run.input_unit, temperature=self._hot)}"
            )
        return LEVEL_WORDS[level]

    def _where(self) -> list[str]:
        """Where the error is largest, and what is not predicted."""
        found = []
        if self._mostly_silent:
            found.append(unpredicted_sentence(self.unpredicted, whole_record=self._is_fitted))
        place = worst_place(self.branches)
        if place is not None:
            units = self.tables[0].run.input_unit, self.unit
            found.append(where_sentence(place, self.span, units, temperature=self._hot))
        return found

    def _simple_sentence(self) -> str:
        if self.evaluation is None or not self.evaluation.simple or self.goes_one_way:
            return ""
        name, error = min(self.evaluation.simple.items(), key=lambda item: item[1])
        return simple_curve_sentence(
            name,
            error,
            self.gain,
            self.unit,
            left_out=self.compared_on_left_out,
            as_well=self.curves_as_good,
            inner_loops=self.inner_loops,
        )

    def _next_sentence(self) -> str:
        missing = (
            "" if self.undetermined is None else self.undetermined.sentence(self.tables[0].run.input_unit)
        )
        if self.diagnosis is None:
            return missing or f"No diagnosis: {self.diagnosis_reason}"
        causes = self.diagnosis.verdict.word in ("named", "ambiguous")
        if self.undetermined is not None and self.undetermined.explains and not causes:
            return missing
        split = self.split
        differing = differing_conditions([*split.train, *split.held_out]) if split else ()
        small = self.verdict == GOOD
        finding = finding_sentence(self.diagnosis, at_noise=self.at_noise, small=small, differing=differing)
        if which := self._diagnosed_model():
            finding = f"{which}{finding[:1].lower()}{finding[1:]}"
        found = f"{finding}{self._gain_by_cause()}"
        return found if causes or not missing else f"{missing} {found}"

    def _diagnosed_model(self) -> str:
        """Which model the diagnosis is of, where the sentences before judge another: a diagnosis knows no loads."""
        e = self.evaluation
        named = (
            self.diagnosis is not None and self.diagnosis.verdict.word == "named"
        )  # perhaps the load itself
        if e is None or named or e.best.name in (e.by_history.name, EXTENDED):
            return ""
        rms = measure(e.plain.rms, self.unit)
        return f"The diagnosis is of a model that pools the loads ({e.plain.name}, {rms} rms): "

    def _gain_by_cause(self) -> str:
        """What a named cause explains of data that did not fit it."""
        d = self.diagnosis
        if d is None or d.verdict.word != "named" or not d.extended:
            return ""
        left_out = ""
        if isinstance(d, MeasuredDiagnosis) and d.best is not None and d.best.rms < d.base.rms:
            left_out = f"On blocks left out of the fit, {self._with_and_without(d.best.rms, d.base.rms)}"
        errors = None if self._is_fitted else self._held_out_errors(d)
        if errors is None:
            return f" {left_out}." if left_out else ""
        both = self._with_and_without(*errors)
        if errors[0] < _LESS * errors[1]:
            return f" On the held-out data, {both}."
        little = f"on the held-out data, {both}: they hardly show it."
        return f" {left_out}; {little}" if left_out else f" {capitalised(little)}"

    def _held_out_errors(self, d: CommandedDiagnosis | MeasuredDiagnosis) -> tuple[float, float] | None:
        """The errors on held-out data with the cause and without, in the measure of the page if that is known."""
        extended = self.evaluation.extended if self.evaluation else None
        if extended is not None and self.without_cause is not None:
            return extended.rms, self.without_cause
        return None if d.gain is None else (d.gain.extended, d.gain.base)

    def _with_and_without(self, extended: float, base: float) -> str:
        return f"the error is {measure(extended, self.unit)} with it and {measure(base, self.unit)} without"

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the command line, which is also DIR/study.json."""
        return study_json(self)
