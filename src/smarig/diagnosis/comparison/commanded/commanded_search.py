"""The hypotheses about a wire: the base, effects, dependences on a variable, and the pairs that earn it.

All effects are screened by linear traces; the best few are refined with a density of their own. A pair is tried if by
screening it gains what its prior takes.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem, FittedPlant
from smarig.diagnosis.comparison.commanded.effect_traces import Candidate
from smarig.diagnosis.comparison.commanded.effect_trials import fitted_with, refined, weaker
from smarig.diagnosis.comparison.commanded.law_trials import laws
from smarig.diagnosis.comparison.commanded.periods import with_best_period
from smarig.diagnosis.comparison.commanded.screening import Screened, candidates, collinear, screened
from smarig.diagnosis.comparison.commanded.variable_trials import Discrepancies, least_near
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part, Trial
from smarig.diagnosis.comparison.weights import PAIR_NATS
from smarig.diagnosis.looks_like import acts_through

FITTED, VARIABLES, PAIRS = 5, 4, 2  # most hypotheses of each kind that are fitted
IMITATES = 0.5  # cos² of two traces
ALWAYS = 3  # effects that are fitted, whatever their linear traces say
LINEAR_SHARE = 0.2  # of the best gain: an effect with less by linear traces stays at them
REFERENCES = 4  # densities of the best effect that priors are about, one after the other
Progress = Callable[[str], None]
FittedCause = tuple[ComparedHypothesis, FittedPlant]


@dataclass(frozen=True, eq=False)
class SearchedHypotheses:
    """The hypotheses, the models of those that were fitted, by their parts, and all effects as screened."""

    hypotheses: tuple[ComparedHypothesis, ...]
    models: dict[tuple[Part, ...], FittedPlant]
    screened: tuple[Screened, ...]


@dataclass(frozen=True, eq=False)
class _FirstFits:
    """What is known of the hypotheses under the priors of a subject before any but ``known`` is refined."""

    subject: CommandedProblem
    nothing: ComparedHypothesis
    smooth: Discrepancies
    traces: Sequence[Candidate]
    screened: Sequence[Screened]
    variables: Sequence[ComparedHypothesis]
    effects: Sequence[ComparedHypothesis]
    known: Sequence[FittedCause]
    models: dict[tuple[Part, ...], FittedPlant]

    @cached_property
    def laws(self) -> Sequence[FittedCause]:
        """The most promising variables as learned laws, the best last."""
        return laws(self.subject, self.smooth)

    @property
    def hypotheses(self) -> SearchedHypotheses:
        """Those that are known so far."""
        all_of_them = (self.nothing, *self.effects, *self.variables)
        return SearchedHypotheses(all_of_them, dict(self.models), tuple(self.screened))


def search(subject: CommandedProblem, progress: Progress) -> SearchedHypotheses:
    """All hypotheses about a subject, with priors about the base, or also about the density of the best effect or law.

    What a cause does distorts the density of the base. All hypotheses are tried with both priors: none gains by it.
    """
    first = _first_fits(subject, progress)
    found = _with_density_of_best(first)
    if found is None:
        return _completed(first, progress)
    progress("again with priors about the density of the best cause")
    other, best = found
    return _joined(first.hypotheses, _completed(_first_fits(other, progress, best, first.traces), progress))


def _first_fits(
    subject: CommandedProblem,
    progress: Progress,
    best: FittedCause | None = None,
    traces: Sequence[Candidate] | None = None,
) -> _FirstFits:
    """``best``: an effect or a law that is fitted already; nothing about its own density need show it.

    ``traces``: those about another density of the same wire, which change little with it.
    """
    base = subject.base
    nothing = ComparedHypothesis((), (subject.trial(base),))
    smooth = Discrepancies.about(subject, base)
    traces = [with_best_period(subject, c, smooth) for c in traces or candidates(subject)]
    weak = screened(subject, base, traces, smooth.ranking)
    by_variable = smooth.hypotheses(VARIABLES)
    models: dict[tuple[Part, ...], FittedPlant] = {(): base}
    shown = [(s.part,) for s in weak[:FITTED]]
    known = [best] if best and best[0].parts not in shown else []
    models |= {h.parts: model for h, model in known}
    effects = [h for h, _ in known if h.parts[-1].kind == "effect"]
    effects = _fitted_effects(subject, base, weak, by_variable, effects, models, progress, nothing.score)
    if best and not known:
        effects, known = _with_best(effects, best, models)
    return _FirstFits(subject, nothing, smooth, traces, weak, by_variable, effects, known, models)


def _with_best(
    effects: Sequence[ComparedHypothesis], best: FittedCause, models: dict[tuple[Part, ...], FittedPlant]
) -> tuple[list[ComparedHypothesis], list[FittedCause]]:
    """Effects with the trials of the best cause of a search before, and that, if it predicts better than fitted anew.

    A search that begins with the variances of nothing may end at a worse likelihood, or at a better one.
    """
    before, model = best
    own = [h for h in effects if h.parts == before.parts]  # none, if it could not be fitted anew
    others = [h for h in effects if h not in own]
    joined = replace(before, trials=tuple(t for h in (*own, before) for t in h.trials))
    if own and own[0].score >= before.score:
        return [*others, joined], []
    models[before.parts] = model
    return [*others, joined], [(joined, model)]


def _completed(first: _FirstFits, progress: Progress) -> SearchedHypotheses:
    """All hypotheses: effects refined, laws, and the pairs that earn it."""
    subject, nothing, models = first.subject, first.nothing, dict(first.models)
    effects = _refined(subject, first.effects, [h for h, _ in first.known], models, nothing.score)
    tried = {h.parts for h in effects}
    effects += [s.hypothesis for s in first.screened if (s.part,) not in tried]
    gain = max((h.score - nothing.score for h in effects), default=0.0)
    variables = [_reported(h, nothing, progress) for h in _with_laws(first, models, gain)]
    pairs = _pairs(subject, effects, models, first.traces, nothing.score, progress)
    return SearchedHypotheses((nothing, *effects, *variables, *pairs), models, tuple(first.screened))


def _with_density_of_best(first: _FirstFits) -> tuple[CommandedProblem, FittedCause] | None:
    """The subject with priors about the density of the best cause, and that; None if they predict it no better."""
    subject, nothing = first.subject, first.nothing.score
    ranked = sorted(_rivals(first), key=lambda pair: -pair[0].score)
    score = ranked[0][0].score if ranked else nothing
    if score < nothing + PAIR_NATS:
        return None
    found = None
    with suppress(np.linalg.LinAlgError):  # inputs that the cause moves too close together
        least = _least_near_best([ranked[0][0]], nothing)
        best = _best_with_own_prior(first, [pair for pair in ranked[:ALWAYS] if pair[0].score > least])
        for _ in range(REFERENCES):
            trying = (found[0] if found else subject).with_reference_from(best)
            again = trying.with_density(best.effects, best)
            tried = ComparedHypothesis(trying.parts(again), (trying.trial(again),))
            tried, again = refined(trying, tried, again)
            if tried.score < score + PAIR_NATS:
                break
            found, score, best = (trying, (tried, again)), tried.score, again
    return found


def _rivals(first: _FirstFits) -> list[FittedCause]:
    """The effects, and the laws if a variable predicts as well as any of them."""
    effects = [(h, first.models[h.parts]) for h in first.effects]
    best = max((h.score for h in first.effects), default=first.nothing.score)
    by_laws = any(h.score > best for h in first.variables)
    return [*effects, *(first.laws if by_laws else [])]


def _best_with_own_prior(first: _FirstFits, ranked: Sequence[FittedCause]) -> FittedPlant:
    """The best of some causes, effects at several strengths, each with a density that is its own prior."""
    subject, base = first.subject, first.models[()]
    fits = []
    for h, model in ranked:
        *known, last = model.effects
        others = next((s.starts for s in first.screened if (s.part,) == h.parts), ())
        fits += [subject.with_own_prior((*known, e), base) for e in (last, *others)]
    return max(fits, key=lambda fitted: subject.trial(fitted).score)


def _joined(one: SearchedHypotheses, other: SearchedHypotheses) -> SearchedHypotheses:
    """The trials of both, and of each hypothesis the model of the better."""
    trials: dict[tuple[Part, ...], tuple[Trial, ...]] = {}
    score: dict[tuple[Part, ...], float] = {}
    models: dict[tuple[Part, ...], FittedPlant] = {}
    for found in (one, other):
        for h in found.hypotheses:
            trials[h.parts] = trials.get(h.parts, ()) + h.trials
            if h.parts in found.models and (h.parts not in models or h.score > score[h.parts]):
                models[h.parts], score[h.parts] = found.models[h.parts], h.score
    hypotheses = tuple(ComparedHypothesis(parts, both) for parts, both in trials.items())
    return SearchedHypotheses(hypotheses, models, one.screened)


def _fitted_effects(
    subject: CommandedProblem,
    base: FittedPlant,
    weak: Sequence[Screened],
    by_variable: Sequence[ComparedHypothesis],
    known: Sequence[ComparedHypothesis],
    models: dict[tuple[Part, ...], FittedPlant],
    progress: Progress,
    nothing: float,
) -> list[ComparedHypothesis]:
    """The best screened effects with a density of their own, beside those that are ``known``."""
    found = list(known)

    def fit(one: Screened) -> None:
        if any(h.parts == (one.part,) for h in found):
            return
        result = fitted_with(subject, base, [*base.effects, one.effect], one.starts)
        if result is None:
            return
        result = weaker(subject, base, result, one.trial.score)
        hypothesis, models[result[0].parts] = result
        found.append(hypothesis)
        progress(f"{hypothesis.name}: {hypothesis.score - nothing:+.1f} nats on blocks left out")

    for one in weak[:FITTED]:
        best = max([h.score for h in found], default=nothing)
        if len(found) < ALWAYS or one.promise >= nothing + LINEAR_SHARE * (best - nothing):
            fit(one)
    for one in sorted(weak, key=lambda s: -s.trial.score):  # a variable may imitate it in the ranking
        if one.trial.score <= max([h.score for h in found], default=nothing):
            break
        fit(one)
    for one in [*_imitating(found, weak, nothing), *_through_likely(by_variable, found, weak, nothing)]:
        fit(one)
    return found


def _refined(
    subject: CommandedProblem,
    found: Sequence[ComparedHypothesis],
    known: Sequence[ComparedHypothesis],
    models: dict[tuple[Part, ...], FittedPlant],
    nothing: float,
) -> list[ComparedHypothesis]:
    """Effects, those near the best with trials of their parameters; ``known`` have them."""
    least = _least_near_best(found, nothing)
    return [_refined_one(subject, h, models) if h.score > least and h not in known else h for h in found]


def _least_near_best(found: Sequence[ComparedHypothesis], nothing: float) -> float:
    """The score below which better parameters, or a better prior, would make no effect the best."""
    best = max([h.score for h in found], default=nothing)
    return nothing + max(PAIR_NATS, least_near(best - nothing))


def _imitating(
    found: Sequence[ComparedHypothesis], weak: Sequence[Screened], nothing: float
) -> list[Screened]:
    """The effects not yet fitted that explain most of what the best does: a density of their own may decide."""
    best = max(found, key=lambda h: h.score, default=None)
    if best is None or best.score <= nothing:
        return []
    fitted = {h.parts for h in found}
    top = next(s for s in weak if (s.part,) == best.parts)
    return [s for s in weak if (s.part,) not in fitted and collinear(top, s) > IMITATES]


def _through_likely(
    by_variable: Sequence[ComparedHypothesis],
    found: Sequence[ComparedHypothesis],
    weak: Sequence[Screened],
    nothing: float,
) -> list[Screened]:
    """The effects that act through a variable which predicts as well as any effect."""
    least = max([h.score for h in found], default=nothing) - PAIR_NATS
    likely = {p.name for h in by_variable for p in h.parts if h.score > max(nothing + PAIR_NATS, least)}
    return [s for s in weak if likely.intersection(acts_through(s.part.name))]


def _refined_one(
    subject: CommandedProblem, hypothesis: ComparedHypothesis, models: dict[tuple[Part, ...], FittedPlant]
) -> ComparedHypothesis:
    again, models[hypothesis.parts] = refined(subject, hypothesis, models[hypothesis.parts])
    return again


def _with_laws(
    first: _FirstFits, models: dict[tuple[Part, ...], FittedPlant], gain: float
) -> list[ComparedHypothesis]:
    """The most promising variables by their kernels, the best of them by a learned law as well.

    A law is fitted unless no kernel gains a share of the ``gain`` in nats of the best effect.
    """
    by_parts = {h.parts: h for h in first.variables}
    best = max((h.score - first.nothing.score for h in by_parts.values()), default=0.0)
    fitted = [pair for pair in first.known if pair[0].parts[-1].kind == "variable"]
    fitted += first.laws if best > max(LINEAR_SHARE * gain, PAIR_NATS) else []
    for by_law, models[by_law.parts] in sorted(fitted, key=lambda pair: pair[0].score):
        own = by_parts.get(by_law.parts)
        joined = by_law if own is None else replace(own, trials=(*own.trials, *by_law.trials))
        by_parts[by_law.parts] = joined
    return list(by_parts.values())


def _pairs(
    subject: CommandedProblem,
    effects: Sequence[ComparedHypothesis],
    models: dict[tuple[Part, ...], FittedPlant],
    traces: Sequence,
    nothing: float,
    progress: Progress,
) -> list[ComparedHypothesis]:
    """The best effect, if it predicts better than nothing, with further effects and with variables."""
    best = max((h for h in effects if h.parts in models), key=lambda t: t.score, default=None)
    if best is None or best.score < nothing + PAIR_NATS:
        return []
    fitted, floor = models[best.parts], best.score
    smooth = Discrepancies.about(subject, fitted)
    found = []
    for one in screened(subject, fitted, traces, smooth.ranking)[:PAIRS]:
        promising = one.promise > floor + PAIR_NATS
        result = (
            fitted_with(subject, fitted, [*fitted.effects, one.effect], one.starts) if promising else None
        )
        if result is not None:
            hypothesis, models[result[0].parts] = result
            found.append(_reported(hypothesis, best, progress))
    better = [h for h in found if h.score > floor + PAIR_NATS]
    if better:
        top = max(better, key=lambda t: t.score)
        found[found.index(top)] = _refined_one(subject, top, models)
    return found + _left_by(best, smooth, progress) + _left_by_pair(subject, found, models, floor, progress)


def _left_by(best: ComparedHypothesis, smooth: Discrepancies, progress: Progress) -> list[ComparedHypothesis]:
    """Effects with a dependence on a variable beside them: what they leave."""
    chosen = [v for v in smooth.variables[:PAIRS] if smooth.gain(v) > PAIR_NATS]
    return [_reported(smooth.hypothesis(v), best, progress) for v in chosen]


def _left_by_pair(
    subject: CommandedProblem,
    pairs: Sequence[ComparedHypothesis],
    models: dict[tuple[Part, ...], FittedPlant],
    floor: float,
    progress: Progress,
) -> list[ComparedHypothesis]:
    """The same of the best pair of effects: else two wrong effects would win for want of a competitor."""
    best = max(pairs, key=lambda t: t.score, default=None)
    if best is None or best.score < floor + PAIR_NATS:
        return []
    return _left_by(best, Discrepancies.about(subject, models[best.parts]), progress)


def _reported(
    hypothesis: ComparedHypothesis, before: ComparedHypothesis, progress: Progress
) -> ComparedHypothesis:
    progress(f"{hypothesis.name}: {hypothesis.score - before.score:+.1f} nats beyond {before.name}")
    return hypothesis
