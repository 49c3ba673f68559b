"""Which effects, together, explain a story: forward from the best single one, rivals kept, everything refitted.

An explanation is worth the log likelihood of all readings when its effects are in, the density is identified anew
beside them, and noise and smoothness are the likeliest again: so a large effect is not judged by straight lines, and
no rival by the misfit of another. Stops when nothing stands out any more, or nothing named is worth its name.
Decides nothing: see ``verdict``.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from smarig.diagnosis.critique import Critique
from smarig.diagnosis.density_beside import density_anew, density_beside
from smarig.diagnosis.refine import Refined, refined
from smarig.diagnosis.refit import Refit
from smarig.model.effect import Planted
from smarig.preisach.everett import Everett
from smarig.story.subject import Subject
from smarig.story.told import Story

Judge = Callable[[Subject], Critique]
Start = tuple[Planted, ...]
TRIED = 6  # single explanations refined
BESIDE = 3  # further effects tried beside an accepted one, of those that stand out now, and at first
RIVALS = 3  # explanations kept from size to size
WEIGHED = 4  # explanations whose likelihood is taken
MOST = 3  # effects at once
TURNS = 5  # of effects, then density
FARTHER, FASTER = 1.7, 1.4  # what a fit says, times; and that again after a step that was right
STILL = 0.3  # standard deviations: less is no move
GATE = 12.0  # nats: an effect that explains less is not worth its name
GATE_SILENT = 20.0  # nats: the same where nothing stands out of the noise that all might be
GATE_MORE = 20.0  # nats: a further effect, lest it be an echo of the first
SHARE_MORE = 0.05  # of the first one's nats, for the same reason
MOST_MORE = 60.0  # nats that are always enough
BEHIND = 60.0  # nats: an explanation so far behind is not weighed
ROUGHLY = 0.5  # of what the best explains: straight lines are no better a judge of large effects


@dataclass(frozen=True, eq=False)
class Explanation:
    """Effects with the wire's density beside them, and the log likelihood of all readings."""

    effects: tuple[Planted, ...]
    subject: Subject
    evidence: float

    @property
    def names(self) -> tuple[str, ...]:
        """Of the effects, in order."""
        return tuple(sorted(p.kind.name for p in self.effects))


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
    first: Critique, given: Everett, judge: Judge, evidence: float, gate: float = GATE, most: int = MOST
) -> list[Level]:
    """Levels of one, two, … effects, as long as something stands out and is explained.

    ``given`` is the model's own hysteresis, ``judge`` makes a critique of a subject, ``evidence`` is the log
    likelihood without any effect, ``gate`` (nats) what the first must explain.
    """
    if first.silent:
        return []
    starts = [
        (*first.subject.planted, p) for p in _starts(first, TRIED)
    ]  # what the model knew is fitted again
    levels: list[Level] = []
    now = first
    while starts and len(levels) < most:
        rough, explained = _weighed(first, given, now, starts)
        less = (
            _without(first.story, explained[0], now.refitted)
            if explained[0].evidence > evidence
            else evidence
        )
        gain = explained[0].evidence - max(evidence, less)
        if gain < (_needed(levels) if levels else gate):
            break
        now = judge(explained[0].subject)
        best = refined(explained[0].effects, first.story, now.subject, now.refitted, now.subject.hysteresis)
        levels.append(Level(now, explained, best, gain, rough))
        evidence = explained[0].evidence
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


def _weighed(
    first: Critique, given: Everett, now: Critique, starts: Sequence[Start]
) -> tuple[float, tuple[Explanation, ...]]:
    """Refine all under the covariance at hand, weigh the best by likelihood; and the best's gain before that."""
    story, centre = first.story, first.subject.hysteresis
    rough = [refined(p, story, now.subject, now.refitted, centre) for p in starts]
    rough.sort(key=lambda r: r.misfit)
    whole = float(now.refitted.data @ now.refitted.data)
    near = [
        r for r in rough if r.misfit - rough[0].misfit < max(2 * BEHIND, ROUGHLY * (whole - rough[0].misfit))
    ]
    near = (near if len(near) > 1 else rough)[:WEIGHED]
    begins = [_strong(story, r.extended, given, now.refitted) for r in near]
    begins.sort(key=lambda found: -found[1].log_evidence)
    weighed: list[Explanation] = []
    for subject, refitted in begins:
        hopeless = weighed and refitted.log_evidence < weighed[0].evidence - BEHIND
        weighed.append(_explanation(story, subject, given, refitted, 0 if hopeless else TURNS))
        weighed.sort(key=lambda e: -e.evidence)
    gained = (whole - rough[0].misfit) / 2
    return gained, tuple(weighed)


def _strong(story: Story, subject: Subject, given: Everett, like: Refit) -> tuple[Subject, Refit]:
    """With a density of its own, at the first of once, twice, four times … the last strength that beats the next.

    A density hides most of what a weak effect does, so a fit beside the wrong one begins too low.
    """
    found = density_anew(story, subject, given, like)
    while True:
        *others, last = subject.planted
        primary, strength = last.kind.primary, 2 * last.strength
        if not (primary.lower <= strength <= primary.upper and strength):
            return found
        subject = replace(subject, effects=(*others, last.kind(**last.values | {primary.name: strength})))
        again = density_anew(story, subject, given, like)
        if again[1].log_evidence <= found[1].log_evidence:
            return found
        found = again


def _explanation(story: Story, subject: Subject, given: Everett, refitted: Refit, turns: int) -> Explanation:
    """Effects and the density that belongs to them, in turn, until neither moves the other.

    A density takes up part of every change of strength, so strengths go farther than each fit says.
    """
    farther = FARTHER
    for _ in range(turns):
        fine = refined(subject.planted, story, subject, refitted, subject.hysteresis)
        if fine.moved < STILL:
            break
        effects = fine.beyond(subject.planted, farther)
        other, again = density_anew(story, replace(subject, effects=effects), given, refitted)
        if again.log_evidence > refitted.log_evidence:
            subject, refitted, farther = other, again, FASTER * farther
        elif farther > 1.0:
            farther = 1.0
        else:
            break
    return Explanation(subject.planted, subject, refitted.log_evidence)


def _without(story: Story, best: Explanation, like: Refit) -> float:
    """The largest log likelihood that one effect less leaves, from the density of all: what fewer need explain."""
    less = [
        replace(best.subject, effects=tuple(e for e in best.subject.effects if e is not one))
        for one in best.effects
    ]
    return max(density_beside(story, subject, like)[1].log_evidence for subject in less)
