"""What a wire remembers of its finished steps, and the way back there: the dominant extrema, in order.

Wiping-out (§3.3.1) says that nothing else is left of a history. Saturation wipes out everything, so the way begins at
the last one; where there was none, in the state that a run began in. Knows inputs; refuses to know rigs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from smarig.preisach.operator import Preisach
from smarig.preisach.relay_measure import RelayMeasure

Start = Literal["negative", "anhysteretic"]
SAME = 1e-6  # parts of the range


@dataclass(frozen=True)
class Way:
    """Inputs (K) to settle at one after the other; ``from_start``: out of the state that the run began in.

    Otherwise the first of them saturates, so that it does not matter where the way begins.
    """

    inputs_K: tuple[float, ...]
    from_start: bool


def way_back(
    inputs_K: Sequence[float | None], lower_K: float, upper_K: float, start: Start | None
) -> Way | None:
    """The way to what is remembered after settled inputs; None where it is unknown.

    None among the inputs is a stretch that nothing settled in (a waveform): what it left is unknown until the
    next saturation. ``start`` is the state before the first input, None where that is unknown.

    >>> way_back([0.0, 100.0, 20.0, 60.0, 20.0], 0.0, 174.0, "negative")
    Way(inputs_K=(0.0, 100.0, 20.0), from_start=False)
    >>> way_back([0.0, None, 20.0], 0.0, 174.0, "negative") is None
    True
    """
    tolerance = SAME * (upper_K - lower_K)
    memory = _began(start, lower_K, upper_K)
    for u in inputs_K:
        if u is None:
            memory = None
        elif u <= lower_K + tolerance:
            memory = Preisach(RelayMeasure.silent(lower_K, upper_K), "negative")
        elif u >= upper_K - tolerance:
            memory = Preisach(RelayMeasure.silent(lower_K, upper_K), "positive")
        elif memory is not None:
            memory.step(u)
    if memory is None:
        return None
    state = memory.state.reduced()
    turns = list(state.extrema[state.diagonal :])
    if not turns or turns[-1] != state.u:
        turns.append(state.u)
    if len(turns) > 1 and turns[1] >= upper_K - tolerance:
        turns = turns[1:]  # the upper saturation wipes out the lower one
    return Way(tuple(turns), bool(state.diagonal))


def _began(start: Start | None, lower_K: float, upper_K: float) -> Preisach | None:
    if start is None:
        return None
    reach = max(-lower_K, upper_K)
    lower_K, upper_K = (-reach, reach) if start == "anhysteretic" else (lower_K, upper_K)
    return Preisach(RelayMeasure.silent(lower_K, upper_K), start)
