"""The trials of effects: parameters fitted to all readings, then strengths around them, with a joint density."""

from collections.abc import Sequence

from smarig.diagnosis.comparison.commanded.subject import Fitted, Subject
from smarig.diagnosis.comparison.hypothesis import Hypothesis, Part, Trial
from smarig.diagnosis.explain.parameter_fit import fit_parameters
from smarig.plant import Effect

STEPS = (1.5, 1.2, 1.08)  # factors of the strength from trial to trial
MOST_TRIALS = 9


def refined(subject: Subject, start: Fitted, effects: Sequence[Effect]) -> tuple[Hypothesis, Fitted]:
    """The hypothesis that these effects are present, with its trials, and the model of the best one."""
    best = _with_density(subject, start, effects)
    trials = [subject.trial(best)]
    again = _refitted(subject, best)
    if again is not None:
        trials.append(subject.trial(again))
        best = max((trials[0], best), (trials[1], again), key=lambda pair: pair[0].log_scores.sum())[1]
    best = _along_strength(subject, best, trials)
    parts = tuple(Part("effect", e.kind.name) for e in best.effects)
    return Hypothesis(tuple(sorted(parts)), tuple(trials)), best


def _with_density(subject: Subject, start: Fitted, effects: Sequence[Effect]) -> Fitted:
    """The effects fitted with the density free about that of ``start``, then with a density of their own."""
    fit = fit_parameters(
        effects, subject.timeline, start.plant_model, start.refitted, start.plant_model.hysteresis
    )
    return subject.with_joint_density(subject.with_effects(start, fit.effects), start.refitted)


def _refitted(subject: Subject, fitted: Fitted) -> Fitted | None:
    """The parameters fitted once more about the density identified with them."""
    model = subject.with_effects(fitted, ())
    fit = fit_parameters(fitted.effects, subject.timeline, model, fitted.refitted, model.hysteresis)
    moved = subject.with_effects(fitted, fit.effects)
    return subject.at(moved, fitted.refitted) if fit.effects != fitted.effects else None


def _along_strength(subject: Subject, best: Fitted, trials: list[Trial]) -> Fitted:
    """Trials at other strengths of the last effect, toward where other blocks are predicted better."""
    top = subject.trial(best).log_scores.sum()
    for step in STEPS:
        for factor in (step, 1 / step):
            while len(trials) < MOST_TRIALS:
                *others, last = best.effects
                primary = last.kind.primary
                value = min(max(last.strength * factor, primary.lower), primary.upper)
                if value == last.strength:
                    break
                other = subject.at(subject.with_effects(best, (*others, last.at(value))), best.refitted)
                trials.append(subject.trial(other))
                score = trials[-1].log_scores.sum()
                if score <= top:
                    break
                best, top = other, score
    return best
