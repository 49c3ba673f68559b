"""A named hypothesis of a theorem: whether it holds, and the reason."""

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Hypothesis:
    """``holds`` is None if not decided; ``why`` is the reason, a sentence without its full stop."""

    name: str
    holds: bool | None
    why: str

    @property
    def text(self) -> str:
        """A sentence for a report; symbols keep their case.

        >>> Hypothesis("passive", False, "some loop gives energy back").text
        'Passive: no, some loop gives energy back.'
        >>> Hypothesis("u(0) = 0", True, "the loop starts at zero").text
        'u(0) = 0: yes, the loop starts at zero.'
        """
        first = self.name.split(" ")[0]
        name = self.name[:1].upper() + self.name[1:] if first.isascii() and first.isalpha() else self.name
        return f"{name}: {_WORDS[self.holds]}, {self.why}."


_WORDS = {True: "yes", False: "no", None: "not decided"}


def all_hold(hypotheses: Iterable[Hypothesis]) -> bool | None:
    """True if all hold, False if one fails, None if none fails and one is not decided.

    >>> all_hold([Hypothesis("a", True, "seen"), Hypothesis("b", None, "not looked at")]) is None
    True
    """
    verdicts = [h.holds for h in hypotheses]
    if False in verdicts:
        return False
    return None if None in verdicts else True


def failing(hypotheses: Iterable[Hypothesis]) -> tuple[Hypothesis, ...]:
    """The hypotheses that do not hold or are not decided."""
    return tuple(h for h in hypotheses if h.holds is not True)


def coverage(hypotheses: Iterable[Hypothesis]) -> str:
    """Whether a theorem covers its subject, and the hypotheses that fail or are open.

    >>> coverage([Hypothesis("passive", False, "seen"), Hypothesis("u(0) = 0", True, "seen")])
    'not covered: passive fails'
    """
    found = tuple(hypotheses)
    holds = all_hold(found)
    if holds:
        return "covered"
    unmet = [h.name for h in found if h.holds is holds]
    names, one = ", ".join(unmet), len(unmet) == 1
    if holds is None:
        return f"not decided: {names} {'is' if one else 'are'} open"
    return f"not covered: {names} {'fails' if one else 'fail'}"
