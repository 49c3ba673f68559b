"""The trials of effects: parameters fitted to all readings, then strengths around them, with a joint density."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress

import numpy as np

from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem, FittedPlant
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Trial
from smarig.diagnosis.refit.parameter_fit import ParameterFit, fit_parameters
from smarig.plant import LEARNED, Effect
from smarig.replay import PlantModel

COARSE_SD, FINE_SD = 3.0, 1.0  # standard deviations of a parameter from trial to trial
STEP_BOUNDS = (0.01, 0.3)  # of its size: bounds of a step
ROUNDS = 5  # of parameters, then density; and of steps along each parameter
MOST_TRIALS = 20
MIN_ROUND_NATS = 2.0  # a round that gains less is the last
HALVINGS = 3  # of a strength
MIN_MOVE_SD = 0.3  # of a parameter: smaller moves change no score

FittedHypothesis = tuple[ComparedHypothesis, FittedPlant]


def fitted_with(
    subject: CommandedProblem, start: FittedPlant, effects: Sequence[Effect], others: Sequence[Effect] = ()
) -> FittedHypothesis | None:
    """The hypothesis that these effects are present, with a density identified together with them.

    A density that was identified without an effect has its errors in it, and holds its strength near zero. So the
    search starts at strengths: those of ``effects``, and with ``others`` in place of the last effect. Parameters that
    need more than a strength are also fitted about ``start``. None if no density can be identified.
    """
    *known, last = effects
    starts = [(*known, e) for e in (last, *others)]
    if not others or len(last.kind.parameters) > 1:
        fit = _fit_about(subject, start, start.plant_model, effects)
        starts = [fit.effects, *(starts if others else [])]
    found = []
    for each in _apart(starts):
        with suppress(np.linalg.LinAlgError):  # inputs that the effects move too close together
            fitted = subject.with_density(each, start)
            found.append((subject.trial(fitted), fitted))
    if not found:
        return None
    _, best = max(found, key=lambda pair: pair[0].score)
    return ComparedHypothesis(subject.parts(best), tuple(t for t, _ in found)), best


def weaker(
    subject: CommandedProblem, start: FittedPlant, found: FittedHypothesis, linear: float
) -> FittedHypothesis:
    """A fitted hypothesis with trials at half the strength, and so on, while it stays below its ``linear`` score.

    A density that has taken up an effect does not give it back at once, so the strength of the trace is too large
    about it: that of a friction, which makes every loop wider.
    """
    hypothesis, best = found
    trials = list(hypothesis.trials)
    for _ in range(HALVINGS):
        if max(t.score for t in trials) >= linear:
            break
        *known, last = best.effects
        try:
            half = subject.with_density((*known, last.at(0.5 * last.strength)), start)
        except np.linalg.LinAlgError:  # as in ``fitted_with``
            break
        trials.append(subject.trial(half))
        if trials[-1].score < max(t.score for t in trials):
            break
        best = half
    return ComparedHypothesis(hypothesis.parts, tuple(trials)), best


def _apart(starts: Sequence[Sequence[Effect]]) -> list[Sequence[Effect]]:
    """The starts that differ from all before by at least the shortest step of a search."""
    kept: list[Sequence[Effect]] = []
    for each in starts:
        if not any(_same(each, before) for before in kept):
            kept.append(each)
    return kept


def _same(one: Sequence[Effect], other: Sequence[Effect]) -> bool:
    pairs = [(v, b.values[n]) for a, b in zip(one, other) for n, v in a.values.items()]
    return all(abs(v - w) <= STEP_BOUNDS[0] * max(abs(v), abs(w)) for v, w in pairs)


def refined(
    subject: CommandedProblem, hypothesis: ComparedHypothesis, best: FittedPlant
) -> tuple[ComparedHypothesis, FittedPlant]:
    """The hypothesis with trials of other parameters: fitted again about its density, and step by step."""
    trials = list(hypothesis.trials)
    fit = _fit_about(subject, best, subject.with_effects(best, ()), best.effects)
    for _ in range(ROUNDS):
        before, start = max(t.score for t in trials), best
        for again in _moved(subject, best, fit):
            trials.append(subject.trial(again))
            best = again if trials[-1].score >= max(t.score for t in trials) else best
        if best is start or max(t.score for t in trials) < before + MIN_ROUND_NATS:
            break
        fit = _fit_about(subject, best, subject.with_effects(best, ()), best.effects)
    if best.effects[-1].kind.name != LEARNED:  # the values of a law have no common strength
        best = _step_by_step(subject, best, trials, fit.conditional_spread)
    return ComparedHypothesis(subject.parts(best), tuple(trials)), best


def _fit_about(
    subject: CommandedProblem, fitted: FittedPlant, model: PlantModel, effects: Sequence[Effect]
) -> ParameterFit:
    """Parameters with any density: one that has taken up what the effects change must not hold them."""
    output = np.zeros(fitted.refitted.scale.size)
    output[: fitted.refitted.coupled] = fitted.output
    return fit_parameters(effects, subject.timeline, model, fitted.refitted, model.hysteresis, output)


def _moved(subject: CommandedProblem, fitted: FittedPlant, fit: ParameterFit) -> Iterator[FittedPlant]:
    """The parameters of a fit with the density as it is; then with a density about them."""
    if fit.moved < MIN_MOVE_SD:
        return
    with suppress(np.linalg.LinAlgError):  # as in ``fitted_with``
        moved = subject.at(subject.with_effects(fitted, fit.effects), fitted.refitted)
        yield moved
        yield subject.with_density(fit.effects, moved)


def _step_by_step(
    subject: CommandedProblem,
    best: FittedPlant,
    trials: list[Trial],
    spread: Mapping[tuple[str, str], float],
) -> FittedPlant:
    """Trials along each parameter of the last effect, toward where other blocks are predicted better.

    ``spread``: the standard deviation of each parameter if all else is known. Each trial has a density of its own:
    with that of another strength, a strength looks surer than it is.
    """
    kind = best.effects[-1].kind
    names = [p.name for p in kind.parameters if (kind.name, p.name) in spread and not p.of_record]
    for _ in range(ROUNDS):
        before = max(t.score for t in trials)
        for name in names:
            best = _along(subject, best, trials, name, COARSE_SD * spread[kind.name, name])
        if len(names) == 1 or max(t.score for t in trials) < before + MIN_ROUND_NATS:
            break
    return _along(subject, best, trials, kind.primary.name, FINE_SD * spread[kind.name, kind.primary.name])


def _along(
    subject: CommandedProblem, best: FittedPlant, trials: list[Trial], name: str, step: float
) -> FittedPlant:
    """Trials at smaller and larger values of a parameter of the last effect; steps double as long as they gain."""
    top = max(t.score for t in trials)
    parameter = next(p for p in best.effects[-1].kind.parameters if p.name == name)
    for sign in (1, -1):
        times = 1
        while len(trials) < MOST_TRIALS:
            *others, last = best.effects
            low, high = (share * (abs(last.values[name]) or abs(parameter.typical)) for share in STEP_BOUNDS)
            value = last.values[name] + sign * times * float(np.clip(step, low, high))
            value = min(max(value, parameter.lower), parameter.upper)
            if value == last.values[name]:
                break
            moved = last.kind(**{**last.values, name: value})
            if any(_at(t, moved) for t in trials):  # it gained nothing then
                break
            try:
                other = subject.with_density((*others, moved), best)
            except np.linalg.LinAlgError:  # as in ``fitted_with``
                break
            trials.append(subject.trial(other))
            if trials[-1].score <= top:
                break
            best, top, times = other, trials[-1].score, 2 * times
    return best


def _at(trial: Trial, effect: Effect) -> bool:
    """Whether a trial has an effect at these values."""
    own = {f"{effect.kind.name}.{n}": v for n, v in effect.values.items()}
    return all(trial.parameters.get(k) == v for k, v in own.items())
