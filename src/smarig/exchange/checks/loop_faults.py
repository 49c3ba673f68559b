"""Findings on a hysteresis input and output: jumps, false reversals, wrong direction, open loops.

The checks assume that a hysteretic output lags its input. Each finding is one or two sentences.
"""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, spaced
from smarig.exchange.checks.channel_faults import quantum
from smarig.exchange.units.unit_conversion import dimension
from smarig.measurement import dropouts, first_branch_differs, noise_range, width_of_leading_loops
from smarig.preisach import turning_points
from smarig.record import ImportFinding, remarks

_RATES = ("heat flow", "power")
_REVERSAL = 0.2  # of the input's range: smallest branch
_JUMP = 0.1  # of the output's range, from one row to the next
_OPEN = 0.01  # of the output's range
_SAME = 0.05  # of the input's range: farther apart, visits are of two inputs, whatever the noise
_CONTRARY = 0.01  # of the input's range
_FEWEST_FALSE = 3  # rows: fewer are no noise
_CYCLE = 0.05  # of the input's range: smallest leg of a small cycle
_CYCLE_ROWS = 3  # fewest rows of such a leg
_ELONGATIONS, _FORCES = ("length", "ratio"), ("force", "stress or pressure")  # dimensions of what is pulled


@dataclass(frozen=True)
class LoopRecord:
    """Input ``u`` and output ``y`` (n,) in measured order, with their units and line numbers."""

    u: Array
    y: Array
    line: NDArray[np.int64]
    input_unit: str
    output_unit: str
    row: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    def where(self, mask: NDArray[np.bool_]) -> "LoopRecord":
        """The rows of a mask (n,)."""
        return LoopRecord(
            self.u[mask], self.y[mask], self.line[mask], self.input_unit, self.output_unit, self.row[mask]
        )

    def finite(self) -> "LoopRecord":
        """The rows in which both are known; ``row`` keeps their indices."""
        rows = np.flatnonzero(np.isfinite(self.u) & np.isfinite(self.y))
        return LoopRecord(
            self.u[rows], self.y[rows], self.line[rows], self.input_unit, self.output_unit, rows
        )


def _dropout_finding(loop: LoopRecord, lost: NDArray[np.bool_]) -> ImportFinding:
    text = (
        f"The input reads exactly 0 {loop.input_unit} in {int(lost.sum())} rows, far from the rows around them (first: "
        f"line {loop.line[lost][0]}): drop-outs of the instrument."
    )
    return ImportFinding(text, "drop-outs")


def loop_findings(loop: LoopRecord, *, designed: bool = False) -> list[ImportFinding]:
    """All findings on an input–output record; none for records that are too short or too flat, and for rates such as a
    heat flow, whose curve is no loop of a state.

    ``designed``: every point was commanded. Then large steps, small reversals and repeated visits with another
    memory belong to the experiment, and only the direction of the loop is checked.
    """
    known = loop.finite()
    if known.u.size < 10 or np.ptp(known.u) == 0 or np.ptp(known.y) == 0:
        return []
    if dimension(known.output_unit) in _RATES:
        return []
    turns = branch_ends(known.u, _REVERSAL * float(np.ptp(known.u)))
    if designed:
        return _wrong_direction(known, turns)
    lost = dropouts(known.u)
    if lost.any():
        kept = known.where(~lost)
        return [_dropout_finding(known, lost), *loop_findings(kept)]
    found = _jumps(known) + _false_reversals(known, turns)
    if first_branch_differs(known.u, known.y, turns):
        text = (
            "The first branch differs from all later ones from the same end of the input, or the output never comes "
            "back to where it began: the specimen began in another state. Fits start after it."
        )
        found.append(ImportFinding(text, "other starting state"))
        found += _not_closed(known, turns[1:])
    else:
        found += _not_closed(known, turns)
    # The output follows a current with the lag of the heating, so its loops in time do not show the hysteresis.
    direction = _wrong_direction(known, turns) if known.input_unit != "A" else []
    return found + direction + remarks(*_centre(known))


def branch_ends(u: Array, threshold: float) -> list[int]:
    """``turning_points`` of ``u`` (n,), but the first branch starts with the record, including its small moves.

    >>> branch_ends(np.array([0, -0.1, 1, 0.9, 3, 2, 0.5]), 1.0)
    [0, 4, 6]
    """
    turns = turning_points(u, threshold)
    while len(turns) > 2 and abs(u[turns[1]] - u[0]) <= threshold:
        del turns[1]
    return turns


def _jumps(loop: LoopRecord) -> list[ImportFinding]:
    limit = _JUMP * float(np.ptp(loop.y))
    alone = _lone_rows(loop, limit)
    step = np.where((np.diff(loop.row) == 1) & ~alone[:-1] & ~alone[1:], np.abs(np.diff(loop.y)), 0.0)
    large = step > limit
    if not large.any():
        return []
    k = int(np.argmax(step))
    text = (
        f"The output jumps by more than {100 * _JUMP:.0f} % of its range between neighbouring rows in "
        f"{int(large.sum())} place(s), at most {loop.y[k + 1] - loop.y[k]:+.4g}{spaced(loop.output_unit)} from line "
        f"{loop.line[k]} to {loop.line[k + 1]}: the values in between were not sampled."
    )
    return [ImportFinding(text, "jump")]


