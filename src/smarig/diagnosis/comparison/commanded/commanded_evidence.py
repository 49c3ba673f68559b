"""From weighted hypotheses to what the rules of the verdict ask."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from math import inf

import numpy as np

from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem
from smarig.diagnosis.comparison.commanded.commanded_search import SearchedHypotheses
from smarig.diagnosis.comparison.commanded.extension import Extension
from smarig.diagnosis.comparison.commanded.screening import Screened, collinear
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part
from smarig.diagnosis.comparison.effects_alone import with_effects_alone
from smarig.diagnosis.comparison.verdict_rules import RULES, VerdictEvidence
from smarig.diagnosis.comparison.weights import TEMPERATURE, Weights
from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.diagnosis.looks_like import acts_through
from smarig.diagnosis.refit.joint_density import position_rms, with_density_for_effects
from smarig.replay import PlantModel

Parts = tuple[Part, ...]
Squares = Mapping[str, float]  # mean squares of errors by channel
Pair = tuple[Squares, Squares]  # without and with a part
FITTED = {k: f"{k}, fitted" for k in ("settled", "moving")}  # positions that all blocks are fitted to
POSITIONS = (*FITTED, *FITTED.values())
LEAST_WEIGHT = 0.01  # of hypotheses whose density is made: less decides nothing
PARTED_NATS = TEMPERATURE * float(np.log(RULES["name"].value / (1 - RULES["name"].value)))


def evidence_of(
    subject: CommandedProblem,
    found: SearchedHypotheses,
    weights: Weights,
    by_effects: Extension,
    gain: HeldOutGain | None,
    held_out: Mapping[Part, float],
) -> VerdictEvidence:
    """What a verdict is decided from; a hypothesis that removes less than the least size is none.

    ``by_effects`` is the extension by the heaviest hypothesis with effects, ``gain`` are its errors on held-out runs;
    ``held_out``: ``held_out_shares``.
    """
    squares = _squares(subject, found, weights, by_effects.base)
    evidence = with_effects_alone(_all_evidence(subject, found, weights, squares, gain, held_out), weights)
    evidence = _without_negligible(evidence, weights, squares)
    return _with_held_out_gain(evidence, found, weights, squares, by_effects.parts, gain)


def _squares(
    subject: CommandedProblem, found: SearchedHypotheses, weights: Weights, base: PlantModel
) -> Mapping[Parts, Squares]:
    """Mean squares of errors of each hypothesis by channel, in shares of its span: of blocks left out, and ``FITTED``.

    Those are of positions with the density that fits best. A block that is left out is extrapolated where no other
    tells of it, and then its errors say little. They are known of nothing, and of likely effects.
    """
    span = abs(subject.given.stroke)

    def fitted(model: PlantModel) -> Squares:
        return {FITTED[k]: (e / span) ** 2 for k, e in position_rms(subject.timeline, model).items()}

    squares = {h.parts: dict(h.best.state) for h in found.hypotheses}
    squares[()] |= fitted(base)
    for h, w in zip(weights.hypotheses, weights.weight.tolist()):
        by_effects = h.parts and all(p.kind == "effect" for p in h.parts)
        if w >= LEAST_WEIGHT and by_effects and h.parts in found.models:
            own = found.models[h.parts]
            model = with_density_for_effects(subject.timeline, own.plant_model, own.refitted, base)
            squares[h.parts] |= fitted(model)
    return squares


def _without_negligible(
    e: VerdictEvidence, weights: Weights, squares: Mapping[Parts, Squares]
) -> VerdictEvidence:
    """Evidence with the weight of hypotheses that remove little, or less than they leave, given to nothing."""
    nothing = squares[()]

    def removes_enough(h: ComparedHypothesis) -> bool:
        with_variable = any(p.kind == "variable" for p in h.parts)  # which describes what is left
        unseen = min((_times_rest_unseen(e.held_out, p) for p in h.parts), default=0.0)
        times = max(_times_rest(nothing, squares[h.parts]), unseen)
        enough = with_variable or times >= RULES["beside_rest"].value
        return enough and e.span * _removes(nothing, squares[h.parts]) >= e.least_size

    large = [
        (h, w) for h, w in zip(weights.hypotheses, weights.weight.tolist()) if h.parts and removes_enough(h)
    ]
    causes = {p: sum(w for h, w in large if p in weights.credited(h)) for p in e.causes}
    likeliest = dict(sorted(causes.items(), key=lambda item: -item[1]))
    together: dict[frozenset[Part], float] = {}
    for h, w in large:
        held = frozenset(weights.credited(h))
        together[held] = together.get(held, 0.0) + w
    return replace(e, causes=likeliest, nothing=max(1.0 - sum(w for _, w in large), 0.0), together=together)


def _all_evidence(
    subject: CommandedProblem,
    found: SearchedHypotheses,
    weights: Weights,
    squares: Mapping[Parts, Squares],
    gain: HeldOutGain | None,
    held_out: Mapping[Part, float],
) -> VerdictEvidence:
    span, noise = abs(subject.given.stroke), subject.scatter(subject.base)
    pairs = {p: _pairs(found, weights, squares, p) for p in weights.causes}
    return VerdictEvidence(
        causes=weights.causes,
        nothing=weights.nothing,
        size={p: span * _size(pairs[p]) for p in weights.causes},
        span=span,
        error=span * float(np.sqrt(squares[()][FITTED["settled"]])),
        noise=noise,
        remains={p: span * _remains(pairs[p], p, held_out) for p in weights.causes},
        blocks=np.unique(subject.timeline.block).size,
        confounded=_confounded(found, weights),
        held_out=held_out,
        acts_through=weights.acts_through,
        testable=bool(found.screened),
        repeatability=_repeatability(found, weights),
        beyond_limit=_beyond_limit(gain, noise) if gain else 0.0,
        least_alone=RULES["name"].value,  # a name says that nothing else is missing
    )


def likeliest_variable(evidence: VerdictEvidence) -> str | None:
    """The variable that the errors go with most probably, by itself or through an effect; None: nothing is likelier.

    A variable that is itself the likelier half is it, whatever effects act through others. An effect that held-out runs
    refute says nothing of it.
    """
    itself = next(((p.name, w) for p, w in evidence.causes.items() if p.kind == "variable"), None)
    if itself is not None and itself[1] >= RULES["nothing"].value:
        return itself[0]
    total: dict[str | None, float] = {None: evidence.nothing}
    for part, p in evidence.causes.items():
        if evidence.refuted(part):
            continue
        for v in (part,) if part.kind == "variable" else evidence.acts_through.get(part, ()):
            total[v.name] = total.get(v.name, 0.0) + p
    return max(total, key=lambda name: total[name])


def ways_of(found: SearchedHypotheses) -> dict[Part, tuple[Part, ...]]:
    """The variables that each effect of the hypotheses acts through."""
    effects = {p for h in found.hypotheses for p in h.parts if p.kind == "effect"}
    return {e: tuple(Part("variable", v) for v in acts_through(e.name)) for e in effects}


def _beyond_limit(gain: HeldOutGain, noise: float) -> float:
    """The base model's error on held-out runs over the limit of prediction, or at settled points over their noise."""
    return min(gain.base / gain.floor, gain.settled_rms(gain.base_error) / noise)


