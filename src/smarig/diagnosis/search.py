"""Which effects, together, explain a story: forward from the best single one, rivals kept, everything refitted.

An explanation is worth the log likelihood of all readings when its effects are in, the density is identified anew
beside them, and noise and smoothness are the likeliest again: so a large effect is not judged by straight lines, and
no rival by the misfit of another. Stops when nothing stands out any more, or nothing named is worth its name.
Decides nothing: see ``verdict``.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from smarig.diagnosis.critique import Critique
from smarig.diagnosis.density_beside import density_anew
from smarig.diagnosis.explanation import TURNS, Explanation, explained, strong, topped, without
from smarig.diagnosis.refine import Refined, refined
from smarig.model.effect import Planted
from smarig.preisach.everett import Everett
from smarig.story.subject import Subject
from smarig.story.told import Story

Judge = Callable[[Subject], Critique]
Start = tuple[Planted, ...]
TRIED = 6  # single explanations refined
DOUBTED = 3  # the same where nothing stands out of the noise that all might be
BESIDE = 3  # further effects tried beside an accepted one, of those that stand out now, and at first
RIVALS = 3  # explanations kept from size to size
DOUBLED = 2  # of those weighed, likeliest first, those that are tried twice as strong
WEIGHED = 4  # explanations whose likelihood is taken
MOST = 3  # effects at once
GATE = 18.0  # nats: an effect that explains less is not worth its name
GATE_SILENT = 25.0  # nats: the same where nothing stands out of the noise that all might be
GATE_MORE = 25.0  # nats: a further effect, lest it be an echo of the first
SHARE_MORE = 0.05  # of the first one's nats, for the same reason
MOST_MORE = 60.0  # nats that are always enough
BEHIND = 60.0  # nats: an explanation so far behind is not weighed
FAR_BEHIND = 0.25  # of the nats that the best explains: nor is one so far behind, where that is more
ROUGHLY = 0.5  # of what the best explains: straight lines are no better a judge of large effects


class Outdone(Exception):
    """No single effect explains as much as a rival does."""


@dataclass(frozen=True, eq=False)
class Level:
    """Explanations of one size, likeliest first; ``critique`` judges the wire with the best, ``best`` its parameters.

    ``gain`` is the best's log likelihood over that of the best explanation with one effect less; ``rough`` (nats) the
    part of it that straight lines see.
    """

    critique: Critique
    explanations: tuple[Explanation, ...]
    best: Refined
    gain: float
    rough: float

    def lead(self, k: int) -> float:
        """Nats by which the best is likelier than explanation k."""
        return self.explanations[0].evidence - self.explanations[k].evidence


def searched(
    first: Critique,
    given: Everett,
    judge: Judge,
    evidence: float,
    gate: float = GATE,
    tried: int = TRIED,
    rival: float = float("-inf"),
    most: int = MOST,
) -> list[Level]:
    """Levels of one, two, … effects, as long as something stands out and is explained.

    ``given`` is the model's own hysteresis, ``judge`` makes a critique of a subject, ``evidence`` is the log
    likelihood without any effect, ``gate`` (nats) what the first must explain, ``tried`` how many are. Raises Outdone
    when no single one comes near ``rival``, the log likelihood of something else.
    """
    if first.silent:
        return []
    known = first.subject.planted  # is fitted again
    starts: Sequence[Start] = [(*known, p) for p in _starts(first, tried)]
    levels: list[Level] = []
    now = first
    while starts and len(levels) < most:
        rough, found = _weighed(first, given, now, starts, evidence)
        best, less = found[0], evidence
        if best.evidence > evidence:
            less = max(evidence, without(first.story, best, now.refitted))
        if best.evidence - less < (_needed(levels) if levels else gate):
            break
        if best.evidence < rival - GATE:
            raise Outdone
        fine, found = _topped(first.story, given, found)
        now = judge(found[0].subject)
        levels.append(Level(now, found, fine, found[0].evidence - less, rough))
        evidence = found[0].evidence
        if now.silent:
            break
        starts = _larger(levels[-1], first)
    return levels


def _needed(levels: Sequence[Level]) -> float:
    """Nats that one effect more must explain."""
    return max(GATE_MORE, min(SHARE_MORE * levels[0].gain, MOST_MORE))


def _starts(critique: Critique, count: int) -> list[Planted]:
    """Named candidates that gain most, each at its best."""
    return [s.candidate.best(critique.refitted.data)[0] for s in critique.best(count)]


def _larger(level: Level, first: Critique) -> list[Start]:
    """One more effect beside the best explanation, and the most promising one beside its rivals.

    What was worth trying alone is worth trying beside: a first effect may have hidden it.
    """
    starts: dict[tuple[str, ...], Start] = {}
    beside = _starts(level.critique, BESIDE) + _starts(first, BESIDE)
    for k, found in enumerate(level.explanations[:RIVALS]):
        own = set(found.names)
        others = [p for p in beside if p.kind.name not in own]
        for p in others[:1] if k else others:
            start = (*(found.effects if k else level.best.effects), p)
            starts.setdefault(tuple(sorted(q.kind.name for q in start)), start)
    return list(starts.values())


def _topped(
    story: Story, given: Everett, found: Sequence[Explanation]
) -> tuple[Refined, tuple[Explanation, ...]]:
    """All that are near the likeliest with their strengths likeliest, and the deviations of the likeliest then."""
    near = [e for e in found if e.evidence > found[0].evidence - BEHIND]
    both = sorted((topped(story, given, e) for e in near), key=lambda pair: -pair[1].evidence)
    return both[0][0], (*(e for _, e in both), *found[len(near) :])


def _weighed(
    first: Critique, given: Everett, now: Critique, starts: Sequence[Start], evidence: float
) -> tuple[float, tuple[Explanation, ...]]:
    """Refine all under the covariance at hand, weigh the best by likelihood; and the best's gain before that.

    ``evidence`` is the log likelihood with one effect less.
    """
    story, centre = first.story, first.subject.hysteresis
    rough = [refined(p, story, now.subject, now.refitted, centre) for p in starts]
    rough.sort(key=lambda r: r.misfit)
    whole = float(now.refitted.data @ now.refitted.data)
    near = [
        r for r in rough if r.misfit - rough[0].misfit < max(2 * BEHIND, ROUGHLY * (whole - rough[0].misfit))
    ]
    near = (near if len(near) > 1 else rough)[:WEIGHED]
    begins = [density_anew(story, r.extended, given, now.refitted) for r in near]
    begins.sort(key=lambda found: -found[1].log_evidence)
    begins[:DOUBLED] = [strong(story, *begin, given, now.refitted) for begin in begins[:DOUBLED]]
    begins.sort(key=lambda found: -found[1].log_evidence)
    weighed: list[Explanation] = []
    for subject, refitted in begins:
        lead = weighed[0].evidence - refitted.log_evidence if weighed else 0.0
        hopeless = lead > max(BEHIND, FAR_BEHIND * (lead + refitted.log_evidence - evidence))
        weighed.append(explained(story, subject, given, refitted, 0 if hopeless else TURNS))
        weighed.sort(key=lambda e: -e.evidence)
    gained = (whole - rough[0].misfit) / 2
    return gained, tuple(weighed)
