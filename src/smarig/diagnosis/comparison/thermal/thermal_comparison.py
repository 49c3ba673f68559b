"""The comparison of hypotheses about a thermal record: which one predicts blocks that it has not seen.

compare_thermal(record).verdict
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part
from smarig.diagnosis.comparison.intervals import interval
from smarig.diagnosis.comparison.thermal.balance_fit import fit_balance
from smarig.diagnosis.comparison.thermal.thermal_additions import FittedThermalAddition, first_basis
from smarig.diagnosis.comparison.thermal.thermal_effects import EFFECTS
from smarig.diagnosis.comparison.thermal.thermal_problem import ThermalProblem, thermal_problem
from smarig.diagnosis.comparison.thermal.thermal_record import ThermalRecord
from smarig.diagnosis.comparison.thermal.thermal_search import Progress, searched_hypotheses
from smarig.diagnosis.comparison.verdict_rules import Verdict, VerdictEvidence, decide
from smarig.diagnosis.comparison.weights import TEMPERATURE, Weights, weigh

Interval = tuple[float, float]
BASE_STEPS = 60
TRIMMED = 0.1  # of the blocks, those that gain most: one block is no measure of a size


@dataclass(frozen=True, eq=False)
class ThermalComparison:
    """The verdict on a thermal record, and what it is decided from.

    ``base`` is the fit of the plain balance, ``extended`` that of the verdict's names: of all if they are named, else
    of the likeliest of those that compete. ``intervals`` are 95 % intervals of searched parameters by effect and name.
    """

    verdict: Verdict
    evidence: VerdictEvidence
    weights: Weights
    problem: ThermalProblem
    base: FittedThermalAddition
    extended: FittedThermalAddition
    intervals: Mapping[str, Mapping[str, Interval]]


def compare_thermal(
    x: ThermalRecord, without: Sequence[str] = (), seed: int = 0, progress: Progress = lambda _: None
) -> ThermalComparison:
    """Compare what may be wrong with a plain heat balance; ``without`` are names of effects that are not tested for."""
    problem = thermal_problem(x, fit_balance(x, {}))
    basis, base = first_basis(problem, BASE_STEPS)
    hypotheses = searched_hypotheses(basis, base, progress, without)
    # the parts of a transient count as one, for their errors are not independent
    parts = problem.counts.size / problem.transients
    weights = weigh(hypotheses, seed, TEMPERATURE * max(parts, 1.0))
    evidence = _evidence(problem, base, weights)
    verdict = decide(evidence)
    return ThermalComparison(
        verdict=verdict,
        evidence=evidence,
        weights=weights,
        problem=problem,
        base=base,
        extended=_extended(weights, verdict, base),
        intervals=_intervals(weights),
    )


def _evidence(problem: ThermalProblem, base: FittedThermalAddition, weights: Weights) -> VerdictEvidence:
    heaviest: FittedThermalAddition = weights.heaviest.best.state
    return VerdictEvidence(
        causes=weights.causes,
        nothing=weights.nothing,
        size={part: _size(problem, weights, part) for part in weights.causes},
        span=1.0,
        error=base.balance.rms / problem.record.span,
        noise=min(base.noise, heaviest.noise),
        remains=dict.fromkeys(weights.causes, heaviest.block_error),
        blocks=problem.transients,
        acts_through={Part("effect", e.name): (Part("variable", e.acts_through),) for e in EFFECTS},
        testable=len(weights.hypotheses) > 1,
    )


def _size(problem: ThermalProblem, weights: Weights, part: Part) -> float:
    """What a part removes of the left-out error, or alone changes of the trace, in ranges; the larger, for blocks that
    are extrapolated have large errors with any hypothesis.

    A variable beside an effect describes what that leaves; an effect may stand alone.
    """
    shown, alone = [weights.best_with(part)], next(h for h in weights.hypotheses if h.parts == (part,))
    if part.kind == "effect":
        shown.append(alone)
    sizes = [_removed(problem.counts, _without(weights, h, part), h) for h in shown]
    if alone in shown:
        sizes.append(_changed(_without(weights, alone, part), alone))
    return max(sizes)


def _changed(start: ComparedHypothesis, hypothesis: ComparedHypothesis) -> float:
    """Root mean square of what a hypothesis changes of the trace of another."""
    before, after = (h.best.state.trace for h in (start, hypothesis))
    return root_mean_square(after - before)


def _without(weights: Weights, hypothesis: ComparedHypothesis, part: Part) -> ComparedHypothesis:
    rest = {p for p in hypothesis.parts if p != part}
    return next(h for h in weights.hypotheses if set(h.parts) == rest)


def _removed(counts: Array, start: ComparedHypothesis, hypothesis: ComparedHypothesis) -> float:
    """Root of the mean square that a hypothesis removes of the error of another, without the blocks that gain most."""
    gain = start.best.squares - hypothesis.best.squares
    kept = np.argsort(-gain / counts)[int(TRIMMED * counts.size) :]
    return float(np.sqrt(max(gain[kept].sum() / counts[kept].sum(), 0.0)))


def _extended(weights: Weights, verdict: Verdict, base: FittedThermalAddition) -> FittedThermalAddition:
    """The hypothesis of the verdict's names: of all if they are named, else of the likeliest."""
    wanted = set(verdict.names if verdict.word == "named" else verdict.names[:1])
    exact = [h for h in weights.hypotheses if {p.name for p in h.parts} == wanted]
    return exact[0].best.state if wanted and exact else base


def _intervals(weights: Weights) -> dict[str, dict[str, Interval]]:
    """Of each parameter of each effect, from the trials of the effect alone."""
    found: dict[str, dict[str, Interval]] = {}
    for hypothesis in weights.hypotheses:
        if len(hypothesis.parts) == 1 and hypothesis.parts[0].kind == "effect":
            names = hypothesis.best.parameters
            found[hypothesis.name] = {n: interval(hypothesis, n, weights) for n in names}
    return found
