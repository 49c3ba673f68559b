"""The state of a hysteresis at the start of a record: recorded, evident from its first input, or assumed.

Identification, verification and diagnosis use it, so they start a record in one state.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.measurement.input_record import PART_OF, input_noise_sd, noise_range, reversals
from smarig.measurement.loop_direction import branch_outputs
from smarig.record import Run

Start = Literal["negative", "positive", "anhysteretic"]
STARTS: tuple[Start, ...] = ("negative", "positive", "anhysteretic")
SATURATION_TOLERANCE = 1e-3  # of the range: an input this close to saturation counts as saturated
START_SHARE = 0.1  # of the range: a start this close to an end of it is assumed to be saturated there
LEVELS = np.linspace(0.1, 0.9, 9)  # of a branch, at which two are compared
OTHER_STATE = (
    0.1  # of the output's range: a first branch that differs by less from the later ones is one of them
)
FEWEST_LATER = 3  # branches: of fewer, a drift tells the first apart as well
TIMES_SPREAD = 3.0  # times their own differences: the same


@dataclass(frozen=True)
class StartingState:
    """``state`` at the start of a record (None: unknown) and ``first``, its first row with a known memory.

    ``assumed``: neither recorded nor evident from the first input. ``contradicted``: the first branch is none of those
    that start in this state later, so the memory is known from its end on.
    """

    state: Start | None
    first: int = 0
    assumed: bool = False
    contradicted: bool = False


def starting_state(
    initial: str | None,
    u: Array,
    ends: tuple[float, float],
    *,
    first_input: float | None = None,
    turns: Sequence[int] | None = None,
    may_assume: bool = True,
    outputs: Array | None = None,
    noise: float = 0.0,
) -> StartingState:
    """The state at the start of inputs (n,) of an operator with saturation at ``ends`` = (u₋, u₊).

    ``initial`` is the recorded state. ``first_input``: the first input of the record, if that is not ``u[0]``. A record
    that starts within a tenth of the range from an end is assumed to start in saturation there, unless its ``outputs``
    (n,) contradict that; ``noise``: the range of that of a measured input, within which a start is at an end. One half
    way is assumed to come from the saturation behind it. Where the state is not that of a saturation, the memory is
    known from the first reversal (``turns``) on.

    >>> starting_state(None, np.array([0.0, 9.0, 1.0]), (0.0, 10.0)).state
    'negative'
    >>> starting_state(None, np.array([5.0, 9.0, 1.0]), (0.0, 10.0)).first
    1
    """
    for name in STARTS:
        if initial == name:
            return StartingState(name)
    begin = float(u[0]) if first_input is None and u.size else first_input
    share = noise / (ends[1] - ends[0]) if ends[1] > ends[0] else 0.0
    evident = _saturation(begin, ends, max(SATURATION_TOLERANCE, min(share, START_SHARE)))
    if not may_assume or not u.size:
        return StartingState(evident)
    turns = reversals(u) if turns is None else turns
    near = evident or _saturation(float(u[0]), ends, START_SHARE)
    moved = _after_rest(u, turns)
    if near and outputs is not None and first_branch_differs(u, outputs, moved):
        return StartingState(near, moved[1], assumed=True, contradicted=True)
    if near:
        return StartingState(near, assumed=not evident)
    behind: Start = "negative" if u[turns[1]] > u[0] else "positive"
    return StartingState(behind, turns[1] if len(turns) > 2 else 0, assumed=True)


def _after_rest(u: Array, turns: Sequence[int]) -> list[int]:
    """The turns without those at the beginning that noise makes while the input rests."""
    kept, noise = list(turns), noise_range(u)
    while len(kept) > 2 and abs(u[kept[1]] - u[kept[0]]) <= noise:
        del kept[1]
    return kept


def first_branch_differs(u: Array, y: Array, turns: Sequence[int]) -> bool:
    """Whether the first branch of inputs and outputs (n,) is none of those that start at the same end later, or the
    output never comes back to its first value there: the specimen began in another state. False if these are too few.

    >>> u, first = np.array([0.0, 9, 0, 9, 0, 9, 0, 9]), np.array([5.0, 9, 0, 9, 0, 9, 0, 9])
    >>> first_branch_differs(u, first, range(8)), first_branch_differs(u, u, range(8))
    (True, False)
    """
    if len(turns) < 2:
        return False
    near = START_SHARE * float(np.ptp(u))
    begin, end = float(u[turns[0]]), float(u[turns[1]])
    later = [
        (a, b)
        for a, b in pairwise(turns[1:])
        if abs(u[a] - begin) <= near and (u[b] - u[a]) * (end - begin) > 0
    ]
    later = [(a, b) for a, b in later if abs(u[b] - end) <= near]
    if len(later) < FEWEST_LATER:
        return _never_comes_back(u, y, turns)
    at = begin + LEVELS * (end - begin)
    branches = np.array([branch_outputs(u[a : b + 1], y[a : b + 1], at) for a, b in later])
    usual = np.median(branches, axis=0)
    spread = float(np.max(np.sqrt(np.mean((branches - usual) ** 2, axis=1))))
    first = slice(turns[0], turns[1] + 1)
    apart = root_mean_square(branch_outputs(u[first], y[first], at) - usual)
    return apart > max(OTHER_STATE * float(np.ptp(y)), TIMES_SPREAD * spread)


def _never_comes_back(u: Array, y: Array, turns: Sequence[int]) -> bool:
    """Whether the output is not its first value where the input is back at its first one, although it is the same at
    the other end of the first branch: that end wiped out another state. A drift or training moves both.
    """
    steps = np.abs(np.diff(u))
    resolution = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    at_start, at_end = (
        [_output_at_turn(u, y, t, resolution) for t in turns if abs(u[t] - u[turns[k]]) <= resolution]
        for k in (0, 1)
    )
    if min(len(at_start), len(at_end)) < 2:
        return False
    first, *later = at_start
    least = max(
        float(np.ptp(later)),
        float(np.ptp(at_end)),
        input_noise_sd(y),
        SATURATION_TOLERANCE * float(np.ptp(y)),
    )
    return abs(first - float(np.median(later))) > TIMES_SPREAD * least


def _output_at_turn(u: Array, y: Array, turn: int, resolution: float) -> float:
    """The median output of the rows around a turn in which the input stays there."""
    away = np.flatnonzero(np.abs(u - u[turn]) > resolution)
    k = int(np.searchsorted(away, turn))
    begin = int(away[k - 1]) + 1 if k else 0
    return float(np.median(y[begin : int(away[k]) if k < away.size else None]))


def _saturation(u: float | None, ends: tuple[float, float], share: float) -> Start | None:
    """The saturation that an input is in, or within a share of the range from it."""
    near = share * (ends[1] - ends[0])
    if u is not None and u <= ends[0] + near:
        return "negative"
    if u is not None and u >= ends[1] - near:
        return "positive"
    return None


def may_assume_start(run: Run) -> bool:
    """Whether an unknown state at the start of a run may be assumed: data of others with a measured input, which may be
    the current itself where one record was cut in parts.

    The steps of a rig's own run are made in a state that the rig records.
    """
    imported = run.info.source == "import"
    if imported and run.info.input.quantity == "current" and (run.meta.get("imported") or {}).get(PART_OF):
        return run.has("input") and run.has("position")
    return has_measured_input(run) and (imported or not run.settled)


def noise_at_start(run: Run) -> float:
    """The range of the noise of an input that others measured as the heating current, by which a first reading may
    miss the end at which the wire rests; 0 where the state may be assumed anyway, and for computed inputs.
    """
    imported = run.info.source == "import" and run.info.input.quantity == "current" and not run.settled
    u = run["input"][np.isfinite(run["input"])] if imported and run.has("input") else np.empty(0)
    return noise_range(u) if u.size > 2 and not may_assume_start(run) else 0.0


def has_measured_input(run: Run) -> bool:
    """Whether the input of a run was measured and not computed from a heating current."""
    has = run.has
    return has("input") and has("position") and not (has("current_A") or has("current_command_A"))
