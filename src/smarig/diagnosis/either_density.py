"""What explains a story beside a positive density, or beside one that is negative somewhere (Prop. 4.6).

A wire's density should be positive, so effects are looked for beside such a one first; a negative one is believed
where it is likelier than all they explain. Takes no verdict.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

from smarig.diagnosis.critique import Critique
from smarig.diagnosis.density_beside import density_anew
from smarig.diagnosis.refit import Refit
from smarig.diagnosis.search import DOUBTED, GATE, GATE_SILENT, Level, Outdone, searched
from smarig.preisach.everett import Everett
from smarig.story.subject import Subject
from smarig.story.told import Story

Judge = Callable[..., Critique]
Say = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Found:
    """A base without effects, its readings refitted, its critique, and levels of what explains more."""

    base: Subject
    plain: Refit
    first: Critique
    levels: list[Level]

    @property
    def evidence(self) -> float:
        """The log likelihood that a density must beat which is negative somewhere."""
        return self.levels[-1].explanations[0].evidence if self.levels else self.plain.log_evidence + GATE


def found(story: Story, subject: Subject, judge: Judge, say: Say) -> Found:
    """What explains a story told by a subject, beside the density that is to be believed."""
    given = subject.hysteresis
    base, plain = density_anew(story, subject, given)
    positive = Found(base, plain, judge(base), [])
    if positive.first.silent or story.given:
        positive = _searched(positive, given, judge, say)
        if positive.first.silent or story.given:
            return positive
    signed = density_anew(story, replace(subject, signed=True), given)
    return _either(positive, signed, given, judge, say)


def _either(positive: Found, signed: tuple[Subject, Refit], given: Everett, judge: Judge, say: Say) -> Found:
    """The positive density and what explains more, unless the signed one is likelier than that.

    Where no single effect comes near the signed density, that is asked first: if nothing is found beside it,
    no more is looked for beside the other.
    """
    negative: Found | None = None

    def beside_signed() -> Found:
        say("with a density that is negative somewhere")
        return _searched(Found(*signed, judge(signed[0]), []), given, judge, say)

    try:
        if not positive.levels:
            positive = _searched(positive, given, judge, say, signed[1].log_evidence)
    except Outdone:
        negative = beside_signed()
        if not negative.levels:
            return negative
        positive = _searched(positive, given, judge, say)
    if signed[1].log_evidence <= positive.evidence:
        return positive
    return negative or beside_signed()


def _searched(base: Found, given: Everett, judge: Judge, say: Say, rival: float = float("-inf")) -> Found:
    """With levels of what the search finds beside a base; ``rival`` as in ``searched``.

    Where nothing stands out, a large effect may have passed for noise: with as little noise as there may be, an
    explanation that is beyond doubt is looked for, and if there is one, the noise is what it leaves.
    """
    first, evidence = base.first, base.plain.log_evidence

    def judged(subject: Subject) -> Critique:
        say("with " + " and ".join(e.kind.name for e in subject.planted))
        return judge(subject, like=first)

    if not first.silent:
        return replace(base, levels=searched(first, given, judged, evidence, rival=rival))
    levels = searched(judge(base.base, wary=True), given, judged, evidence, GATE_SILENT, DOUBTED)
    again = judge(base.base, noise_of=levels[0].critique) if levels else first
    return base if again.silent else replace(base, first=again, levels=levels)