def _size(pairs: Sequence[Pair]) -> float:
    """What a part removes, in shares of a channel's span: the most of any channel."""
    return max(_removes(before, own) for before, own in pairs)


def _remains(pairs: Sequence[Pair], part: Part, held_out: Mapping[Part, float]) -> float:
    """The error that is left beside what a part removes, in the channel where it removes most of what is left.

    Held-out positions count as a channel, if the extended model has no other part.
    """
    alone = {part: held_out[part]} if list(held_out) == [part] else {}
    times = max(*(_times_rest(before, own) for before, own in pairs), _times_rest_unseen(alone, part))
    return _size(pairs) / times if times else inf


def _pairs(
    found: SearchedHypotheses, weights: Weights, squares: Mapping[Parts, Squares], part: Part
) -> list[Pair]:
    """Without a part and with it: means over the hypotheses that hold it, by their weights.

    A variable beside an effect describes what that leaves, so the effect may also stand alone.
    """
    heaviest = weights.best_with(part).parts
    weight = {h.parts: w for h, w in zip(weights.hypotheses, weights.weight.tolist()) if part in h.parts}
    if not sum(weight.values()):
        weight = {heaviest: 1.0}
    pairs = [_mean_pair([(w, _without(part, own, squares), squares[own]) for own, w in weight.items()])]
    others = [p for p in heaviest if p != part]
    if _alone(found, part) and part.kind == "effect" and all(p.kind == "variable" for p in others):
        pairs.append((squares[()], squares[(part,)]))
    return pairs


