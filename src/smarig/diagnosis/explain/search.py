"""The search for sets of effects that explain a timeline: forward from the best single effect, with rivals kept.

The evidence of an explanation is the log likelihood of all readings with its effects, its joint density, and the
likeliest noise and smoothness. So a large effect is not evaluated by linearisation, and a rival not by the misfit
of another explanation. The search stops when nothing stands out any more, or when no named effect gains enough.
``diagnosis_verdict`` decides.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import inf

from smarig.diagnosis.critique.critique import Critique
from smarig.diagnosis.explain.explanation import (
    MAX_ROUNDS,
    Explanation,
    doubled_strength_start,
    evidence_without_one,
    fit_explanation,
    with_strengths_maximised,
)
from smarig.diagnosis.explain.joint_density import joint_density_from_best_start
from smarig.diagnosis.explain.parameter_fit import ParameterFit, fit_parameters
from smarig.diagnosis.refit.refit import Refit
from smarig.plant import Effect
from smarig.preisach import Everett
from smarig.replay import PlantModel, Timeline

CritiqueFunction = Callable[[PlantModel], Critique]
EffectSet = tuple[Effect, ...]
SINGLE_TRIED = 6  # single effects refined
SINGLE_TRIED_IF_SILENT = 3  # the same if nothing stands out when all effects are allowed as noise
FURTHER_TRIED = 3  # further effects tried with an accepted one, of those that stand out now and at first
MIN_FURTHER_FIT_NATS = 6.0  # nats of a fit with the present density: less does not become a gain of 25
MIN_FIT_SHARE = (
    0.2  # of the least gain: a fit with the present density that gains less does not become that gain
)
RIVALS_KEPT = 3  # explanations kept from size to size
DOUBLING_TRIED = 2  # of the evaluated, likeliest first: those tried at double strength
EVALUATED_MAX = 4  # explanations whose likelihood is computed
MAX_EFFECTS = 3  # effects in one explanation
MIN_GAIN_NATS = 18.0  # nats: least gain of a named effect
MIN_GAIN_SILENT_NATS = 25.0  # nats: the same if nothing stands out when all effects are allowed as noise
MIN_GAIN_FURTHER_NATS = (
    25.0  # nats: least gain of a further effect, which could otherwise be an artefact of the first
)
MIN_GAIN_FURTHER_SHARE = 0.05  # of the first effect's gain, for the same reason
MIN_GAIN_FURTHER_CAP_NATS = 60.0  # nats: a sufficient gain, unless the first effect's is beyond all measure
NUMERICAL_SHARE = 1e-5  # of the first effect's gain: what the numerics of its fit can leave to another
MIN_NEAREST_NATS = 10.0  # nats: gain and lead of an effect that is called the nearest though it is not named
MAX_DEFICIT_NATS = 60.0  # nats behind the best: explanations farther behind are not evaluated
MAX_DEFICIT_SHARE = 0.25  # of the gain of the best: the same limit, if it is larger
LINEAR_DEFICIT_SHARE = 0.5  # of the gain of the best: the accuracy of linearisation for large effects


class BelowRivalEvidence(Exception):
    """No single effect explains as much as the rival."""


@dataclass(frozen=True, eq=False)
class SearchLevel:
    """Explanations with one number of effects, likeliest first; ``critique`` is that of the best, ``best`` its
    parameters.

    ``gain`` is the log likelihood of the best over that of the best explanation with one effect less.
    ``linear_gain`` (nats) is the part of it that linearisation shows.
    """

    critique: Critique
    explanations: tuple[Explanation, ...]
    best: ParameterFit
    gain: float
    linear_gain: float

    def lead(self, k: int) -> float:
        """Nats by which the best explanation is likelier than explanation k."""
        return self.explanations[0].evidence - self.explanations[k].evidence


@dataclass(frozen=True, eq=False)
class NearestEffect:
    """The likeliest single effect, where none gains enough for a level. ``gain``, ``required`` and ``lead`` in nats.

    ``effect`` is the one that was tried, beside those that the given model has. ``lead`` is that over the next one,
    infinite if there is none.
    """

    effect: Effect
    gain: float
    required: float
    lead: float

    @property
    def is_clear(self) -> bool:
        """Whether it gains and leads by so much that it is worth a name with a reservation."""
        return min(self.gain, self.lead) >= MIN_NEAREST_NATS


@dataclass(frozen=True, eq=False)
class SearchResult:
    """What a search found: its levels, and where it has none the effect that came nearest to one."""

    levels: list[SearchLevel]
    nearest: NearestEffect | None = None


def search_explanations(
    first: Critique,
    original: Everett,
    criticise: CritiqueFunction,
    evidence: float,
    gate: float = MIN_GAIN_NATS,
    tried: int = SINGLE_TRIED,
    rival: float = -inf,
    most: int = MAX_EFFECTS,
) -> SearchResult:
    """Levels of one, two, … effects, as long as something stands out and is explained.

    ``original`` is the hysteresis of the given model. ``criticise`` makes the critique of a plant model.
    ``evidence`` is the log likelihood without any effect. ``gate`` (nats) is the least gain of the first effect,
    ``tried`` the number of effects tried. Raises BelowRivalEvidence if no single effect comes near ``rival``, the
    log likelihood of another explanation.
    """
    if first.silent:
        return SearchResult([])
    fixed_effects = first.plant_model.catalogue_effects  # are fitted again
    starts: Sequence[EffectSet] = [(*fixed_effects, p) for p in _starts(first, tried)]
    levels: list[SearchLevel] = []
    current = first
    while starts and len(levels) < most:
        fewer = levels[-1].best.effects if levels else ()
        required = _required_gain_nats(levels) if levels else gate
        linear_gain, found = _evaluated(first, original, current, starts, fewer, evidence, required)
        if not found:
            break
        best, reduced_evidence = found[0], evidence
        if best.evidence > evidence:
            reduced_evidence = max(evidence, evidence_without_one(first.timeline, best, current.refitted))
        if best.evidence - reduced_evidence < required:
            if not levels:
                return SearchResult(
                    [], _nearest(found, fixed_effects, best.evidence - reduced_evidence, required)
                )
            break
        if best.evidence < rival - MIN_GAIN_NATS:
            raise BelowRivalEvidence
        parameter_fit, found = _with_strengths_maximised(first.timeline, original, found)
        current = criticise(found[0].plant_model)
        levels.append(
            SearchLevel(current, found, parameter_fit, found[0].evidence - reduced_evidence, linear_gain)
        )
        evidence = found[0].evidence
        if current.silent:
            break
        starts = _extended_starts(levels[-1], first)
    return SearchResult(levels)


def _nearest(
    found: Sequence[Explanation], fixed: EffectSet, gain: float, required: float
) -> NearestEffect | None:
    known = {e.kind.name for e in fixed}
    tried = [e for e in found[0].effects if e.kind.name not in known]
    lead = found[0].evidence - found[1].evidence if len(found) > 1 else inf
    return NearestEffect(tried[0].with_positive_strength, gain, required, lead) if tried else None


def _fits_to_channels(current: Critique, starts: Sequence[EffectSet], centre: Everett) -> list[ParameterFit]:
    """Sets of effects fitted to the readings that do not depend on the output, if these alone show them.

    With a density identified without it, an effect on the input disturbs the positions, and a fit to all readings
    stops early. The measured current knows no density.
    """
    timeline, refitted = current.timeline, current.refitted
    own = refitted.data[refitted.coupled :]
    if not own.size:
        return []
    fits = [
        fit_parameters(p, timeline, current.plant_model, refitted, centre, independent=True) for p in starts
    ]
    return [f for f in fits if float(own @ own) - f.misfit > 2 * MIN_GAIN_NATS]


def _best_of_each_set(found: Iterable[tuple[PlantModel, Refit]]) -> list[tuple[PlantModel, Refit]]:
    """The likeliest model of each set of effects, likeliest first."""
    best: dict[tuple[str, ...], tuple[PlantModel, Refit]] = {}
    for model, refitted in found:
        names = tuple(sorted(e.kind.name for e in model.catalogue_effects))
        if names not in best or refitted.log_evidence > best[names][1].log_evidence:
            best[names] = model, refitted
    return sorted(best.values(), key=lambda pair: -pair[1].log_evidence)


def _required_gain_nats(levels: Sequence[SearchLevel]) -> float:
    """Least gain (nats) of one more effect."""
    first = levels[0].gain
    share = min(MIN_GAIN_FURTHER_SHARE * first, MIN_GAIN_FURTHER_CAP_NATS)
    return max(MIN_GAIN_FURTHER_NATS, share, NUMERICAL_SHARE * first)


def _starts(critique: Critique, count: int) -> list[Effect]:
    """The named candidates that gain most, at their best strengths.

    Not those that are a part of a classical density: what they gain is an error of the density, or of other readings.
    """
    ranked = [s.candidate for s in critique.best(len(critique.scores))]
    shown = [c for c in ranked if c.kind is not None and c.kind.shown_by]
    return [c.best(critique.refitted.data)[0] for c in shown[:count]]


def _extended_starts(level: SearchLevel, first: Critique) -> list[EffectSet]:
    """The best explanation with one more effect, and its rivals with the most promising one.

    Effects that were promising alone are tried again, because the first effect may have hidden them.
    """
    starts: dict[tuple[str, ...], EffectSet] = {}
    further = _starts(level.critique, FURTHER_TRIED) + _starts(first, FURTHER_TRIED)
    for k, found in enumerate(level.explanations[:RIVALS_KEPT]):
        own = set(found.names)
        others = [p for p in further if p.kind.name not in own]
        for p in others[:1] if k else others:
            start = (*(found.effects if k else level.best.effects), p)
            starts.setdefault(tuple(sorted(q.kind.name for q in start)), start)
    return list(starts.values())


def _with_strengths_maximised(
    timeline: Timeline, original: Everett, found: Sequence[Explanation]
) -> tuple[ParameterFit, tuple[Explanation, ...]]:
    """The explanations near the likeliest, at strengths of largest evidence, and the sds of the likeliest."""
    retained = [e for e in found if e.evidence > found[0].evidence - MAX_DEFICIT_NATS]
    both = sorted(
        (with_strengths_maximised(timeline, original, e) for e in retained),
        key=lambda pair: -pair[1].evidence,
    )
    return both[0][0], (*(e for _, e in both), *found[len(retained) :])


def _evaluated(
    first: Critique,
    original: Everett,
    current: Critique,
    starts: Sequence[EffectSet],
    fewer: EffectSet,
    evidence: float,
    required: float,
) -> tuple[float, tuple[Explanation, ...]]:
    """Refine all explanations with the present covariance, evaluate the best by likelihood; also the best linear
    gain.

    ``fewer`` are the best effects so far, and ``evidence`` is their log likelihood. There are no explanations if
    none fits better than these, or so little that it cannot become the ``required`` gain (nats).
    """
    timeline, centre = first.timeline, first.plant_model.hysteresis
    linear_gain = [fit_parameters(p, timeline, current.plant_model, current.refitted, centre) for p in starts]
    linear_gain.sort(key=lambda r: r.misfit)
    if fewer:
        now = fit_parameters(fewer, timeline, current.plant_model, current.refitted, centre)
        linear_gain = [r for r in linear_gain if now.misfit - r.misfit >= 2 * MIN_FURTHER_FIT_NATS]
        if not linear_gain:
            return 0.0, ()
    whole = float(current.refitted.data @ current.refitted.data)
    gain_before = (whole - linear_gain[0].misfit) / 2
    fits_to_channels = _fits_to_channels(current, starts, centre)
    if gain_before < MIN_FIT_SHARE * required and not fits_to_channels:
        return gain_before, ()
    retained = [
        r
        for r in linear_gain
        if r.misfit - linear_gain[0].misfit
        < max(2 * MAX_DEFICIT_NATS, LINEAR_DEFICIT_SHARE * (whole - linear_gain[0].misfit))
    ]
    retained = (retained if len(retained) > 1 else linear_gain)[:EVALUATED_MAX]
    start_fits = _best_of_each_set(
        joint_density_from_best_start(timeline, r.extended, original, current.refitted)
        for r in (*retained, *fits_to_channels)
    )
    start_fits[:DOUBLING_TRIED] = [
        doubled_strength_start(timeline, *start_fit, original, current.refitted)
        for start_fit in start_fits[:DOUBLING_TRIED]
    ]
    start_fits.sort(key=lambda found: -found[1].log_evidence)
    evaluated: list[Explanation] = []
    for plant_model, refitted in start_fits:
        lead = evaluated[0].evidence - refitted.log_evidence if evaluated else 0.0
        hopeless = lead > max(MAX_DEFICIT_NATS, MAX_DEFICIT_SHARE * (lead + refitted.log_evidence - evidence))
        evaluated.append(
            fit_explanation(timeline, plant_model, original, refitted, 0 if hopeless else MAX_ROUNDS)
        )
        evaluated.sort(key=lambda e: -e.evidence)
    return gain_before, tuple(evaluated)
