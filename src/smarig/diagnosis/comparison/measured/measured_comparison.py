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

from smarig.core import DataError
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part
from smarig.diagnosis.comparison.measured.additions import FittedAddition, first_basis
from smarig.diagnosis.comparison.measured.hypothesis_search import searched_hypotheses
from smarig.diagnosis.comparison.measured.intervals import interval
from smarig.diagnosis.comparison.measured.missing_knowledge import missing_share
from smarig.diagnosis.comparison.measured.reading_problem import ReadingProblem, reading_problem
from smarig.diagnosis.comparison.measured.varied_together import confounded
from smarig.diagnosis.comparison.measured.wire_records import WireRecord, wire_records
from smarig.diagnosis.comparison.rules import RULES, Verdict, VerdictEvidence, decide
from smarig.diagnosis.comparison.weights import TEMPERATURE, Weights, weigh
from smarig.measurement import measurement_effect_types
from smarig.record import Run

Array = NDArray[np.float64]
BASE_STEPS = 30
TRIMMED = 0.1  # of the blocks, those that gain most: one block is no measure of a size
OF_EACH_RUN = ("input_offset", "run")  # of a held-out run they say nothing
BETWEEN_RUNS = ("input_offset", "stress_shift", "run", "stress")


@dataclass(frozen=True, eq=False)
class MeasuredComparison:
    """The verdict on runs with a measured input, and what it is decided from; errors are in the output's unit.

    ``causes``: probability by part. ``parameters``: value and 95 % interval, by part and name, of its heaviest
    hypothesis. ``base_error`` and ``extended_error`` of blocks left out; ``held_out``: error by name of a hypothesis.
    ``missing``: share of the held-out square error that lies where training determines nothing. ``between``: the
    weights of causes between runs, with the held-out runs as blocks.
    """

    verdict: Verdict
    weights: Weights
    causes: Mapping[Part, float]
    parameters: Mapping[str, Mapping[str, tuple[float, float, float]]]
    base_error: float
    extended_error: float
    held_out: Mapping[str, float]
    noise: float
    missing: float
    excursions: int
    between: Weights | None
    seconds: float


def compare_measured(
    train_runs: Sequence[Run],
    held_out_runs: Sequence[Run] = (),
    without: Sequence[str] = (),
    progress: Callable[[str], None] = lambda _: None,
) -> MeasuredComparison:
    """Compare what may be wrong with a plain model of runs; ``without``: names of effects that are not asked for.

    Raises DataError if the runs hold too few readings.
    """
    started = time.monotonic()
    wires = wire_records(train_runs, held_out_runs)
    if not any((~w.held_out).any() for w in wires):
        raise DataError("The training runs contain no reading in which input and output are known.")
    problem = reading_problem(wires)
    basis, base = first_basis(problem, BASE_STEPS)
    missing = 0.0 if problem.train.all() else missing_share(base)
    if missing < RULES["not_determined"].value:
        problem = problem.with_unseen()
        basis, base = replace(basis, problem=problem), replace(base, problem=problem)
    weights = _weighed(problem, searched_hypotheses(basis, base, progress, without=without))
    held = _held_out_errors(base, weights)
    verdict = decide(_evidence(problem, base, weights, held))
    between = None
    if held and verdict.word in ("silent", "unknown"):
        verdict, between = _with_held_out_runs(wires, verdict, base, missing, without)
    best = _fitted(weights.heaviest)
    scale = abs(problem.scale)
    return MeasuredComparison(
        verdict=verdict,
        weights=weights,
        causes=weights.causes,
        parameters=_parameters(weights),
        base_error=base.fit.rms * scale,
        extended_error=best.fit.rms * scale,
        held_out={name: error * scale for name, error in held.items()},
        noise=min(base.fit.noise, best.fit.noise) * scale,
        missing=missing,
        excursions=problem.excursions,
        between=between,
        seconds=time.monotonic() - started,
    )


def _weighed(problem: ReadingProblem, hypotheses: Sequence[ComparedHypothesis]) -> Weights:
    """The weights; the segments of a branch count as one, for their errors are not independent."""
    cut = problem.counts.size / max(2 * problem.independent, 1)
    return weigh(hypotheses, temperature=TEMPERATURE * max(cut, 1.0))


def _fitted(hypothesis: ComparedHypothesis) -> FittedAddition:
    return hypothesis.best.state


def _held_out_errors(base: FittedAddition, weights: Weights) -> dict[str, float]:
    """The error on held-out readings of the plain model, of the heaviest hypothesis, and with each cause."""
    if base.problem.train.all():
        return {}
    relevant = {weights.heaviest.name: weights.heaviest}
    relevant |= {h.name: h for h in (weights.best_with(p) for p, w in weights.causes.items() if w > 0.01)}
    found = {"nothing": _rms(base.held_out_error())}
    return found | {n: _rms(_fitted(h).held_out_error()) for n, h in relevant.items() if h.parts}


def _evidence(
    problem: ReadingProblem, base: FittedAddition, weights: Weights, held: Mapping[str, float]
) -> VerdictEvidence:
    sizes, ratios = {}, {}
    for part in weights.causes:
        best = weights.best_with(part)
        alone = next(h for h in weights.hypotheses if h.parts == (part,))
        sizes[part] = max(_removed(problem, _without(weights, h, part), h) for h in (best, alone))
        if best.parts == (part,):
            sizes[part] = max(sizes[part], float(np.std(_fitted(best).added[problem.train])))
        if part.name in OF_EACH_RUN:
            continue
        if best.name in held:
            ratios[part] = held[best.name] / max(held["nothing"], base.fit.noise)
        elif not held and part.name in BETWEEN_RUNS:
            ratios[part] = _fitted(best).run_error / base.run_error
    return VerdictEvidence(
        causes=weights.causes,
        nothing=weights.nothing,
        size=sizes,
        span=1.0,
        error=base.misfit,
        noise=base.fit.noise,
        block_error=float(np.sqrt(_fitted(weights.heaviest).fit.sizes[-2])),
        blocks=problem.independent,
        confounded=confounded(problem, weights.causes),
        held_out=ratios,
        acts_through={p: _acts_through(p) for p in weights.causes},
        testable=len(weights.hypotheses) > 1,
    )


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
    base: FittedAddition,
    missing: float,
    without: Sequence[str],
) -> tuple[Verdict, Weights | None]:
    """The verdict with the held-out runs as blocks, if the plain model predicts them worse than its own blocks."""
    runs = [w.held_out.all() for w in wires]
    error = _rms(base.held_out_error())
    if not any(runs) or error <= max(
        RULES["worse"].value * base.misfit, RULES["adequate"].value * base.fit.noise
    ):
        return verdict, None
    if missing >= RULES["not_determined"].value:
        return verdict, None
    problem = reading_problem([replace(w, held_out=np.zeros_like(w.held_out)) for w in wires])
    basis, plain = first_basis(problem, BASE_STEPS)
    weights = _weighed(problem, searched_hypotheses(basis, plain, lambda _: None, BETWEEN_RUNS, without))
    found = decide(_evidence(problem, plain, weights, {}))
    clearer = found.word in ("named", "ambiguous") or found.depends_on is not None
    return (found if clearer and verdict.depends_on in (None, *BETWEEN_RUNS) else verdict), weights


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))
