"""A named hypothesis of a theorem: whether it holds, and why, in a sentence. Knows no theorem."""

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Hypothesis:
    """``holds`` is None where nothing could be decided; ``why`` is the reason, a sentence without its full stop."""

    name: str
    holds: bool | None
    why: str

    @property
    def text(self) -> str:
        """One line for a report."""
        return f"{self.name}: {_WORDS[self.holds]}: {self.why}."


_WORDS = {True: "holds", False: "fails", None: "not decided"}


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
    """Those that do not hold, or are not known to."""
    return tuple(h for h in hypotheses if h.holds is not True)
