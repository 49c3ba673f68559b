"""From weighted hypotheses to what the rules of the verdict ask."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from math import inf

import numpy as np

from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem
from smarig.diagnosis.comparison.commanded.commanded_search import SearchedHypotheses
from smarig.diagnosis.comparison.commanded.screening import Screened, collinear
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part
from smarig.diagnosis.comparison.rules import RULES, VerdictEvidence
from smarig.diagnosis.comparison.weights import TEMPERATURE, Weights
from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.diagnosis.looks_like import PLANT_EFFECTS
from smarig.diagnosis.refit.joint_density import settled_rms, with_density_for_effects
from smarig.diagnosis.refit.reading_noise import EFFECT_ERROR_SHARE
from smarig.replay import PlantModel

POSITIONS = ("settled", "moving")
LEAST_WEIGHT = 0.01  # of hypotheses whose density is made: less decides nothing
FittedErrors = Mapping[tuple[Part, ...], float]
LARGEST = 0.1  # of the left-out errors of a channel: most of them are extrapolations
PARTED_NATS = TEMPERATURE * float(np.log(RULES["name"].value / (1 - RULES["name"].value)))


def evidence_of(
    subject: CommandedProblem,
    found: SearchedHypotheses,
    weights: Weights,
    base: PlantModel,
    held_out: dict[Part, float],
) -> VerdictEvidence:
    """What a verdict is decided from; a hypothesis that removes less than the least size is none.

    ``base`` is the model without effects with the density that fits best.
    """
    fitted = _fitted_errors(subject, found, weights, base)
    evidence = _with_effects_alone(_all_evidence(subject, found, weights, fitted, held_out), weights)
    return _without_negligible(evidence, found, weights, fitted)


def _fitted_errors(
    subject: CommandedProblem, found: SearchedHypotheses, weights: Weights, base: PlantModel
) -> FittedErrors:
    """Rms errors at settled positions with the positive density that fits best: of nothing, and of likely effects."""
    errors: dict[tuple[Part, ...], float] = {(): settled_rms(subject.timeline, base)}
    for h, w in zip(weights.hypotheses, weights.weight.tolist()):
        effects = tuple(p for p in h.parts if p.kind == "effect")
        if w >= LEAST_WEIGHT and effects in found.models and effects not in errors:
            own = found.models[effects]
            model = with_density_for_effects(subject.timeline, own.plant_model, own.refitted, base)
            errors[effects] = settled_rms(subject.timeline, model)
    return errors


def _without_negligible(
    e: VerdictEvidence, found: SearchedHypotheses, weights: Weights, fitted: FittedErrors
) -> VerdictEvidence:
    """Evidence with the weight of hypotheses that remove little, or less than they leave, given to nothing."""
    nothing = found.hypotheses[0]

    def removes_enough(h: ComparedHypothesis) -> bool:
        with_variable = any(p.kind == "variable" for p in h.parts)  # which describes what is left
        unseen = min((_times_rest_unseen(e.held_out, p) for p in h.parts), default=0.0)
        times = max(_times_rest(nothing, h), _times_rest_fitted(fitted, (), h.parts), unseen)
        enough = with_variable or times >= RULES["beside_rest"].value
        return enough and e.span * _removes(nothing, h) >= e.least_size

    large = [
        (h, w) for h, w in zip(weights.hypotheses, weights.weight.tolist()) if h.parts and removes_enough(h)
    ]
    causes = {p: sum(w for h, w in large if p in weights.credited(h)) for p in e.causes}
    likeliest = dict(sorted(causes.items(), key=lambda item: -item[1]))
    return replace(e, causes=likeliest, nothing=1.0 - sum(w for _, w in large))


def _all_evidence(
    subject: CommandedProblem,
    found: SearchedHypotheses,
    weights: Weights,
    fitted: FittedErrors,
    held_out: dict[Part, float],
) -> VerdictEvidence:
    span = abs(subject.given.stroke)
    return VerdictEvidence(
        causes=weights.causes,
        nothing=weights.nothing,
        size={p: span * _size(found, weights, p) for p in weights.causes},
        span=span,
        error=fitted[()],
        noise=subject.scatter(subject.base),
        remains={p: span * _remains(found, weights, p, fitted, held_out) for p in weights.causes},
        blocks=int(np.unique(subject.timeline.block).size),
        confounded=_confounded(found, weights),
        held_out=held_out,
        acts_through=weights.acts_through,
        testable=bool(found.screened),
        repeatability=_repeatability(found, weights),
        least_alone=RULES["name"].value,  # a name says that nothing else is missing
    )


def likeliest_variable(evidence: VerdictEvidence) -> str | None:
    """The variable that the errors go with most probably, by itself or through an effect that acts through it."""
    total: dict[str, float] = {}
    for part, p in evidence.causes.items():
        for v in (part,) if part.kind == "variable" else evidence.acts_through.get(part, ()):
            total[v.name] = total.get(v.name, 0.0) + p
    return max(total, key=lambda name: total[name], default=None)


def acts_through(found: SearchedHypotheses) -> dict[Part, tuple[Part, ...]]:
    """The variables of each effect of the hypotheses."""
    effects = {p for h in found.hypotheses for p in h.parts if p.kind == "effect"}
    return {
        e: tuple(Part("variable", v) for v, names in PLANT_EFFECTS.items() if e.name in names)
        for e in effects
    }


def _squares(
    before: ComparedHypothesis, own: ComparedHypothesis, channels: Collection[str] | None = None
) -> list[tuple[float, float]]:
    """Mean squares of left-out errors, without and with: of each channel, and again with the largest cut.

    Where a block is left out of which nothing else tells, both extrapolate, and their errors say little.
    """
    found = []
    for kind, without in before.best.state[1].items():
        if channels is None or kind in channels:
            with_part, most = own.best.state[1][kind], float(np.quantile(without, 1 - LARGEST))
            found += [
                (float(np.minimum(without, m).mean()), float(np.minimum(with_part, m).mean()))
                for m in (inf, most)
            ]
    return found


def _size(found: SearchedHypotheses, weights: Weights, part: Part) -> float:
    """What a part removes of the left-out error, in shares of a channel's span: the most of any channel."""
    return max(_removes(before, own) for before, own in _with_and_without(found, weights, part))


