"""Steady loops of a run: each is one swing of the input, with two branches, their tips and its closure error.

It accepts loops measured one by one (numbered in the column ``step``), cycles in a row, and one cycle that started
in the middle. The closure of a loop is measured, not assumed. Branches are not smoothed: a branch is everything
measured between its tips, including small reversals by noise.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, root_mean_square
from smarig.preisach import turning_points
from smarig.record import Run

Integers = NDArray[np.int64]
Point = tuple[float, float]
CLOSURE_TOLERANCE = 0.05  # of a loop's input range: largest distance of the end of a swing from its start
_GRID = 201


@dataclass(frozen=True, eq=False)
class SteadyLoop:
    """One loop: its tips (input, output), and its branches in measured order, each with both ends.

    ``number`` is the run's own number of the loop, or its index in the run from 0. ``rising`` goes from the lower
    tip to the upper one, ``falling`` back: each (n, 2), columns input and output in the run's units. A tip that was
    visited twice is the mean of both visits. If the input passed a tip without stopping, its output is
    interpolated. ``closure`` is the output at the end of the swing minus that at its start.
    """

    number: int
    lower: Point
    upper: Point
    rising: Array
    falling: Array
    closure: float

    @property
    def output_range(self) -> float:
        """Largest minus smallest output of both branches."""
        y = np.concatenate([self.rising[:, 1], self.falling[:, 1]])
        return float(np.ptp(y))

    @property
    def centre(self) -> Point:
        """The midpoint between the tips."""
        return (self.lower[0] + self.upper[0]) / 2, (self.lower[1] + self.upper[1]) / 2

    def symmetry_error(self, centre: Point | None = None) -> float:
        """Rms of y_falling(u) + y_rising(2u_c − u) − 2y_c over the inputs that both branches cover, in output
        units.

        Zero if the loop is its own mirror image in the point (u_c, y_c), by default its centre. NaN if the branches
        and their images share no input.
        """
        u_c, y_c = self.centre if centre is None else centre
        rising, falling = _as_function_of_input(self.rising), _as_function_of_input(self.falling)
        image = np.array([2 * u_c, 2 * y_c]) - rising[::-1]
        low, high = max(image[0, 0], falling[0, 0]), min(image[-1, 0], falling[-1, 0])
        if low >= high:
            return float("nan")
        u = np.linspace(low, high, _GRID)
        apart = np.interp(u, *falling.T) - np.interp(u, *image.T)
        return root_mean_square(apart)

    def __repr__(self) -> str:
        tips = f"({self.lower[0]:.5g}, {self.lower[1]:.5g}) … ({self.upper[0]:.5g}, {self.upper[1]:.5g})"
        return f"Loop({self.number}: {tips}, {len(self.rising)} + {len(self.falling)} points)"


@dataclass(frozen=True, eq=False)
class _LoopBranches:
    """Readings of a loop's two branches; ``seam``: the last and first reading of the record, where they are joined."""

    outward: Integers
    return_: Integers
    seam: tuple[int, int] | None = None


def steady_loops(run: Run, *, smallest: float = 0.2) -> list[SteadyLoop]:
    """Every swing of the input that returns to its start, in the order of closing; [] if there is none.

    Nested loops are separated by wiping-out (§3.3.1): when the input passes an earlier reversal again, the swing in
    between is a loop, and the interrupted branch continues. A swing that started with the record must end within 5
    % of its size (``CLOSURE_TOLERANCE``) of its start. Reversals smaller than ``smallest`` × the input's range
    count as noise of their branch. Numbered parts of a run (column ``step`` without a table of steps) are searched
    separately.
    """
    loops: list[SteadyLoop] = []
    for number, u, y in _numbered_parts(run):
        turns = turning_points(u, smallest * float(np.ptp(u))) if u.size > 2 else []
        found_loops = _closed_loops(u, turns) or _loop_from_mid_branch(u, turns)
        for branches in found_loops:
            own = number if number is not None and len(found_loops) == 1 else len(loops)
            loops.append(_loop(own, u, y, branches))
    return loops