def _without(part: Part, parts: Parts, squares: Mapping[Parts, Squares]) -> Squares:
    return squares.get(tuple(p for p in parts if p != part), squares[()])


def _mean_pair(several: Sequence[tuple[float, Squares, Squares]]) -> Pair:
    """Mean squares by channel, each over those of (weight, without, with) that have it."""
    before, own = {}, {}
    for k in {k for _, b, o in several for k in b.keys() & o.keys()}:
        rows = [(w, b[k], o[k]) for w, b, o in several if k in b and k in o]
        total = sum(w for w, _, _ in rows)
        if total:
            before[k] = sum(w * b for w, b, _ in rows) / total
            own[k] = sum(w * o for w, _, o in rows) / total
    return before, own


def _removes(before: Squares, own: Squares) -> float:
    """The root of the mean square that a hypothesis removes, in shares of a channel's span: the most of any channel."""
    return float(np.sqrt(max(0.0, *(before[k] - own[k] for k in before.keys() & own.keys()))))


def _times_rest(before: Squares, own: Squares, channels: Collection[str] = ()) -> float:
    """What a hypothesis removes over what it leaves, in the channel where that is most."""
    shared = before.keys() & own.keys() & set(channels or before)
    return float(np.sqrt(max([0.0, *(before[k] / own[k] - 1 for k in shared if own[k] > 0)])))


def _times_rest_unseen(held_out: Mapping[Part, float], part: Part) -> float:
    """What a part removes of the error on held-out runs over what it leaves; 0 if it removes nothing."""
    left = held_out.get(part, 1.0)
    return float(np.sqrt(1 / left**2 - 1)) if 0 < left < 1 else 0.0


def _repeatability(found: SearchedHypotheses, weights: Weights) -> float:
    """What a settled reading scatters by the heaviest hypothesis that was fitted."""
    effects = tuple(p for p in weights.heaviest.parts if p.kind == "effect")
    return found.models.get(effects, found.models[()]).refitted.noise.settled


def _with_held_out_gain(
    e: VerdictEvidence,
    found: SearchedHypotheses,
    weights: Weights,
    squares: Mapping[Parts, Squares],
    parts: Sequence[Part],
    gain: HeldOutGain | None,
) -> VerdictEvidence:
    """Evidence with the parts of an extended model that remove less of the held-out runs' error than they leave.

    Only where that is large: these runs, which no fit has seen, then tell more than blocks of the training runs. What
    acts in another channel only, such as the current, need not show in positions.
    """
    if gain is None or gain.base < RULES["adequate"].value * gain.floor:
        return e

    def in_positions(part: Part) -> bool:
        pairs = _pairs(found, weights, squares, part)
        return max(_times_rest(*pair, POSITIONS) for pair in pairs) >= RULES["beside_rest"].value

    too_little = [p for p in parts if _times_rest_unseen(e.held_out, p) < RULES["beside_rest"].value]
    return replace(e, not_borne_out=frozenset(p for p in too_little if in_positions(p)))


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
