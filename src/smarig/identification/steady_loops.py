"""Steady loops out of a run: one input swing there and back, as two branches with their tips and faults.

For loops measured one by one (numbered in the column ``step``), for cycles in a row, and for one cycle that was
begun half way. How well a loop closes is measured, not assumed. Knows runs; no memory, no model, and no
smoothing: a branch is what was measured between its tips, small reversals of noise included.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from smarig.preisach import turning_points
from smarig.record import Run

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Point = tuple[float, float]
CLOSURE_TOLERANCE = 0.05  # of a loop's input range: a swing that ends this close to its beginning came back
_GRID = 201


@dataclass(frozen=True, eq=False)
class SteadyLoop:
    """One loop: input–output tips, and its branches in measured order, each with both its ends.

    ``number``: the run's own number of the loop, or its place in the run from 0. ``rising`` goes from the
    lower tip to the upper one, ``falling`` back: each (n, 2), columns input and output in the run's units. A tip
    visited twice is the mean of both visits; where the input passed it without stopping, the output there is
    interpolated. ``closure``: output at the end of the swing minus that at its beginning.
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
        """The point half way between the tips."""
        return (self.lower[0] + self.upper[0]) / 2, (self.lower[1] + self.upper[1]) / 2

    def symmetry_error(self, centre: Point | None = None) -> float:
        """Rms of y_falling(u) + y_rising(2u_c − u) − 2y_c over the inputs both cover, in output units.

        Zero where the loop is its own mirror image in the point (u_c, y_c), its centre if none is given. NaN where
        the branches and their images share no input.
        """
        u_c, y_c = self.centre if centre is None else centre
        rising, falling = _as_function_of_input(self.rising), _as_function_of_input(self.falling)
        image = np.array([2 * u_c, 2 * y_c]) - rising[::-1]
        low, high = max(image[0, 0], falling[0, 0]), min(image[-1, 0], falling[-1, 0])
        if low >= high:
            return float("nan")
        u = np.linspace(low, high, _GRID)
        apart = np.interp(u, *falling.T) - np.interp(u, *image.T)
        return float(np.sqrt(np.mean(apart**2)))

    def __repr__(self) -> str:
        tips = f"({self.lower[0]:.5g}, {self.lower[1]:.5g}) … ({self.upper[0]:.5g}, {self.upper[1]:.5g})"
        return f"Loop({self.number}: {tips}, {len(self.rising)} + {len(self.falling)} points)"


@dataclass(frozen=True, eq=False)
class _LoopBranches:
    """Readings of a loop's two branches; ``seam``: the last and first of the record, where they are joined."""

    outward: Integers
    return_: Integers
    seam: tuple[int, int] | None = None


def steady_loops(run: Run, *, smallest: float = 0.2) -> list[SteadyLoop]:
    """Every swing of the input that comes back to where it began, in the order of closing; [] if there is none.

    Nested loops are told apart as the memory does (wiping-out, §3.3.1): when the input passes an earlier
    reversal again, the swing in between is a loop, and the branch it interrupted goes on. A swing that began
    with the record must end within 5 % of its size (``CLOSURE_TOLERANCE``) of its beginning. Reversals smaller than
    ``smallest`` × the input's range are taken as noise of their branch. Numbered parts of a run (column
    ``step`` without a table of steps) are searched one by one.
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
    """The swings between reversals that close, innermost first (rainflow counting, with the first swing apart).

    ``open_`` holds the branches that still wait for their closing, each from one remembered reversal to the next.
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
            if (
                first and left > CLOSURE_TOLERANCE * size
            ):  # a record's beginning is no reversal to come back to
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
    """One swing whose record begins and ends at the same input on one branch: the end goes on at the beginning."""
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
    """Moves the last point, if it lies beyond input ``u``, back to it on the line from the point before."""
    before, last = branch[-2], branch[-1]
    if (before[0] - u) * (last[0] - u) < 0:
        part = (u - before[0]) / (last[0] - before[0])
        branch[-1] = u, before[1] + part * (last[1] - before[1])


def _as_function_of_input(branch: Array) -> Array:
    """A branch as a function of its input: (m, 2), inputs rising, outputs at one input as their mean."""
    u, where = np.unique(branch[:, 0], return_inverse=True)
    return np.column_stack([u, np.bincount(where, branch[:, 1]) / np.bincount(where)])
