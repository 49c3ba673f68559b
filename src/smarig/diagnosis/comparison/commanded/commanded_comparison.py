"""The diagnosis of runs with a commanded current by the comparison of hypotheses."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from threadpoolctl import threadpool_limits

from smarig.diagnosis.comparison.commanded.commanded_diagnosis import CommandedDiagnosis
from smarig.diagnosis.comparison.commanded.commanded_evidence import (
    evidence_of,
    likeliest_variable,
    ways_of,
)
from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem
from smarig.diagnosis.comparison.commanded.commanded_search import SearchedHypotheses, search
from smarig.diagnosis.comparison.commanded.compared_runs import subject_of
from smarig.diagnosis.comparison.commanded.extension import (
    extension_of,
    gain_with,
    held_out_shares,
    law_extensions,
)
from smarig.diagnosis.comparison.commanded.shown_by_held_out import variable_of_all_runs
from smarig.diagnosis.comparison.commanded.undetermined import missing_knowledge_of
from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.verdict_rules import RULES, Verdict, VerdictEvidence, decide
from smarig.diagnosis.comparison.weights import weigh
from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.record import Run, loaded_runs
from smarig.replay import Model, load_model

ASK_ALL_RUNS = (
    "inadequate",
    "unseen",
    "worse",
    "not_borne_out",
)  # no cause of the training runs explains the errors


@threadpool_limits.wrap(limits=1, user_api="blas")  # small matrices: threads would only wait for each other
def diagnose_commanded(
    model: Model | str | Path,
    train: Sequence[Run | str | Path] | Run | str | Path,
    held_out: Sequence[Run | str | Path] | Run | str | Path = (),
    *,
    seed: int = 0,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> CommandedDiagnosis:
    """Diagnose a model on runs of one wire by predictions of blocks that were left out: what it lacks, and the gain.

    ``held_out`` runs only measure the gain, and that a named cause does not predict them worse. ``without`` names
    effects to leave out of the catalogue, ``seed`` is that of the resampling of blocks. Raises DataError if the runs
    hold no settled steps or overlap.
    """
    started, report = time.monotonic(), progress or (lambda _: None)
    original = model if isinstance(model, Model) else load_model(model)
    train_runs, held_out_runs = loaded_runs(train), loaded_runs(held_out)
    subject = subject_of(original, train_runs, held_out_runs, without)
    found = search(subject, report)
    return replace(
        concluded(subject, found, original, tuple(train_runs), tuple(held_out_runs), seed),
        seconds=time.monotonic() - started,
    )


def concluded(
    subject: CommandedProblem,
    found: SearchedHypotheses,
    original: Model,
    train: tuple[Run, ...],
    held_out: tuple[Run, ...],
    seed: int = 0,
) -> CommandedDiagnosis:
    """The verdict on searched hypotheses, and the model that is offered."""
    weights = weigh(found.hypotheses, seed, acts_through=ways_of(found))
    by_effects = extension_of(subject, found, weights)
    gain_by_effects = gain_with(subject, by_effects, train, held_out)
    shares = held_out_shares(subject, found, by_effects, gain_by_effects, train, held_out)
    evidence = evidence_of(subject, found, weights, by_effects, gain_by_effects, shares)
    missing = missing_knowledge_of(subject, by_effects.base, evidence.noise, train, held_out)
    if missing:
        evidence = replace(evidence, beyond_limit=0.0)
    verdict = _with_variable(decide(evidence), evidence, weights.nothing)
    if verdict.reason in ASK_ALL_RUNS:
        verdict = _by_all_runs(verdict, variable_of_all_runs(subject, [*train, *held_out]))
    if verdict.reason == "inadequate" and verdict.depends_on is None and subject.fluctuates(subject.base):
        verdict = replace(verdict, reason="fluctuates", depends_on="time")
    likelier = (
        verdict.word != "silent" and weights.nothing < RULES["nothing"].value
    )  # something, than nothing
    describes = by_effects.parts and not _variable_instead(verdict, evidence, by_effects.parts)
    tried = [(by_effects, gain_by_effects)] if describes and likelier else []
    if verdict.word == "unknown" and likelier:
        laws = law_extensions(subject, found, by_effects.base)
        of_verdict = [law for law in laws if [p.name for p in law.parts] == [verdict.depends_on]]
        tried += [(law, gain_with(subject, law, train, held_out)) for law in of_verdict or laws]
    better = [pair for pair in tried if not _worse(pair[1])]
    extension, gain = max(better, key=lambda pair: pair[0].score, default=(by_effects, gain_by_effects))
    offered = bool(better)
    return CommandedDiagnosis(
        subject=subject,
        found=found,
        weights=weights,
        evidence=evidence,
        verdict=verdict,
        extension=extension,
        extended=offered,
        gain=gain if offered or gain is None else gain.without_extension(),
        missing=missing,
        original=original,
        train=train,
        seconds=0.0,
    )


def _with_variable(verdict: Verdict, evidence: VerdictEvidence, raw_nothing: float) -> Verdict:
    """An unknown cause with the likeliest variable; silence over causes that remove too little says so."""
    if verdict.reason == "nothing" and raw_nothing < RULES["nothing"].value:
        verdict = replace(verdict, reason="too_small")
    named = verdict.reason == "left_over"  # the rules have said which variable is left
    if verdict.word != "unknown" or named or evidence.nothing >= RULES["nothing"].value:
        return verdict
    return replace(verdict, depends_on=likeliest_variable(evidence))


def _by_all_runs(verdict: Verdict, variable: str | None) -> Verdict:
    """An unknown cause with the variable that the errors of all runs go with, if there is one."""
    if variable is None:
        return verdict
    reason = "variable" if verdict.reason == "inadequate" else verdict.reason
    return replace(verdict, reason=reason, depends_on=variable)


def _variable_instead(verdict: Verdict, evidence: VerdictEvidence, effects: tuple[Part, ...]) -> bool:
    """Whether the variable of an unknown verdict is likely to act, and none of these effects is."""
    variable = Part("variable", verdict.depends_on or "")
    likely = RULES["nothing"].value
    return (
        verdict.word == "unknown"
        and evidence.causes.get(variable, 0.0) >= likely
        and all(evidence.causes.get(p, 0.0) < likely for p in effects)
    )


def _worse(gain: HeldOutGain | None) -> bool:
    """Whether an extended model predicts held-out runs worse than the base model, or than the given one.

    By the weights of the prediction, or by settled points as ``verify`` counts them.
    """
    if gain is None:
        return False
    others = [gain.base_error, *([gain.original_error] if gain.original_error is not None else [])]
    least = min(gain.settled_rms(e) for e in others)
    by_settled = gain.settled_rms(gain.extended_error) > RULES["worse"].value * least
    return by_settled or gain.extended > min(gain.base, gain.original or gain.base)