def _remains(
    found: SearchedHypotheses,
    weights: Weights,
    part: Part,
    fitted: FittedErrors,
    held_out: Mapping[Part, float],
) -> float:
    """The error that is left beside what a part removes, in the channel where it removes most of what is left.

    Held-out positions count as a channel, if the extended model has no other part; so do positions that all blocks are
    fitted to, where no block is extrapolated.
    """
    pairs = _with_and_without(found, weights, part)
    alone = {part: held_out[part]} if list(held_out) == [part] else {}
    times = max(
        *(_times_rest(before, own) for before, own in pairs),
        *(_times_rest_fitted(fitted, before.parts, own.parts) for before, own in pairs),
        _times_rest_unseen(alone, part),
    )
    return _size(found, weights, part) / times if times else inf


def _with_and_without(
    found: SearchedHypotheses, weights: Weights, part: Part
) -> list[tuple[ComparedHypothesis, ComparedHypothesis]]:
    """(hypothesis without a part, hypothesis with it): the heaviest that holds it.

    A variable beside an effect describes what that leaves, so the effect may also stand alone.
    """
    own = weights.best_with(part)
    rest = tuple(p for p in own.parts if p != part)
    nothing = found.hypotheses[0]
    pairs = [(next((h for h in found.hypotheses if h.parts == rest), nothing), own)]
    alone = _alone(found, part)
    if alone and part.kind == "effect" and all(p.kind == "variable" for p in rest):
        pairs.append((nothing, alone))
    return pairs


def _removes(before: ComparedHypothesis, own: ComparedHypothesis) -> float:
    """The root of the mean square that a hypothesis removes, in shares of a channel's span: the most of any channel."""
    removed = max(without - left for without, left in _squares(before, own))
    return float(np.sqrt(max(removed, 0.0)))


def _times_rest(
    before: ComparedHypothesis, own: ComparedHypothesis, channels: Collection[str] | None = None
) -> float:
    """What a hypothesis removes over what it leaves, in the channel where that is most."""
    shares = [(without - left) / left for without, left in _squares(before, own, channels) if left > 0]
    return float(np.sqrt(max([0.0, *shares])))


