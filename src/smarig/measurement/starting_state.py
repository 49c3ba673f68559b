"""The state of a hysteresis at the start of a record: recorded, evident from its first input, or assumed.

Identification, verification and diagnosis use it, so they start a record in one state.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from smarig.measurement.input_record import reversals
from smarig.record import Run

Array = NDArray[np.float64]
Start = Literal["negative", "positive", "anhysteretic"]
STARTS: tuple[Start, ...] = ("negative", "positive", "anhysteretic")
SATURATION_TOLERANCE = 1e-3  # of the range: an input this close to saturation counts as saturated
START_SHARE = 0.1  # of the range: a start this close to an end of it is assumed to be saturated there


@dataclass(frozen=True)
class StartingState:
    """``state`` at the start of a record (None: unknown) and ``first``, its first row with a known memory.

    ``assumed``: neither recorded nor evident from the first input.
    """

    state: Start | None
    first: int = 0
    assumed: bool = False


def starting_state(
    initial: str | None,
    u: Array,
    ends: tuple[float, float],
    *,
    first_input: float | None = None,
    turns: Sequence[int] | None = None,
    may_assume: bool = True,
) -> StartingState:
    """The state at the start of inputs (n,) of an operator with saturation at ``ends`` = (u₋, u₊).

    ``initial`` is the recorded state. ``first_input``: the first input of the record, if that is not ``u[0]``. A record
    that starts within a tenth of the range from an end is assumed to start in saturation there. One half way is
    assumed to come from the saturation behind it, and is known from its first reversal (``turns``) on.

    >>> starting_state(None, np.array([0.0, 9.0, 1.0]), (0.0, 10.0))
    StartingState(state='negative', first=0, assumed=False)
    >>> starting_state(None, np.array([5.0, 9.0, 1.0]), (0.0, 10.0))
    StartingState(state='negative', first=1, assumed=True)
    """
    for name in STARTS:
        if initial == name:
            return StartingState(name)
    begin = float(u[0]) if first_input is None and u.size else first_input
    evident = _saturation(begin, ends, SATURATION_TOLERANCE)
    if evident or not may_assume or not u.size:
        return StartingState(evident)
    near = _saturation(float(u[0]), ends, START_SHARE)
    if near:
        return StartingState(near, assumed=True)
    turns = reversals(u) if turns is None else turns
    behind: Start = "negative" if u[turns[1]] > u[0] else "positive"
    return StartingState(behind, turns[1] if len(turns) > 2 else 0, assumed=True)


def _saturation(u: float | None, ends: tuple[float, float], share: float) -> Start | None:
    """The saturation that an input is in, or within a share of the range from it."""
    near = share * (ends[1] - ends[0])
    if u is not None and u <= ends[0] + near:
        return "negative"
    if u is not None and u >= ends[1] - near:
        return "positive"
    return None


def may_assume_start(run: Run) -> bool:
    """Whether an unknown state at the start of a run may be assumed: data of others with a measured input.

    The steps of a rig's own run are made in a state that the rig records.
    """
    return has_measured_input(run) and (run.info.source == "import" or not run.settled)


def has_measured_input(run: Run) -> bool:
    """Whether the input of a run was measured and not computed from a heating current."""
    has = run.has
    return has("input") and has("position") and not (has("current_A") or has("current_command_A"))