def _lone_rows(loop: LoopRecord, limit: float) -> NDArray[np.bool_]:
    """Rows (n,) off both neighbours, which are within ``limit``, where the input does not turn: outliers, no jumps."""
    back, turns = (
        np.diff(loop.y)[:-1] * np.diff(loop.y)[1:] < 0,
        np.diff(loop.u)[:-1] * np.diff(loop.u)[1:] < 0,
    )
    least = np.minimum(np.abs(np.diff(loop.u))[:-1], np.abs(np.diff(loop.u))[1:])
    alone = np.zeros(loop.y.size, dtype=bool)
    alone[1:-1] = (
        back & (np.abs(loop.y[2:] - loop.y[:-2]) <= limit) & ~(turns & (least > _same_input(loop.u)))
    )
    return alone


def _same_input(u: Array) -> float:
    """How far two readings of one input are apart by its noise."""
    return min(noise_range(u), _SAME * float(np.ptp(u)))


def _false_reversals(loop: LoopRecord, turns: list[int]) -> list[ImportFinding]:
    """Rows against the direction of their branch that are noise: not those of small cycles within it."""
    moves = np.diff(loop.u)
    direction = np.zeros(moves.size)
    for a, b in pairwise(turns):
        direction[a:b] = np.sign(loop.u[b] - loop.u[a])
    back = np.where((moves * direction < 0) & ~_small_cycles(loop.u), np.abs(moves), 0.0)
    false = back > _CONTRARY * np.ptp(loop.u)
    if false.sum() < _FEWEST_FALSE or false.mean() < 0.01:
        return []
    text = (
        f"The input moves opposite to the direction of its branch in {int(false.sum())} rows, by up to "
        f"{back.max():.3g} "
        f"{loop.input_unit} (small cycles not counted): a hysteresis model takes such noise for reversals. "
        f"Smooth it or use a threshold."
    )
    return [ImportFinding(text, "noisy input")]


def _small_cycles(u: Array) -> NDArray[np.bool_]:
    """Moves (n − 1,) on legs of several rows that are large against the scatter of the input: cycles, not noise."""
    span = float(np.ptp(u))
    found = np.zeros(u.size - 1, dtype=bool)
    for a, b in pairwise(sorted({0, *turning_points(u, _CONTRARY * span), u.size - 1})):
        found[a:b] = b - a >= _CYCLE_ROWS and abs(u[b] - u[a]) >= _CYCLE * span
    return found


def _not_closed(loop: LoopRecord, turns: list[int]) -> list[ImportFinding]:
    """Visits of one end of the whole input whose outputs differ.

    At such an end nothing else is remembered (wiping-out), so its visits are of one state. Turns at other inputs are
    not: their outputs differ by the hysteresis alone, and so do the first and last row of a record.
    """
    same = _same_input(loop.u)
    limit = max(_OPEN * float(np.ptp(loop.y)), 2 * (quantum(loop.y) or 0.0))
    out = []
    for end, extreme in (("low", loop.u.min()), ("high", loop.u.max())):
        y = loop.y[[k for k in turns if abs(loop.u[k] - extreme) <= same]]
        if y.size > 1 and abs(y[-1] - y[0]) > max(limit, _noise_at(loop, float(extreme))):
            path = [y[0], y[-1]] if y.size == 2 else [y[0], y[1], y[-1]]
            shown = (" → … → " if y.size > 3 else " → ").join(f"{v:.4g}" for v in path)
            text = (
                f"At the {end} end of the input the output goes {shown}{spaced(loop.output_unit)} over {y.size} visits "
                f"({100 * (y[-1] - y[0]) / np.ptp(loop.y):+.1f} % of the range): the loop does not close."
            )
            out.append(ImportFinding(text, "open loop"))
    return out


def _noise_at(loop: LoopRecord, u: float) -> float:
    """The range that the noise of the output has near an input, from second differences; 0 of fewer than three rows."""
    rows = np.flatnonzero(np.abs(loop.u[1:-1] - u) <= _SAME * np.ptp(loop.u))
    if rows.size < 3:
        return 0.0
    bends = np.abs(np.diff(loop.y, 2))[rows]
    return noise_range(loop.y[rows], float(np.median(bends)) / 0.6745 / float(np.sqrt(6.0)))


def _wrong_direction(loop: LoopRecord, turns: list[int]) -> list[ImportFinding]:
    width = width_of_leading_loops(loop.u, loop.y, turns)
    if width is None:
        return []
    leads = f"The output leads its input (mean loop width {100 * width:.1f} % of the range)"
    if dimension(loop.input_unit) in _ELONGATIONS and dimension(loop.output_unit) in _FORCES:
        text = (
            f"{leads}: a specimen that dissipates work is pulled with more force than it returns. Its hysteresis is "
            "that of the elongation over the force: take the force as the input."
        )
    else:
        text = (
            f"{leads}: the loop runs in the wrong direction. Branches or columns are swapped, or the sensor of the "
            "input lags."
        )
    return [ImportFinding(text, "leading output")]


def _centre(loop: LoopRecord) -> list[str]:
    low, high = loop.u.min(), loop.u.max()
    centre, half = (high + low) / 2, (high - low) / 2
    temperature = loop.input_unit in ("degC", "K")  # a temperature has no natural centre
    if temperature or low >= -0.2 * high or high <= -0.2 * low or abs(centre) < 0.02 * half:
        return []
    return [
        f"The input is not symmetric: {low:.4g} … {high:.4g}{spaced(loop.input_unit)}, centre {centre:+.3g}. "
        f"Check the source for an offset, unless this is intended."
    ]