def _times_rest_fitted(fitted: FittedErrors, before: tuple[Part, ...], own: tuple[Part, ...]) -> float:
    """What effects remove of the error at fitted positions over what they leave."""
    if before not in fitted or not fitted.get(own):
        return 0.0
    return float(np.sqrt(max((fitted[before] / fitted[own]) ** 2 - 1, 0.0)))


def _times_rest_unseen(held_out: Mapping[Part, float], part: Part) -> float:
    """What a part removes of the error on held-out runs over what it leaves; 0 if it removes nothing."""
    left = held_out.get(part, 1.0)
    return float(np.sqrt(1 / left**2 - 1)) if 0 < left < 1 else 0.0


def _repeatability(found: SearchedHypotheses, weights: Weights) -> float:
    """What a settled reading scatters by the heaviest hypothesis that was fitted."""
    effects = tuple(p for p in weights.heaviest.parts if p.kind == "effect")
    return found.models.get(effects, found.models[()]).refitted.noise.settled


def with_held_out_gain(
    e: VerdictEvidence,
    found: SearchedHypotheses,
    weights: Weights,
    parts: Sequence[Part],
    gain: HeldOutGain | None,
) -> VerdictEvidence:
    """Evidence with the parts of an extended model whose gain held-out runs do not show, though much is to be gained.

    What acts in another channel only, such as the current, need not show in positions.
    """
    if gain is None or gain.base < RULES["adequate"].value * gain.floor:
        return e
    if gain.extended * RULES["worse"].value <= gain.base:
        return e
    return replace(e, not_borne_out=frozenset(p for p in parts if _in_positions(found, weights, p)))


def _in_positions(found: SearchedHypotheses, weights: Weights, part: Part) -> bool:
    """Whether a part removes more of the left-out errors of positions than it leaves."""
    pairs = _with_and_without(found, weights, part)
    times = max(_times_rest(before, own, POSITIONS) for before, own in pairs)
    return times >= RULES["beside_rest"].value


def _with_effects_alone(e: VerdictEvidence, weights: Weights) -> VerdictEvidence:
    """Evidence with the probability of hypotheses of effects only, among those that hold an effect.

    A variable beside an effect takes no name away if it changes too little to be told, or no more than the equation of
    the effect is wrong.
    """

    def alone(h: ComparedHypothesis) -> bool:
        effect = max((e.size[p] for p in h.parts if p.kind == "effect"), default=0.0)
        least = max(e.least_size, EFFECT_ERROR_SHARE * effect)
        return all(p.kind == "effect" or e.size[p] < least for p in h.parts)

    with_effect = [
        (w, alone(h))
        for h, w in zip(weights.hypotheses, weights.weight.tolist())
        if any(p.kind == "effect" for p in h.parts)
    ]
    total = sum(w for w, _ in with_effect)
    return replace(
        e, effects_alone=sum(w for w, by_effects in with_effect if by_effects) / total if total else 1.0
    )


def _confounded(found: SearchedHypotheses, weights: Weights) -> dict[Part, tuple[Part, ...]]:
    """Effects whose traces explain so much of each other that these blocks are not expected to part them."""
    by_part = {s.part: s for s in found.screened}
    return {
        part: others
        for part in weights.causes
        if part in by_part and (others := tuple(_imitators(by_part[part], found)))
    }


def _imitators(own: Screened, found: SearchedHypotheses) -> list[Part]:
    """The effects that neither the geometry of the traces nor the scores part from one."""
    gain = max(_gain(found, own.part), 0.5 * float(own.whitened @ own.whitened))
    return [
        s.part
        for s in found.screened
        if s.part != own.part
        and gain > PARTED_NATS
        and gain * (1 - collinear(own, s)) < PARTED_NATS
        and _gain(found, own.part) - _gain(found, s.part) < PARTED_NATS
    ]


def _gain(found: SearchedHypotheses, part: Part) -> float:
    """Nats that an effect alone gains over nothing on blocks left out."""
    best, nothing = _alone(found, part), found.hypotheses[0]
    return float(best.score - nothing.score) if best else 0.0


def _alone(found: SearchedHypotheses, part: Part) -> ComparedHypothesis | None:
    return next((h for h in found.hypotheses if h.parts == (part,)), None)
