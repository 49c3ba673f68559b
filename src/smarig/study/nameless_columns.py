"""Input and output of columns whose names say nothing: by their loop, by equal steps of one of them, and by numbers
that look like temperatures.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from smarig.core import shown
from smarig.study import quantity_words as q
from smarig.study.column_guess import (
    ASSUMED,
    LIKELY,
    UNSURE,
    WEAK,
    ColumnGuess,
    displacement_confidence,
    like_temperature,
)
from smarig.study.held_quantities import holds_still, is_noise
from smarig.study.physical_roles import RoleVote, role_vote

_LIKE_TEMPERATURE = 1.5  # votes: more than one fact of the loop, less than both
_SURE = 1.0  # votes
_NO_NAMES = "no name of a column says which is the input"


@dataclass(frozen=True)
class LoopRoles:
    """The input and the output of two columns, why, and the confidence; ``rivals``: why others could be the output."""

    drive: ColumnGuess
    out: ColumnGuess
    reason: str
    confidence: float
    rivals: str = ""


def roles_by_loop(drive: ColumnGuess, out: ColumnGuess) -> LoopRoles | None:
    """The roles of two columns whose names say nothing, exchanged if their loop says so; None if a name counts."""
    same_quantity = drive.quantity == out.quantity != ""  # two channels in V, for example
    if not (drive.by_numbers and out.by_numbers) and not same_quantity:
        return None
    vote = _with_steps(role_vote(drive.facts.values, out.facts.values), drive, out)
    prior = _LIKE_TEMPERATURE * ((drive.quantity == q.TEMPERATURE) - (out.quantity == q.TEMPERATURE))
    score = vote.score + prior
    if score == 0:
        return LoopRoles(drive, out, f"{_NO_NAMES}, and the loop does not tell input from output", UNSURE / 2)
    if score < 0:
        drive, out = out, drive
        if not same_quantity:
            drive = drive.without_meaning() if prior >= 0 else drive
            out = _with_displacement(out.without_meaning(), drive)
    reasons = [*vote.reasons] if vote.score * score > 0 else []
    reasons += ["it looks like a temperature"] if prior * score > 0 else []
    against = ", although its loop speaks against it" if vote.score * score < 0 else ""
    why = f"{_NO_NAMES}; {shown(drive.name)} is the input because {' and '.join(reasons)}{against}"
    return LoopRoles(drive, out, why, LIKELY if abs(score) >= _SURE else WEAK)


def doubt_by_loop(drive: ColumnGuess, out: ColumnGuess) -> str:
    """Why a column without a name is hardly the input beside an output that is given; "" if their loop agrees."""
    if not drive.by_numbers or role_vote(drive.facts.values, out.facts.values).score >= 0:
        return ""
    return f"{_NO_NAMES}, and its loop with {shown(out.name)} speaks against it as the input"


def unless_rivals(found: LoopRoles, left: Sequence[ColumnGuess]) -> LoopRoles:
    """Roles by a loop are a doubt if further columns without names could be the output: neither a copy of the input
    nor a further thermometer.
    """
    others = [c for c in left if c.name not in (found.drive.name, found.out.name)]
    rivals = [c for c in others if c.by_numbers or not (c.is_named or found.out.is_named)]
    rivals = [c for c in rivals if c.quantity in ("", found.out.quantity)]
    rivals = [c for c in rivals if not holds_still(c) and not is_noise(c)]
    rivals = [c for c in rivals if not _is_multiple(c, found.drive) and not like_temperature(c.facts)]
    if not rivals:
        return found
    names = ", ".join(f"{shown(c.name)}" for c in (found.out, *rivals))
    return replace(found, rivals=f"no name of a column says which is the output; it is one of {names}")


def _is_multiple(c: ColumnGuess, drive: ColumnGuess) -> bool:
    """Whether a column is the input in another unit, but for its last digits."""
    known = np.isfinite(c.facts.values) & np.isfinite(drive.facts.values)
    u, y = drive.facts.values[known], c.facts.values[known]
    if u.size < 3 or not np.ptp(u):
        return False
    rest = y - np.polyval(np.polyfit(u, y, 1), u)
    return bool(np.abs(rest).max() <= c.facts.step)


def _with_steps(vote: RoleVote, drive: ColumnGuess, out: ColumnGuess) -> RoleVote:
    """The vote with that of a column in equal steps: it was set, and the other was read. It counts as the loop does,
    and it alone where there are too few rows for a loop.
    """
    found = int(drive.facts.even) - int(out.facts.even)
    if not found:
        return vote
    reasons = vote.reasons if vote.score * found > 0 else ()
    return RoleVote(vote.score + found, (*reasons, "it goes in equal steps, as a value that is set"))


def _with_displacement(out: ColumnGuess, drive: ColumnGuess) -> ColumnGuess:
    """An output beside a temperature is a displacement in mm, unless it is known better."""
    if out.quantity or drive.quantity != q.TEMPERATURE:
        return out
    return replace(
        out,
        quantity=q.DISPLACEMENT,
        quantity_reason="what moves beside a temperature",
        quantity_confidence=0.6,
        unit="mm",
        unit_reason=ASSUMED,
        unit_confidence=displacement_confidence(out),
        unit_by_numbers=True,
    )
