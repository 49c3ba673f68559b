"""The diagnosis of records with a measured input: which hypothesis predicts blocks that it has not seen.

    compare_measured(train, held_out).verdict

Held-out runs are further blocks that every hypothesis predicts and none is fitted to, unless they enter a part of the
Preisach plane that the training runs do not determine. Where nothing predicts them, causes that lie between runs are
fitted to all runs.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from smarig.core import DataError, root_mean_square
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part
from smarig.diagnosis.comparison.effects_alone import with_effects_alone
from smarig.diagnosis.comparison.intervals import interval
from smarig.diagnosis.comparison.measured.acting_effects import testable_effects
from smarig.diagnosis.comparison.measured.additions import KeptAddition, first_basis
from smarig.diagnosis.comparison.measured.hypothesis_search import LawOf, searched_hypotheses
from smarig.diagnosis.comparison.measured.missing_share import missing_knowledge, share_of_fits
from smarig.diagnosis.comparison.measured.reading_problem import ReadingProblem, reading_problem
from smarig.diagnosis.comparison.measured.varied_together import confounded
from smarig.diagnosis.comparison.measured.wire_records import WireRecord, wire_records
from smarig.diagnosis.comparison.missing_knowledge import MissingKnowledge
from smarig.diagnosis.comparison.verdict_rules import RULES, Verdict, VerdictEvidence, decide
from smarig.diagnosis.comparison.weights import TEMPERATURE, Weights, weigh
from smarig.diagnosis.suspects import suspects
from smarig.measurement import MeasurementEffect, measurement_effect_types
from smarig.record import Run

Mask = NDArray[np.bool_]
BASE_STEPS = 30
OFFSET = "input_offset"
RatioOf = Callable[[Sequence[MeasurementEffect]], float | None]
TRIMMED = 0.1  # of the blocks, those that gain most: one block is no measure of a size
OF_EACH_RUN = (OFFSET, "run")  # of a held-out run they say nothing
BETWEEN_RUNS = (OFFSET, "stress_shift", "run", "stress")
OF_RATES = ("input_lag", "rate")  # runs at other rates differ by these, too
JUMP = "output_jump"
DRIFTS = ("input_drift", "output_drift")  # what goes on within the runs goes on between them
WITHIN_A_RECORD = (
    JUMP,
    "ratcheting",
    "time",
    "cycle",
)  # its later part may hold them, though the earlier does not


@dataclass(frozen=True)
class RunOffset:
    """An offset of a run's input against that of another, with its 95 % interval, and the rms errors on blocks left
    out without and with it. ``held_out``: whether the run is a held-out one; all but the first have an offset.
    """

    run: str
    offset: float
    interval: tuple[float, float]
    without: float
    with_offset: float
    against: str
    held_out: bool


@dataclass(frozen=True, eq=False)
class MeasuredComparison:
    """The verdict on runs with a measured input, and what it is decided from; errors are in the output's unit.

    ``weights`` are those that decide. ``between_runs``: they are of causes between runs, with the held-out runs as
    blocks, so that no run is left to measure a gain. ``parameters``: value and 95 % interval, by part and name, of its
    heaviest hypothesis. ``base_error`` and ``extended_error`` of blocks left out; ``held_out``: error by name of a
    hypothesis. ``missing``: what the training runs do not determine and the held-out runs need, if it is their error.
    ``adequate``: whether the plain model misses the training readings by hardly more than their noise. ``testable``:
    names of the effects that these records can show. ``jump``: by how much the output jumps in the held-out part of a
    record, if that is the verdict. ``effects``: those of the verdict's names, all of a name, the
    likeliest of a set. ``offsets``, where the verdict lies between runs, of held-out runs first.
    """

    verdict: Verdict
    weights: Weights
    effects: tuple[MeasurementEffect, ...]
    offsets: tuple[RunOffset, ...]
    between_runs: bool
    parameters: Mapping[str, Mapping[str, tuple[float, float, float]]]
    base_error: float
    extended_error: float
    held_out: Mapping[str, float]
    noise: float
    missing: MissingKnowledge | None
    adequate: bool
    testable: tuple[str, ...]
    excursions: int
    seconds: float
    jump: float | None = None


def compare_measured(
    train_runs: Sequence[Run],
    held_out_runs: Sequence[Run] = (),
    without: Sequence[str] = (),
    progress: Callable[[str], None] = lambda _: None,
    selected: Sequence[Mask] | None = None,
    law_of: LawOf = lambda _: None,
    ratio_of: RatioOf = lambda _: None,
    seed: int = 0,
) -> MeasuredComparison:
    """Compare what may be wrong with a plain model of runs; ``without``: names of effects that are not tested for.

    ``selected``: the rows (n,) of each record that may be read; None: all. ``law_of`` gives the law of a variable, or
    None; ``ratio_of`` the error on held-out readings of the model with effects over that of the plain one, None if it
    is not known. ``seed`` is that of the resampling of blocks. Raises DataError if the runs hold too few readings.
    """
    started = time.monotonic()
    wires = wire_records(train_runs, held_out_runs, selected)
    if not any((~w.held_out).any() for w in wires):
        raise DataError("The training runs contain no reading in which input and output are known.")
    suspected = frozenset(s.effect for s in suspects(train_runs) if s.effect)
    problem = replace(reading_problem(wires), suspected=suspected)
    basis, plain = first_basis(problem, BASE_STEPS)
    base = plain.kept()
    missing = 0.0 if problem.train.all() else share_of_fits(base)
    if missing < RULES["not_determined"].value:
        problem = problem.with_unseen()
        basis, plain = replace(basis, problem=problem), replace(plain, problem=problem)
    nothing = plain.trial()
    del plain  # and its covariances
    weights = _weighed(
        problem, searched_hypotheses(basis, nothing, progress, without=without, law_of=law_of), seed
    )
    held = _held_out_errors(base, weights)
    evidence = _evidence(problem, base, weights, held)
    is_off = _held_out_is_off(base) and missing < RULES["not_determined"].value
    verdict = _borne_out(decide(evidence), evidence, weights, ratio_of if is_off else None)
    deciding = weights
    if held and verdict.word in ("silent", "unknown"):
        verdict, deciding = _with_held_out_runs(wires, verdict, held, weights, base, missing, without, seed)
    best = fitted(weights.heaviest)
    scale = abs(problem.scale)
    return MeasuredComparison(
        verdict=verdict,
        weights=deciding.without_states(),
        effects=_effects(verdict, deciding),
        offsets=() if deciding is weights else _offsets(deciding, wires),
        between_runs=deciding is not weights,
        parameters=_parameters(deciding),
        base_error=base.rms * scale,
        extended_error=best.rms * scale,
        held_out={name: error * scale for name, error in held.items()},
        noise=min(base.noise, best.noise) * scale,
        missing=missing_knowledge(base, missing) if _held_out_is_off(base) else None,
        adequate=evidence.adequate,
        testable=_testable(problem, deciding),
        excursions=problem.excursions,
        seconds=time.monotonic() - started,
        jump=None if deciding is weights or verdict.names != (JUMP,) else _jump(deciding),
    )


def _testable(problem: ReadingProblem, weights: Weights) -> tuple[str, ...]:
    tested = [kind.name for kind, _ in testable_effects(problem)]
    return tuple(dict.fromkeys([*tested, *(p.name for p in weights.causes if p.kind == "effect")]))


def _weighed(problem: ReadingProblem, hypotheses: Sequence[ComparedHypothesis], seed: int) -> Weights:
    """The weights; the segments of a branch count as one, for their errors are not independent."""
    cut = problem.counts.size / max(2 * problem.independent, 1)
    return weigh(hypotheses, seed, TEMPERATURE * max(cut, 1.0))


def fitted(hypothesis: ComparedHypothesis) -> KeptAddition:
    """The fit of a hypothesis at its best trial."""
    return hypothesis.best.state


def _held_out_errors(base: KeptAddition, weights: Weights) -> dict[str, float]:
    """The error on held-out readings of the plain model, of the heaviest hypothesis, and with each cause."""
    if base.problem.train.all():
        return {}
    relevant = {weights.heaviest.name: weights.heaviest}
    relevant |= {h.name: h for h in (weights.best_with(p) for p, w in weights.causes.items() if w > 0.01)}
    found = {"nothing": root_mean_square(base.held_out_error())}
    return found | {n: root_mean_square(fitted(h).held_out_error()) for n, h in relevant.items() if h.parts}


def _evidence(
    problem: ReadingProblem, base: KeptAddition, weights: Weights, held: Mapping[str, float]
) -> VerdictEvidence:
    sizes, ratios = {}, {}
    off = bool(held) and _held_out_is_off(base)
    for part in weights.causes:
        best = weights.best_with(part)
        shown = [best]  # a variable beside an effect describes what that leaves, an effect may stand alone
        if part.kind == "effect":
            shown.append(next(h for h in weights.hypotheses if h.parts == (part,)))
        sizes[part] = max(_removed(problem, _without(weights, h, part), h) for h in shown)
        if best.parts == (part,):
            sizes[part] = max(sizes[part], float(np.std(fitted(best).added[problem.train])))
        if part.name in OF_EACH_RUN:
            continue
        if best.name in held:
            ratios[part] = held[best.name] / max(held["nothing"], base.noise)
        elif not held and part.name in BETWEEN_RUNS:
            ratios[part] = fitted(best).run_error / base.run_error
    evidence = VerdictEvidence(
        causes=weights.causes,
        nothing=weights.nothing,
        together={
            frozenset(h.parts): w for h, w in zip(weights.hypotheses, weights.weight.tolist()) if h.parts
        },
        size=sizes,
        span=1.0,
        error=base.misfit,
        noise=base.noise,
        remains=dict.fromkeys(sizes, float(np.sqrt(fitted(weights.heaviest).sizes[-2]))),
        blocks=problem.independent,
        confounded=confounded(problem, weights.causes),
        held_out=ratios,
        not_borne_out=frozenset(p for p, ratio in ratios.items() if off and _leaves_more(ratio)),
        acts_through={p: _acts_through(p) for p in weights.causes},
        testable=len(weights.hypotheses) > 1,
    )
    return with_effects_alone(evidence, weights)


def _borne_out(verdict: Verdict, e: VerdictEvidence, weights: Weights, ratio_of: RatioOf | None) -> Verdict:
    """The verdict, without names if the model that they extend removes less of the held-out error than it leaves.

    The comparison may describe by a flexible density, or a variable beside an effect, what no model with the effect
    alone predicts.
    """
    ratio = ratio_of(_effects(verdict, weights)) if ratio_of and verdict.word == "named" else None
    if ratio is None or not _leaves_more(ratio):
        return verdict
    named = {p for p in e.causes if p.kind == "effect" and p.name in verdict.names}
    return decide(replace(e, not_borne_out=e.not_borne_out | named))


def _leaves_more(ratio: float) -> bool:
    """Whether what has this ratio of errors with it and without removes less than it leaves."""
    return 1.0 - ratio**2 < (RULES["beside_rest"].value * ratio) ** 2


def _acts_through(part: Part) -> tuple[Part, ...]:
    kinds = {k.name: k for k in measurement_effect_types()}
    return tuple(Part("variable", v) for v in kinds[part.name].depends_on) if part.name in kinds else ()


def _without(weights: Weights, hypothesis: ComparedHypothesis, part: Part) -> ComparedHypothesis:
    rest = {p for p in hypothesis.parts if p != part}
    return next(h for h in weights.hypotheses if set(h.parts) == rest)


def _removed(problem: ReadingProblem, start: ComparedHypothesis, hypothesis: ComparedHypothesis) -> float:
    """Root of the mean square that a hypothesis removes of the error of another, without the blocks that gain most."""
    count = problem.counts
    gain = start.best.squares - hypothesis.best.squares
    kept = np.argsort(-gain / count)[int(TRIMMED * count.size) :]
    return float(np.sqrt(max(gain[kept].sum() / count[kept].sum(), 0.0)))


def _parameters(weights: Weights) -> dict[str, dict[str, tuple[float, float, float]]]:
    """Value in the heaviest hypothesis, and interval, of each parameter of each effect."""
    found: dict[str, dict[str, tuple[float, float, float]]] = {}
    for part in weights.causes:
        single = next(h for h in weights.hypotheses if h.parts == (part,))
        best = weights.best_with(part).best.parameters
        for name in single.best.parameters:
            low, high = interval(single, name, weights)
            value = best[name]
            found.setdefault(part.name, {})[name] = (value, min(low, value), max(high, value))
    return found


def _with_held_out_runs(
    wires: Sequence[WireRecord],
    verdict: Verdict,
    held: Mapping[str, float],
    own: Weights,
    base: KeptAddition,
    missing: float,
    without: Sequence[str],
    seed: int,
) -> tuple[Verdict, Weights]:
    """The verdict with the held-out readings as blocks, if the plain model predicts them worse than its own blocks.

    It takes the place of a verdict of the training runs that says nothing, or that leaves more of the held-out runs'
    error than this removes.
    """
    whole = [w.held_out.all() for w in wires if w.held_out.any()]
    if not _held_out_is_off(base) or missing >= RULES["not_determined"].value:
        return verdict, own
    problem = reading_problem([replace(w, held_out=np.zeros_like(w.held_out)) for w in wires])
    basis, plain = first_basis(problem, BASE_STEPS)
    only = (*(BETWEEN_RUNS if any(whole) else ()), *OF_RATES, *DRIFTS)
    only += () if all(whole) else WITHIN_A_RECORD
    weights = _weighed(
        problem, searched_hypotheses(basis, plain.trial(), lambda _: None, only, without), seed
    )
    of_held_out = np.concatenate([w.held_out[rows] for w, rows in zip(wires, problem.rows)])
    evidence = drifting(_evidence(problem, plain.kept(), weights, {}))
    found = decide(evidence if all(whole) else _with_jump(evidence, weights, of_held_out))
    clearer = found.word in ("named", "ambiguous") or found.depends_on is not None
    if not any(whole):  # what acts all along, the fitted part has shown
        clearer = found.word == "named" and JUMP in found.names
    left = root_mean_square(fitted(weights.heaviest).error[of_held_out])
    own_error = held.get(own.heaviest.name, held["nothing"])
    keeps = verdict.depends_on not in (None, *BETWEEN_RUNS) and _leaves_more(left / own_error)
    return (found, weights) if clearer and not keeps else (verdict, own)


def _jump(weights: Weights) -> float:
    """By how much the output jumps, in its unit: what is added after it less what is before."""
    found = fitted(next(h for h in weights.hypotheses if h.name == JUMP))
    (name,) = next(iter(found.candidate.effects)).values
    problem = found.problem
    records = [k for k, r in enumerate(problem.records) if name in (r.whole, r.name)]
    added = found.added[np.isin(problem.record, records)]
    return float((added[-1] - added[0]) * problem.scale)


def _with_jump(e: VerdictEvidence, weights: Weights, of_held_out: Mask) -> VerdictEvidence:
    """Evidence with what a jump leaves of the errors of held-out readings in blocks left out, over what nothing does.

    These are readings of another part of the record than the model was fitted to.
    """
    jump = Part("effect", JUMP)
    if jump not in e.causes:
        return e
    single = next(h for h in weights.hypotheses if h.parts == (jump,))
    before, after = (root_mean_square(fitted(h).error[of_held_out]) for h in (weights.hypotheses[0], single))
    ratio = after / before
    refuted = e.not_borne_out | ({jump} if _leaves_more(ratio) else set())
    return replace(e, held_out={**e.held_out, jump: ratio}, not_borne_out=refuted)


def drifting(e: VerdictEvidence) -> VerdictEvidence:
    """Evidence between runs in which an offset is confounded with drifts, where one is likely within the runs."""
    offset, drifts = Part("effect", OFFSET), [p for p in e.causes if p.name in DRIFTS]
    if min(e.any_of([offset]), e.any_of(drifts)) < RULES["nothing"].value:
        return e
    rivals = [offset, *drifts]
    others = {p: (*e.confounded.get(p, ()), *(q for q in rivals if q != p)) for p in rivals}
    return replace(e, confounded={**e.confounded, **others})


def _held_out_is_off(base: KeptAddition) -> bool:
    """Whether the plain model predicts the held-out runs worse than its own blocks, and than noise would."""
    if base.problem.train.all():
        return False
    least = max(RULES["worse"].value * base.misfit, RULES["adequate"].value * base.noise)
    return root_mean_square(base.held_out_error()) > least


def _effects(verdict: Verdict, weights: Weights) -> tuple[MeasurementEffect, ...]:
    """The effects of the verdict's names in the heaviest hypothesis that holds them."""
    names = set(verdict.names if verdict.word == "named" else verdict.names[:1])
    holders = [
        (w, fitted(h).candidate.effects)
        for h, w in zip(weights.hypotheses, weights.weight.tolist())
        if names <= {p.name for p in h.parts}
    ]
    heaviest = max(holders, key=lambda pair: pair[0], default=(0.0, ()))[1]
    return tuple(e for e in heaviest if e.kind.name in names)


def _offsets(weights: Weights, wires: Sequence[WireRecord]) -> tuple[RunOffset, ...]:
    single = next((h for h in weights.hypotheses if h.name == OFFSET), None)
    if single is None or weights.causes[single.parts[0]] < RULES["name"].value:
        return ()
    plain, found = fitted(weights.hypotheses[0]), fitted(single)
    scale, names = abs(found.problem.scale), [r.name for r in found.problem.records]
    held_out, offsets = {w.record.name for w in wires if w.held_out.all()}, []
    for name, value in single.best.parameters.items():
        at = found.problem.record == names.index(name)
        without, with_offset = (root_mean_square(f.error[at]) * scale for f in (plain, found))
        low, high = interval(single, name, weights)
        ends = min(low, value), max(high, value)
        offsets.append(RunOffset(name, value, ends, without, with_offset, names[0], name in held_out))
    return tuple(sorted(offsets, key=lambda o: not o.held_out))
