"""The diagnosis of runs with settled steps: test the residuals, find effects, extend the model, measure the gain."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from smarig.core import UsageError
from smarig.diagnosis.critique.critique import ALPHA, NULL_DATA_SETS, critique
from smarig.diagnosis.critique.settings import check_settings
from smarig.diagnosis.critique.visibility import visibility
from smarig.diagnosis.diagnosed_model import diagnosed_model
from smarig.diagnosis.diagnosis_result import Diagnosis, ErrorSummary
from smarig.diagnosis.diagnosis_verdict import DiagnosisVerdict, decide_verdict
from smarig.diagnosis.effects_to_try import effects_to_try
from smarig.diagnosis.explain.channel_misfit import channel_misfits
from smarig.diagnosis.explain.discrepancy import likeliest_discrepancy
from smarig.diagnosis.explain.joint_density import (
    settled_rms,
    with_density_for_effects,
    with_posterior_density,
)
from smarig.diagnosis.explain.learned_term_fit import LearnedTermFit, learned_term
from smarig.diagnosis.explain.search import NearestEffect
from smarig.diagnosis.explain.separate_evidence import separate_evidence
from smarig.diagnosis.explain.signed_density import find_explanations
from smarig.diagnosis.explain.zero_of_output import with_zero_of_runs
from smarig.diagnosis.held_out_gain import HeldOutGain, held_out_gain
from smarig.diagnosis.name_gates import NameEvidence, gated
from smarig.diagnosis.run_checks import check_comparable, check_held_out
from smarig.plant import EffectType
from smarig.record import Run, loaded_runs
from smarig.replay import (
    Model,
    PlantModel,
    Timeline,
    actuator_for_run,
    build_timeline,
    driven_by_input,
    load_model,
    numerics,
    plant_model_of,
)


@threadpool_limits.wrap(
    limits=1, user_api="blas"
)  # matrices have a few hundred rows: threads would only wait for each other
def diagnose_commanded(
    model: Model | str | Path,
    train: Sequence[Run | str | Path] | Run | str | Path,
    held_out: Sequence[Run | str | Path] | Run | str | Path = (),
    *,
    alpha: float = ALPHA,
    nulls: int = NULL_DATA_SETS,
    seed: int = 0,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> Diagnosis:
    """Diagnose a model on runs of one wire: what it predicts wrongly, why, and what an extended model gains.

    ``diagnose`` also diagnoses runs that have only a measured input.

    The density is identified from ``train``; ``held_out`` runs only measure the gain. ``without`` names effects to
    leave out of the catalogue. ``alpha`` is the probability of any false alarm, ``nulls`` the number of null data
    sets. Raises DataError if the runs hold no settled steps or overlap, and UsageError for invalid settings.
    """
    started, report_progress = time.monotonic(), progress or (lambda _: None)
    check_settings(alpha, nulls, seed)
    original = model if isinstance(model, Model) else load_model(model)
    train_runs, held_out_runs = loaded_runs(train), loaded_runs(held_out)
    check_comparable(original, [*train_runs, *held_out_runs])
    if driven_by_input(train_runs):
        raise UsageError("These runs have only a measured input. Use diagnose or diagnose_measured.")
    timeline, plant_model = _timeline_and_subject(original, train_runs)
    if held_out_runs:
        _check_held_out(original, train_runs, held_out_runs)
    catalogue, insensitive = _visible_effect_types(
        effects_to_try(plant_model, without), timeline, plant_model
    )
    report_progress(
        f"{len(timeline.settled)} settled points, {sum(len(r) for r in timeline.other_readings)} other readings"
    )
    criticise = partial(critique, timeline, effect_types=catalogue, count=nulls, alpha=alpha, seed=seed)
    seen = find_explanations(timeline, plant_model, criticise, report_progress)
    base, first, levels = seen.base, seen.first, seen.levels
    decided = decide_verdict(first, levels)
    before, after, searched = likeliest_discrepancy(timeline, base, seen.plain), None, base
    base = with_posterior_density(timeline, base, seen.plain, plant_model)
    extended, channels = base, ()
    if levels and decided.explanations:
        best_explanation = levels[-1].explanations[0]
        extended = with_density_for_effects(
            timeline, best_explanation.plant_model, best_explanation.refitted, base
        )
        explained = best_explanation.plant_model, best_explanation.refitted
        channels = channel_misfits(timeline, (searched, seen.plain), explained)
        after = likeliest_discrepancy(timeline, best_explanation.plant_model, best_explanation.refitted)
    final_refit = (levels[-1].critique if levels else first).refitted
    noise, open_density = final_refit.noise, final_refit.posterior.variances

    def measured_gain(extended: PlantModel) -> HeldOutGain | None:
        if not held_out_runs:
            return None
        return held_out_gain(
            train=train_runs,
            held_out=held_out_runs,
            base=base,
            extended=extended,
            noise=noise,
            variances=open_density,
            original=plant_model,
        )

    gain = measured_gain(extended)
    effect_nats = levels[-1].explanations[0].evidence - seen.plain.log_evidence if levels else 0.0
    base_rms = settled_rms(timeline, base)
    ratio, times_noise = settled_rms(timeline, extended) / base_rms, base_rms / before.noise
    evidence = NameEvidence(
        tuple(levels), effect_nats, before, after, gain, ratio, first.alarm, times_noise, channels
    )
    if evidence.operator_fails and after is not None:
        report_progress("separating the evidence of each effect")
        separate = separate_evidence(timeline, levels[-1].explanations[0], after)
        evidence = replace(evidence, separate=separate)
    found = gated(decided, evidence)
    verdict = found.verdict
    offered, learned, learned_reason = verdict.word in ("named", "ambiguous"), None, ""
    if verdict.word == "unknown":
        report_progress("learning the missing term")
        term = learned_term(timeline, searched, seen.plain, plant_model.hysteresis)
        with_term, gain_of_term, learned_reason = _if_borne_out(timeline, term, measured_gain)
        if with_term is not None:
            extended, gain, offered, learned = with_term, gain_of_term, True, term
    return Diagnosis(
        verdict=verdict,
        reason=found.reason,
        discrepancy=before,
        remaining=after,
        timeline=timeline,
        first=first,
        levels=tuple(levels),
        base=base,
        visibility=visibility(first, insensitive),
        error=ErrorSummary(
            timeline.unit,
            _floor(noise.white[: len(timeline.settled)]),
            settled_rms(timeline, plant_model),
            settled_rms(timeline, base),
            settled_rms(timeline, extended if offered else base),
        ),
        gain=gain if offered or gain is None else gain.without_extension(),
        model=diagnosed_model(original, with_zero_of_runs(timeline, extended), train_runs, verdict.word)
        if offered
        else original,
        numerics=numerics(timeline, base),
        separate=evidence.separate,
        learned=learned,
        learned_reason=learned_reason,
        nearest=_nearest(verdict, seen.found.nearest),
        alpha=alpha,
        nulls=nulls,
        seconds=time.monotonic() - started,
    )


def _nearest(verdict: DiagnosisVerdict, found: NearestEffect | None) -> NearestEffect | None:
    """The effect that nearly gains enough for a name, where something is wrong and nothing has a name."""
    return found if found and found.is_clear and verdict.word == "unknown" else None


def _check_held_out(model: Model, train_runs: list[Run], held_out_runs: list[Run]) -> None:
    """Raise before any computation if the held-out runs cannot measure the gain."""
    check_held_out(train_runs, held_out_runs)
    build_timeline([*train_runs, *held_out_runs], actuator_for_run(model, train_runs[0]).tau_s)


def _timeline_and_subject(model: Model, runs: list[Run]) -> tuple[Timeline, PlantModel]:
    check_held_out(runs, ())
    timeline = build_timeline(runs, actuator_for_run(model, runs[0]).tau_s)
    return timeline, plant_model_of(model, timeline.runs[0])


def _visible_effect_types(
    all_types: list[EffectType], timeline: Timeline, plant_model: PlantModel
) -> tuple[list[EffectType], list[str]]:
    """(effects that these data could show, names of the effects that act before the input was measured)."""
    seen = [k for k in all_types if timeline.drive.can_show(k, plant_model.hysteresis)]
    return seen, [k.name for k in all_types if k not in seen]


def _if_borne_out(
    timeline: Timeline,
    term: LearnedTermFit | None,
    measured_gain: Callable[[PlantModel], HeldOutGain | None],
) -> tuple[PlantModel | None, HeldOutGain | None, str]:
    """The model with a law and its gain, or a clause on why it is not offered: base or given model predict better."""
    if term is None:
        return None, None, "no law of one variable predicts left-out blocks better"
    extended = with_posterior_density(timeline, term.explanation.plant_model, term.explanation.refitted)
    gain = measured_gain(extended)
    if gain is None or gain.extended <= min(gain.base, gain.original or np.inf):
        return extended, gain, ""
    variable = term.shape.variable_text
    return None, None, f"a law of {variable} predicts left-out blocks better, but the held-out runs worse"


def _floor(noise: np.ndarray) -> float:
    return float(np.sqrt(np.mean(noise**2)))
