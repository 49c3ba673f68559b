"""The search for hypotheses: nothing, each effect, each variable, and pairs with the best effect and the best variable.

Values of an effect are first ranked with the sizes of the plain model, one factorisation each; the sizes are fitted at
the best of them, and between them.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part, Trial
from smarig.diagnosis.comparison.measured.acting_effects import Tries, testable_effects
from smarig.diagnosis.comparison.measured.additions import Addition, KeptAddition, SearchBasis
from smarig.diagnosis.comparison.measured.plain_variables import testable_variables
from smarig.measurement import (
    LearnedTerm,
    MeasurementEffect,
    MeasurementEffectType,
    measurement_effect_types,
)

FIT_STEPS = 12  # iterations of the sizes
KEPT = 3  # values of a parameter whose sizes are fitted
PASSES = 3  # over several parameters, which depend on each other
CLOSE = 1e-3  # relative: two values are one
FINE = 31  # values of a sudden parameter between two tries
ROUNDS = 2  # of values half way to the neighbours of the best
WORTH_A_PAIR = 2.0  # nats that the best part must gain, before pairs are tried
Progress = Callable[[str], None]
Values = tuple[float, ...]
Fit = Callable[[MeasurementEffect, KeptAddition | None], Trial]
LawOf = Callable[[str], LearnedTerm | None]


@dataclass(frozen=True, eq=False)
class Search:
    """A search in a basis, for candidates that extend ``start``; effects that score below ``least`` stay rough."""

    basis: SearchBasis
    start: Addition
    progress: Progress = lambda _: None
    least: float = -np.inf

    def with_law(self, hypothesis: ComparedHypothesis, law: LearnedTerm) -> ComparedHypothesis:
        """The hypothesis of a variable with one more trial, in which the law moves the input."""
        (name,) = (p.name for p in hypothesis.parts)
        trial = self.basis.fitted(Addition(variables=(name,), laws=(law,)), FIT_STEPS).trial()
        again = (trial, *self._again(trial))
        return _slim(replace(hypothesis, trials=(*hypothesis.trials, *again)))

    def variable(self, name: str) -> ComparedHypothesis:
        """The hypothesis that adds a variable."""
        candidate = replace(self.start, variables=(*self.start.variables, name))
        trial = self.basis.fitted(candidate, FIT_STEPS).trial()
        self.progress(name)
        return _slim(ComparedHypothesis(candidate.parts, (trial, *self._again(trial))))

    def effect(self, kind: MeasurementEffectType, tries: Tries) -> ComparedHypothesis:
        """The hypothesis that adds an effect, with the trials of its values.

        The density of the plain model contains the errors that an effect explains, so its values are also tried with
        the density that it leaves; the series with the better best one is kept, for the two cannot be compared value by
        value.
        """
        ranks: dict[Values, float] = {}
        trials = self._series(kind, tries, self._in_this_basis, ranks)
        best = _best(trials)
        if not self.start.parts:  # pairs already stand in the basis of their first part
            if kind.additive or best.score <= self.least:
                trials += self._again(best)
            else:
                own = self._series(kind, tries, self._in_its_own_basis, ranks)
                trials = max(trials, own, key=lambda series: _best(series).score)
            best = _best(trials)
        self.progress(f"{kind.name}: " + ", ".join(f"{v:.3g}" for v in best.parameters.values()))
        return _slim(ComparedHypothesis(best.state.candidate.parts, tuple(trials)))

    def likeliest(self, kind: MeasurementEffectType, alternatives: Sequence[Tries]) -> Tries:
        """Of alternative parameters, those with the best first score."""
        if len(alternatives) == 1:
            return alternatives[0]

        def first(tries: Tries) -> float:
            return max(self._score(kind(**{name: x})) for name, options in tries.items() for x in options)

        return max(alternatives, key=first)

    def _series(
        self, kind: MeasurementEffectType, tries: Tries, fit: Fit, ranks: dict[Values, float]
    ) -> list[Trial]:
        """Trials of the values of an effect, one parameter after the other; ``ranks`` keeps first scores."""
        values = self._reference(kind) | {name: _neutral(t) for name, t in tries.items()}
        trials: dict[Values, Trial] = {}

        def rank(v: dict[str, float]) -> float:
            key = tuple(v.values())
            if key not in ranks:
                ranks[key] = self._score(kind(**v))
            return ranks[key]

        def fitted(v: dict[str, float]) -> float:
            key = tuple(v.values())
            if key not in trials:
                near = _best(trials.values()).state if trials else None
                trials[key] = fit(kind(**v), near)
            return trials[key].score

        kept, rounds = (1, 0) if self.start.parts else (KEPT, ROUNDS)
        passes = PASSES if len(tries) > 1 and not self.start.parts else 1
        for name, options in passes * list(tries.items()):
            best_first = sorted(options, key=lambda x, n=name: -rank(values | {n: x}))
            if any(p.sudden for p in kind.parameters(self.basis.problem.records) or ()):
                best_first = self._ranked_again(kind, name, best_first, values)
            scores = {x: fitted(values | {name: x}) for x in best_first[:kept]}
            if max(scores.values()) > self.least:
                for _ in range(rounds):
                    for x in _between(sorted({*options, *scores}), max(scores, key=lambda x: scores[x])):
                        scores[x] = fitted(values | {name: x})
                top = vertex(scores) if rounds else None
                if top is not None and min(abs(top - x) for x in scores) > CLOSE * abs(top):
                    scores[top] = fitted(values | {name: top})
            values[name] = max(scores, key=lambda x: scores[x])
        return list(trials.values())

    def _in_this_basis(self, effect: MeasurementEffect, near: KeptAddition | None) -> Trial:
        return self.basis.fitted(self.start.with_effect(effect), FIT_STEPS, near=near).trial()

    def _in_its_own_basis(self, effect: MeasurementEffect, near: KeptAddition | None) -> Trial:
        """An effect with the density and slopes that it leaves."""
        fitted = self.basis.fitted(self.start.with_effect(effect), FIT_STEPS, near=near).kept()
        own = self.basis.of(fitted)
        return own.fitted(fitted.candidate, FIT_STEPS, same_input=True, near=fitted).trial()

    def _ranked_again(
        self, kind: MeasurementEffectType, name: str, options: Sequence[float], values: dict[str, float]
    ) -> list[float]:
        """Values around the best option, best first, with the smaller errors that the model has there."""
        first = self.basis.fitted(self.start.with_effect(kind(**(values | {name: options[0]}))), FIT_STEPS)
        search = replace(self, basis=self.basis.of(first.kept()))
        return sorted(
            _around(options[0], options), key=lambda x: -search._score(kind(**(values | {name: x})))
        )

    def _score(self, effect: MeasurementEffect) -> float:
        """With the sizes of the basis."""
        return self.basis.fitted(self.start.with_effect(effect), 0).score

    def _again(self, trial: Trial) -> list[Trial]:
        """A candidate once more, in its own basis; pairs already stand in that of their first part."""
        if self.start.parts:
            return []
        basis = self.basis.of(trial.state)
        return [basis.fitted(trial.state.candidate, FIT_STEPS, same_input=True).trial()]

    def _reference(self, kind: MeasurementEffectType) -> dict[str, float]:
        if not kind.by_condition:
            return {}
        return {"reference": self.basis.problem.records[0].conditions[kind.by_condition]}


def _best(trials: Iterable[Trial]) -> Trial:
    return max(trials, key=lambda t: t.score)


def _slim(hypothesis: ComparedHypothesis) -> ComparedHypothesis:
    """The fit of the best trial only."""
    best = hypothesis.best
    return replace(
        hypothesis, trials=tuple(t if t is best else replace(t, state=None) for t in hypothesis.trials)
    )


def _around(best: float, options: Sequence[float]) -> list[float]:
    """Values between the neighbours of the best option; a value that is an option but for rounding is that option: two
    trials of one value have no slope between them.
    """
    k, ordered = sorted(options).index(best), sorted(options)
    fine = np.linspace(ordered[max(k - 1, 0)], ordered[min(k + 1, len(ordered) - 1)], FINE).tolist()
    return [next((x for x in ordered if np.isclose(x, value, rtol=1e-9, atol=0.0)), value) for value in fine]


def vertex(scores: dict[float, float]) -> float | None:
    """The top of the parabola through the best value and its neighbours, on a logarithmic scale where all have one
    sign; None at an end of the values.

    >>> vertex({1.0: -1.0, 2.0: 0.0, 3.0: -1.0}) is not None, vertex({1.0: 0.0, 2.0: -1.0})
    (True, None)
    """
    values = sorted(scores)
    k = values.index(max(scores, key=lambda x: scores[x]))
    if not 0 < k < len(values) - 1:
        return None
    near = values[k - 1 : k + 2]
    logarithmic = near[0] * near[-1] > 0
    sign = np.sign(near[1]) if logarithmic else 1.0
    a, b, c = np.log(np.abs(near)) if logarithmic else near
    low, top, high = (scores[v] for v in near)
    left, right = (top - low) / (b - a), (high - top) / (c - b)  # slopes on both sides
    if left <= right:
        return None
    at = 0.5 * (a + b) + 0.5 * (c - a) * left / (left - right)
    return float(sign * np.exp(at)) if logarithmic else float(at)


def _neutral(tries: Sequence[float]) -> float:
    return 0.0 if 0.0 in tries else tries[len(tries) // 2]


def _between(values: Sequence[float], best: float) -> list[float]:
    """Half way from the best value to its neighbours, on a logarithmic scale where all have one sign."""
    k = values.index(best)
    near = [values[n] for n in (k - 1, k + 1) if 0 <= n < len(values)]
    return [float(np.sign(x) * np.sqrt(x * best)) if x * best > 0 else 0.5 * (x + best) for x in near]


def searched_hypotheses(
    basis: SearchBasis,
    base: Trial,
    progress: Progress,
    only: Iterable[str] | None = None,
    without: Sequence[str] = (),
    law_of: LawOf = lambda _: None,
) -> list[ComparedHypothesis]:
    """All hypotheses; ``base`` is the plain model, ``only`` and ``without`` are names of effects and variables.

    ``law_of`` gives the law of a variable, or None.
    """
    effects = [(k, t) for k, t in testable_effects(basis.problem) if _wanted(k.name, only, without)]
    variables = [v for v in testable_variables(basis.problem) if _wanted(v, only, without)]
    nothing = ComparedHypothesis((), (base,))
    search, found = Search(basis, Addition(), progress, nothing.score), [nothing]
    effects = [
        (kind, search.likeliest(kind, [t for k, t in effects if k is kind])) for kind in _kinds(effects)
    ]
    found += [search.effect(k, t) for k, t in effects]
    found += _with_laws(search, [search.variable(v) for v in variables], found, law_of)
    return [*found, *_pairs(basis, found, effects, variables, progress)]


def _with_laws(
    search: Search, variables: list[ComparedHypothesis], others: list[ComparedHypothesis], law_of: LawOf
) -> list[ComparedHypothesis]:
    """The hypotheses of variables; those that predict better than all others also with a law that moves the input, for
    to first order a large shift is described badly. So are those that the best effect acts through: it would win for
    being exact.
    """
    nothing, best = others[0].score, max(others, key=lambda h: h.score)
    least = best.score + WORTH_A_PAIR
    rivals = _acts_through(best) if best.score > nothing + WORTH_A_PAIR else ()
    found = []
    for hypothesis in variables:
        name = hypothesis.parts[0].name
        law = law_of(name) if hypothesis.score > least or name in rivals else None
        moves = law is not None and law.enters == "input"
        found.append(search.with_law(hypothesis, law) if law is not None and moves else hypothesis)
    return found


def _acts_through(hypothesis: ComparedHypothesis) -> tuple[str, ...]:
    """The variables of the effects of a hypothesis."""
    names = {p.name for p in hypothesis.parts}
    return tuple(v for k in measurement_effect_types() if k.name in names for v in k.depends_on)


def _kinds(effects: Sequence[tuple[MeasurementEffectType, Tries]]) -> list[MeasurementEffectType]:
    return [k for n, (k, _) in enumerate(effects) if all(k is not other for other, _ in effects[:n])]


def _wanted(name: str, only: Iterable[str] | None, without: Sequence[str]) -> bool:
    return name not in without and (only is None or name in only)


def _pairs(
    basis: SearchBasis,
    singles: Sequence[ComparedHypothesis],
    effects: Sequence[tuple[MeasurementEffectType, Tries]],
    variables: Sequence[str],
    progress: Progress,
) -> list[ComparedHypothesis]:
    """The best effect, and the best variable, each with every other part."""
    found: list[ComparedHypothesis] = []
    nothing = singles[0].score
    for kind in ("effect", "variable"):
        own = [h for h in singles if h.parts and h.parts[0].kind == kind]
        best = max(own, key=lambda h: h.score, default=None)
        if best is None or best.score < nothing + WORTH_A_PAIR:
            continue
        search = _extending(basis, best, progress)
        known = {frozenset(h.parts) for h in found}
        for other, tries in effects:
            part = Part("effect", other.name)
            if part in best.parts or frozenset((part, *best.parts)) in known:
                continue
            found.append(
                search.effect(other, _narrowed(tries, next(h for h in singles if h.parts == (part,))))
            )
        for name in variables if kind == "effect" else ():
            found.append(search.variable(name))
    return found


def _extending(basis: SearchBasis, best: ComparedHypothesis, progress: Progress) -> Search:
    fitted: KeptAddition = best.best.state
    return Search(basis.of(fitted), fitted.candidate, progress)


def _narrowed(tries: Tries, single: ComparedHypothesis) -> Tries:
    """The best value of a single effect and its neighbours in the first tries."""
    found: Tries = {}
    for name, options in tries.items():
        best = single.best.parameters[name]
        near = sorted({*options, best})
        k = near.index(best)
        found[name] = tuple(near[max(k - 1, 0) : k + 2])
    return found
