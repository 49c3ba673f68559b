"""The trials of effects: parameters fitted to all readings, then strengths around them, with a joint density."""

from collections.abc import Iterator, Sequence

from smarig.diagnosis.comparison.commanded.subject import Fitted, Subject
from smarig.diagnosis.comparison.hypothesis import Hypothesis, Part, Trial
from smarig.diagnosis.explain.parameter_fit import fit_parameters
from smarig.plant import Effect

STEPS = (1.3, 1.1)  # factors of the strength from trial to trial
MOST_TRIALS = 8
MIN_MOVE_SD = 0.3  # of a parameter: smaller moves change no score


def fitted_with(subject: Subject, start: Fitted, effects: Sequence[Effect]) -> tuple[Hypothesis, Fitted]:
    """The hypothesis that these effects are present, fitted about ``start`` and given a density of their own."""
    fit = fit_parameters(
        effects, subject.timeline, start.plant_model, start.refitted, start.plant_model.hysteresis
    )
    best = subject.with_joint_density(subject.with_effects(start, fit.effects), start.refitted)
    return _hypothesis(best, [subject.trial(best)]), best


def refined(subject: Subject, hypothesis: Hypothesis, best: Fitted) -> tuple[Hypothesis, Fitted]:
    """The hypothesis with trials of other parameters: fitted again about its density, and at other strengths."""
    trials = list(hypothesis.trials)
    for again in _refitted(subject, best):
        trials.append(subject.trial(again))
        best = again if _total(trials[-1]) >= max(_total(t) for t in trials) else best
    best = _along_strength(subject, best, trials)
    return _hypothesis(best, trials), best


def _hypothesis(fitted: Fitted, trials: Sequence[Trial]) -> Hypothesis:
    return Hypothesis(tuple(sorted(Part("effect", e.kind.name) for e in fitted.effects)), tuple(trials))


def _total(trial: Trial) -> float:
    return float(trial.log_scores.sum())


def _refitted(subject: Subject, fitted: Fitted) -> Iterator[Fitted]:
    """The parameters fitted once more about the density identified with them; then a density about these."""
    model = subject.with_effects(fitted, ())
    fit = fit_parameters(fitted.effects, subject.timeline, model, fitted.refitted, model.hysteresis)
    if fit.moved < MIN_MOVE_SD:
        return
    moved = subject.at(subject.with_effects(fitted, fit.effects), fitted.refitted)
    yield moved
    yield subject.with_joint_density(moved.plant_model, moved.refitted)


def _along_strength(subject: Subject, best: Fitted, trials: list[Trial]) -> Fitted:
    """Trials at other strengths of the last effect, toward where other blocks are predicted better."""
    top = max(_total(t) for t in trials)
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
                if _total(trials[-1]) <= top:
                    break
                best, top = other, _total(trials[-1])
    return best
