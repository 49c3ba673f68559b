"""The trials of effects: parameters fitted to all readings, then strengths around them, with a joint density."""

from collections.abc import Iterator, Sequence
from contextlib import suppress

import numpy as np

from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem, FittedPlant
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Trial
from smarig.diagnosis.refit.parameter_fit import ParameterFit, fit_parameters
from smarig.plant import LEARNED, Effect
from smarig.replay import PlantModel

STEPS_SD = (3.0, 1.0)  # standard deviations of the strength from trial to trial
STEP_BOUNDS = (0.003, 0.3)  # of the strength: bounds of a step
ROUNDS = 5  # of parameters, then density
MOST_TRIALS = 11
MIN_ROUND_NATS = 2.0  # a round that gains less is the last
MIN_MOVE_SD = 0.3  # of a parameter: smaller moves change no score


def fitted_with(
    subject: CommandedProblem, start: FittedPlant, effects: Sequence[Effect], others: Sequence[Effect] = ()
) -> tuple[ComparedHypothesis, FittedPlant] | None:
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
    for each in starts:
        with suppress(np.linalg.LinAlgError):  # inputs that the effects move too close together
            fitted = subject.with_joint_density(each, start)
            found.append((subject.trial(fitted), fitted))
    if not found:
        return None
    _, best = max(found, key=lambda pair: pair[0].score)
    return ComparedHypothesis(subject.parts(best), tuple(t for t, _ in found)), best


def refined(
    subject: CommandedProblem, hypothesis: ComparedHypothesis, best: FittedPlant
) -> tuple[ComparedHypothesis, FittedPlant]:
    """The hypothesis with trials of other parameters: fitted again about its density, and at other strengths."""
    trials = list(hypothesis.trials)
    step = STEP_BOUNDS[1]
    for _ in range(ROUNDS):
        before, start = max(t.score for t in trials), best
        fit = _fit_about(subject, best, subject.with_effects(best, ()), best.effects)
        step = _relative_spread(fit)
        for again in _moved(subject, best, fit):
            trials.append(subject.trial(again))
            best = again if trials[-1].score >= max(t.score for t in trials) else best
        if best is start or max(t.score for t in trials) < before + MIN_ROUND_NATS:
            break
    if best.effects[-1].kind.name != LEARNED:  # the values of a law have no common strength
        best = _along_strength(subject, best, trials, step)
    return ComparedHypothesis(subject.parts(best), tuple(trials)), best


def _fit_about(
    subject: CommandedProblem, fitted: FittedPlant, model: PlantModel, effects: Sequence[Effect]
) -> ParameterFit:
    """Parameters with any density: one that has taken up what the effects change must not hold them."""
    output = np.zeros(fitted.refitted.scale.size)
    output[: fitted.refitted.coupled] = fitted.output
    return fit_parameters(effects, subject.timeline, model, fitted.refitted, model.hysteresis, output)


def _relative_spread(fit: ParameterFit) -> float:
    """The standard deviation of the last effect's strength, all else known, in shares of the strength."""
    last = fit.effects[-1]
    sd = fit.conditional_spread[(last.kind.name, last.kind.primary.name)]
    return sd / abs(last.strength) if last.strength else STEP_BOUNDS[1]


def _moved(subject: CommandedProblem, fitted: FittedPlant, fit: ParameterFit) -> Iterator[FittedPlant]:
    """The parameters of a fit with the density as it is; then with a density about them."""
    if fit.moved < MIN_MOVE_SD:
        return
    with suppress(np.linalg.LinAlgError):  # as in ``fitted_with``
        moved = subject.at(subject.with_effects(fitted, fit.effects), fitted.refitted)
        yield moved
        yield subject.with_joint_density(fit.effects, moved)


def _along_strength(
    subject: CommandedProblem, best: FittedPlant, trials: list[Trial], spread: float
) -> FittedPlant:
    """Trials at other strengths of the last effect, toward where other blocks are predicted better."""
    top = max(t.score for t in trials)
    for sds in STEPS_SD:
        step = 1 + float(np.clip(sds * spread, *STEP_BOUNDS))
        for factor in (step, 1 / step):
            while len(trials) < MOST_TRIALS:
                *others, last = best.effects
                primary = last.kind.primary
                value = min(max(last.strength * factor, primary.lower), primary.upper)
                if value == last.strength:
                    break
                other = subject.at(subject.with_effects(best, (*others, last.at(value))), best.refitted)
                trials.append(subject.trial(other))
                if trials[-1].score <= top:
                    break
                best, top = other, trials[-1].score
    return best
