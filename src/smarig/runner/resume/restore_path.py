"""What a wire remembers of its finished steps, and the way back there: the dominant extrema, in order.

Wiping-out (§3.3.1) says that nothing else is left of a history. Saturation wipes out everything, so the way begins at
the last one; where there was none, in the state that a run began in. Knows inputs; refuses to know rigs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach

StartState = Literal["negative", "anhysteretic"]
SAME_INPUT = 1e-6  # parts of the range


@dataclass(frozen=True)
class RestorePath:
    """Inputs (K) to settle at one after the other; ``from_start``: out of the state that the run began in.

    Otherwise the first of them saturates, so that it does not matter where the way begins.
    """

    inputs_K: tuple[float, ...]
    from_start: bool


def find_restore_path(
    inputs_K: Sequence[float | None], lower_K: float, upper_K: float, start: StartState | None
) -> RestorePath | None:
    """The way to what is remembered after settled inputs; None where it is unknown.

    None among the inputs is a stretch that nothing settled in (a waveform): what it left is unknown until the
    next saturation. ``start`` is the state before the first input, None where that is unknown.

    >>> find_restore_path([0.0, 100.0, 20.0, 60.0, 20.0], 0.0, 174.0, "negative")
    RestorePath(inputs_K=(0.0, 100.0, 20.0), from_start=False)
    >>> find_restore_path([0.0, None, 20.0], 0.0, 174.0, "negative") is None
    True
    """
    tolerance = SAME_INPUT * (upper_K - lower_K)
    memory = _initial_memory(start, lower_K, upper_K)
    for u in inputs_K:
        if u is None:
            memory = None
        elif u <= lower_K + tolerance:
            memory = Preisach(RelayMeasure.zero(lower_K, upper_K), "negative")
        elif u >= upper_K - tolerance:
            memory = Preisach(RelayMeasure.zero(lower_K, upper_K), "positive")
        elif memory is not None:
            memory.step(u)
    if memory is None:
        return None
    state = memory.state.reduced()
    extrema_K = list(state.extrema[state.diagonal :])
    if not extrema_K or extrema_K[-1] != state.u:
        extrema_K.append(state.u)
    if len(extrema_K) > 1 and extrema_K[1] >= upper_K - tolerance:
        extrema_K = extrema_K[1:]  # the upper saturation wipes out the lower one
    return RestorePath(tuple(extrema_K), bool(state.diagonal))


def _initial_memory(start: StartState | None, lower_K: float, upper_K: float) -> Preisach | None:
    if start is None:
        return None
    reach = max(-lower_K, upper_K)
    lower_K, upper_K = (-reach, reach) if start == "anhysteretic" else (lower_K, upper_K)
    return Preisach(RelayMeasure.zero(lower_K, upper_K), start)
