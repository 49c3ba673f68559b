"""The search for hypotheses about a thermal record: nothing, each effect, each variable, and pairs with the best.

The values of an effect begin with those of the smallest error. They are tried one parameter after the other, then
between the best and its neighbours.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part, Trial
from smarig.diagnosis.comparison.measured.hypothesis_search import vertex
from smarig.diagnosis.comparison.thermal.balance_fit import fit_with_effect
from smarig.diagnosis.comparison.thermal.thermal_additions import (
    FittedThermalAddition,
    ThermalAddition,
    ThermalBasis,
    testable_variables,
)
from smarig.diagnosis.comparison.thermal.thermal_effects import ThermalEffect, Tries, testable_effects

FIT_STEPS = 40  # iterations of the sizes
PASSES = 2  # over several parameters, which depend on each other
ROUNDS = 2  # of values half way to the neighbours of the best
CLOSE = 1e-3  # relative: two values are one
NEAR = 0.05  # of the step to the next option: values that hardly differ
WORTH_A_PAIR = 2.0  # nats that the best part must gain, before pairs are tried
Progress = Callable[[str], None]
Values = dict[str, float]


@dataclass(frozen=True, eq=False)
class ThermalSearch:
    """A search in a basis, for candidates that extend ``start``."""

    basis: ThermalBasis
    start: ThermalAddition
    progress: Progress

    def variable(self, name: str) -> ComparedHypothesis:
        """The hypothesis that adds a variable."""
        candidate = replace(self.start, variables=(*self.start.variables, name))
        fitted = self.basis.fitted(candidate, FIT_STEPS)
        self.progress(f"{name}: {fitted.trial().score:.1f} nats")
        return ComparedHypothesis(candidate.parts, (fitted.trial(),))

    def effect(self, effect: ThermalEffect, tries: Tries) -> ComparedHypothesis:
        """The hypothesis that adds an effect, with the trials of its values."""
        trials: dict[tuple[float, ...], Trial] = {}
        fitted = fit_with_effect(self.basis.problem.record, self.basis.balance.balance, tries)
        values = {name: _at_end(float(getattr(fitted, name)), options) for name, options in tries.items()}

        def score(v: Values) -> float:
            key = tuple(v.values())
            if not any(key):  # the plain balance again
                return -float("inf")
            if key not in trials:
                best = max(trials.values(), key=lambda t: t.score, default=None)
                trials[key] = self._trial(effect, v, best.state if best else None)
            return trials[key].score

        passes, rounds = (1, 0) if self.start.parts else (PASSES, ROUNDS)
        for _ in range(passes if len(tries) > 1 else 1):
            for name, options in tries.items():
                options = _with_value(options, values[name])
                values[name] = _best_value(lambda x, n=name: score(values | {n: x}), options, rounds)
        hypothesis = ComparedHypothesis(self._with(effect, values).parts, tuple(trials.values()))
        best = ", ".join(f"{n} {v:.3g}" for n, v in hypothesis.best.parameters.items())
        self.progress(f"{hypothesis.name}: {hypothesis.score:.1f} nats ({best})")
        return hypothesis

    def _with(self, effect: ThermalEffect, values: Values) -> ThermalAddition:
        return replace(self.start, effects={**self.start.effects, effect.name: values})

    def _trial(self, effect: ThermalEffect, values: Values, near: FittedThermalAddition | None) -> Trial:
        return self.basis.fitted(self._with(effect, dict(values)), FIT_STEPS, near).trial()


def _at_end(value: float, options: Sequence[float]) -> float:
    """The value, or the end of the options that it hardly differs from."""
    ordered = sorted(options)
    if value - ordered[0] < NEAR * (ordered[1] - ordered[0]):
        return ordered[0]
    return ordered[-1] if ordered[-1] - value < NEAR * (ordered[-1] - ordered[-2]) else value


def _with_value(options: Sequence[float], value: float) -> list[float]:
    """The options and a value in the place of those that it hardly differs from."""
    ordered = sorted(options)
    least = NEAR * min(b - a for a, b in zip(ordered, ordered[1:]))
    return sorted({value, *(x for x in ordered if abs(x - value) > least)})


def _best_value(score: Callable[[float], float], options: Sequence[float], rounds: int) -> float:
    """The value of the best score among options, ``rounds`` times between them, and at the top of a parabola."""
    scores = {x: score(x) for x in options}
    for _ in range(rounds):
        ordered = sorted(scores)
        k = ordered.index(max(scores, key=lambda x: scores[x]))
        for other in ordered[max(k - 1, 0) : k] + ordered[k + 1 : k + 2]:
            x = 0.5 * (ordered[k] + other)
            scores[x] = score(x)
    top = vertex(scores)
    if top is not None and min(abs(top - x) for x in scores) > CLOSE * abs(top):
        scores[top] = score(top)
    return max(scores, key=lambda x: scores[x])


def searched_hypotheses(
    basis: ThermalBasis, base: FittedThermalAddition, progress: Progress, without: Sequence[str] = ()
) -> list[ComparedHypothesis]:
    """All hypotheses; ``without`` are names of effects."""
    x = basis.problem.record
    effects = [(e, e.tries(x)) for e in testable_effects(x) if e.name not in without]
    variables = testable_variables(basis.problem)
    search, nothing = (
        ThermalSearch(basis, ThermalAddition(), progress),
        ComparedHypothesis((), (base.trial(),)),
    )
    singles = [search.effect(e, tries) for e, tries in effects] + [search.variable(v) for v in variables]
    return [nothing, *singles, *_pairs(basis, nothing, singles, effects, variables, progress)]


def _pairs(
    basis: ThermalBasis,
    nothing: ComparedHypothesis,
    singles: Sequence[ComparedHypothesis],
    effects: Sequence[tuple[ThermalEffect, Tries]],
    variables: Sequence[str],
    progress: Progress,
) -> list[ComparedHypothesis]:
    """The best effect with every other part, and the best variable with every effect."""
    found: dict[frozenset[Part], ComparedHypothesis] = {}
    for kind in ("effect", "variable"):
        own = [h for h in singles if h.parts[0].kind == kind]
        best = max(own, key=lambda h: h.score, default=None)
        if best is None or best.score < nothing.score + WORTH_A_PAIR:
            continue
        fitted: FittedThermalAddition = best.best.state
        search = ThermalSearch(basis.of(fitted), fitted.candidate, progress)
        for effect, tries in effects:
            key = frozenset((Part("effect", effect.name), *best.parts))
            if len(key) == 2 and key not in found:
                single = next(h for h in singles if h.name == effect.name)
                found[key] = search.effect(effect, _narrowed(tries, single))
        for name in variables if kind == "effect" else ():
            found[frozenset((Part("variable", name), *best.parts))] = search.variable(name)
    return list(found.values())


def _narrowed(tries: Tries, single: ComparedHypothesis) -> Tries:
    """The best value of a single effect, its neighbours in the first tries, and the smallest of them."""
    found: dict[str, tuple[float, ...]] = {}
    for name, options in tries.items():
        best = single.best.parameters[name]
        near = sorted({*options, best})
        k = near.index(best)
        smallest = min(options, key=abs)
        found[name] = tuple(dict.fromkeys((best, *near[max(k - 1, 0) : k + 2], smallest)))
    return found