def _numbered_parts(run: Run) -> Iterator[tuple[int | None, Array, Array]]:
    """(number, inputs, outputs) of each part that can hold loops of its own."""
    if run.steps or not run.has("step"):
        yield None, *run.points()
        return
    known = np.isfinite(run["input"]) & np.isfinite(run["position"]) & np.isfinite(run["step"])
    step, u, y = (run[name][known] for name in ("step", "input", "position"))
    edges = [0, *(np.flatnonzero(np.diff(step)) + 1).tolist(), step.size]
    for a, b in pairwise(edges):
        if b > a:
            yield int(step[a]), u[a:b], y[a:b]


def _closed_loops(u: Array, turns: list[int]) -> list[_LoopBranches]:
    """The swings between reversals that close, innermost first (rainflow counting; the first swing is treated
    separately).

    ``open_`` holds the branches that are not closed yet, each from one remembered reversal to the next.
    """
    found_loops: list[_LoopBranches] = []
    open_: list[Integers] = []
    for branch in (np.arange(a, b + 1) for a, b in pairwise(turns)):
        open_.append(branch)
        while len(open_) > 1:
            outward, return_ = open_[-2:]
            size, left = abs(u[outward[-1]] - u[outward[0]]), abs(u[return_[-1]] - u[outward[0]])
            first, short = len(open_) == 2, abs(u[return_[-1]] - u[return_[0]]) < size
            if left > CLOSURE_TOLERANCE * size and short:
                break
            if first and left > CLOSURE_TOLERANCE * size:  # the start of a record is not a reversal
                del open_[0]
                continue
            past = np.flatnonzero((u[return_] - u[outward[0]]) * (u[outward[-1]] - u[outward[0]]) <= 0)
            cut = int(past[0]) if past.size and not first else return_.size - 1
            found_loops.append(_LoopBranches(outward, return_[: cut + 1]))
            open_[-2:] = []
            if not first:
                open_[-1] = np.concatenate([open_[-1], return_[cut:]])
    return found_loops


def _loop_from_mid_branch(u: Array, turns: list[int]) -> list[_LoopBranches]:
    """One swing whose record starts and ends at the same input on one branch: the end is joined to the start."""
    if len(turns) != 4:
        return []
    first, a, b, last = turns
    if abs(u[last] - u[first]) > CLOSURE_TOLERANCE * abs(u[b] - u[a]):
        return []
    return_ = np.concatenate([np.arange(b, last + 1), np.arange(a + 1)])
    return [_LoopBranches(np.arange(a, b + 1), return_, (last, first))]


def _loop(number: int, u: Array, y: Array, branches: _LoopBranches) -> SteadyLoop:
    outward, return_ = (np.column_stack([u[rows], y[rows]]) for rows in (branches.outward, branches.return_))
    _trim_to_input(return_, float(outward[0, 0]))
    end, begin = y[list(branches.seam)] if branches.seam else (return_[-1, 1], outward[0, 1])
    closure = float(end - begin)
    near, far = (outward[0] + return_[-1]) / 2, outward[-1]
    tips = [(float(tip[0]), float(tip[1])) for tip in (near, far)]
    if near[0] < far[0]:
        return SteadyLoop(number, tips[0], tips[1], outward, return_, closure)
    return SteadyLoop(number, tips[1], tips[0], return_, outward, closure)


def _trim_to_input(branch: Array, u: float) -> None:
    """Move the last point, if it lies beyond input ``u``, back to ``u`` on the line from the previous point."""
    before, last = branch[-2], branch[-1]
    if (before[0] - u) * (last[0] - u) < 0:
        part = (u - before[0]) / (last[0] - before[0])
        branch[-1] = u, before[1] + part * (last[1] - before[1])


def _as_function_of_input(branch: Array) -> Array:
    """A branch as a function of its input: (m, 2), inputs rising, with the mean output of equal inputs."""
    u, where = np.unique(branch[:, 0], return_inverse=True)
    return np.column_stack([u, np.bincount(where, branch[:, 1]) / np.bincount(where)])
