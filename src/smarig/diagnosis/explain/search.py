"""Which effects, together, explain a story: forward from the best single one, rivals kept, everything refitted.

An explanation is worth the log likelihood of all readings when its effects are in, the density is identified anew
beside them, and noise and smoothness are the likeliest again: so a large effect is not judged by straight lines, and
no rival by the misfit of another. Stops when nothing stands out any more, or nothing named is worth its name.
Decides nothing: see ``verdict``.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

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
from smarig.plant import Effect
from smarig.preisach import Everett
from smarig.replay import PlantModel, Timeline

CritiqueFunction = Callable[[PlantModel], Critique]
EffectSet = tuple[Effect, ...]
SINGLE_TRIED = 6  # single explanations refined
SINGLE_TRIED_IF_SILENT = 3  # the same where nothing stands out of the noise that all might be
FURTHER_TRIED = 3  # further effects tried beside an accepted one, of those that stand out now, and at first
RIVALS_KEPT = 3  # explanations kept from size to size
DOUBLING_TRIED = 2  # of those weighed, likeliest first, those that are tried twice as strong
EVALUATED_MAX = 4  # explanations whose likelihood is taken
MAX_EFFECTS = 3  # effects at once
MIN_GAIN_NATS = 18.0  # nats: an effect that explains less is not worth its name
MIN_GAIN_SILENT_NATS = 25.0  # nats: the same where nothing stands out of the noise that all might be
MIN_GAIN_FURTHER_NATS = 25.0  # nats: a further effect, lest it be an echo of the first
MIN_GAIN_FURTHER_SHARE = 0.05  # of the first one's nats, for the same reason
MIN_GAIN_FURTHER_CAP_NATS = 60.0  # nats that are always enough
MAX_DEFICIT_NATS = 60.0  # nats: an explanation so far behind is not weighed
MAX_DEFICIT_SHARE = 0.25  # of the nats that the best explains: nor is one so far behind, where that is more
LINEAR_DEFICIT_SHARE = 0.5  # of what the best explains: straight lines are no better a judge of large effects


class BelowRivalEvidence(Exception):
    """No single effect explains as much as a rival does."""


@dataclass(frozen=True, eq=False)
class SearchLevel:
    """Explanations of one size, likeliest first; ``critique`` judges the wire with the best, ``best`` its parameters.

    ``gain`` is the best's log likelihood over that of the best explanation with one effect less; ``linear_gain``
    (nats) the part of it that straight lines see.
    """

    critique: Critique
    explanations: tuple[Explanation, ...]
    best: ParameterFit
    gain: float
    linear_gain: float

    def lead(self, k: int) -> float:
        """Nats by which the best is likelier than explanation k."""
        return self.explanations[0].evidence - self.explanations[k].evidence


def search_explanations(
    first: Critique,
    original: Everett,
    criticise: CritiqueFunction,
    evidence: float,
    gate: float = MIN_GAIN_NATS,
    tried: int = SINGLE_TRIED,
    rival: float = float("-inf"),
    most: int = MAX_EFFECTS,
) -> list[SearchLevel]:
    """Levels of one, two, … effects, as long as something stands out and is explained.

    ``original`` is the model's own hysteresis, ``criticise`` makes a critique of a subject, ``evidence`` is the log
    likelihood without any effect, ``gate`` (nats) what the first must explain, ``tried`` how many are. Raises Outdone
    when no single one comes near ``rival``, the log likelihood of something else.
    """
    if first.silent:
        return []
    fixed_effects = first.plant_model.catalogue_effects  # is fitted again
    starts: Sequence[EffectSet] = [(*fixed_effects, p) for p in _starts(first, tried)]
    levels: list[SearchLevel] = []
    current = first
    while starts and len(levels) < most:
        linear_gain, found = _evaluated(first, original, current, starts, evidence)
        best, reduced_evidence = found[0], evidence
        if best.evidence > evidence:
            reduced_evidence = max(evidence, evidence_without_one(first.timeline, best, current.refitted))
        if best.evidence - reduced_evidence < (_required_gain_nats(levels) if levels else gate):
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
    return levels


def _required_gain_nats(levels: Sequence[SearchLevel]) -> float:
    """Nats that one effect more must explain."""
    return max(MIN_GAIN_FURTHER_NATS, min(MIN_GAIN_FURTHER_SHARE * levels[0].gain, MIN_GAIN_FURTHER_CAP_NATS))


def _starts(critique: Critique, count: int) -> list[Effect]:
    """Named candidates that gain most, each at its best."""
    return [s.candidate.best(critique.refitted.data)[0] for s in critique.best(count)]


def _extended_starts(level: SearchLevel, first: Critique) -> list[EffectSet]:
    """One more effect beside the best explanation, and the most promising one beside its rivals.

    What was worth trying alone is worth trying beside: a first effect may have hidden it.
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
    """All that are near the likeliest with their strengths likeliest, and the deviations of the likeliest then."""
    retained = [e for e in found if e.evidence > found[0].evidence - MAX_DEFICIT_NATS]
    both = sorted(
        (with_strengths_maximised(timeline, original, e) for e in retained),
        key=lambda pair: -pair[1].evidence,
    )
    return both[0][0], (*(e for _, e in both), *found[len(retained) :])


def _evaluated(
    first: Critique, original: Everett, current: Critique, starts: Sequence[EffectSet], evidence: float
) -> tuple[float, tuple[Explanation, ...]]:
    """Refine all under the covariance at hand, weigh the best by likelihood; and the best's gain before that.

    ``evidence`` is the log likelihood with one effect less.
    """
    timeline, centre = first.timeline, first.plant_model.hysteresis
    linear_gain = [fit_parameters(p, timeline, current.plant_model, current.refitted, centre) for p in starts]
    linear_gain.sort(key=lambda r: r.misfit)
    whole = float(current.refitted.data @ current.refitted.data)
    retained = [
        r
        for r in linear_gain
        if r.misfit - linear_gain[0].misfit
        < max(2 * MAX_DEFICIT_NATS, LINEAR_DEFICIT_SHARE * (whole - linear_gain[0].misfit))
    ]
    retained = (retained if len(retained) > 1 else linear_gain)[:EVALUATED_MAX]
    start_fits = [
        joint_density_from_best_start(timeline, r.extended, original, current.refitted) for r in retained
    ]
    start_fits.sort(key=lambda found: -found[1].log_evidence)
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
    gain_before = (whole - linear_gain[0].misfit) / 2
    return gain_before, tuple(evaluated)
