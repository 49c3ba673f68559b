"""First-order descending data from any record of settled points, by following the memory.

A point (α, β, y) belongs to FOD data if the memory is negative saturation and at most one maximum: on the rising
major branch it is (u, u), falling from a maximum α it is (α, u). First-order ascending data (from positive
saturation, §4.2) is the same in the mirror (u, y) → (−u, −y), and so are first-order reversal curves of magnetism.

FOD data as an interpolating hysteresis: a table on one partition, or a table of curves.

There is no fit and no noise model: the measured values are reproduced exactly.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, UsageError
from smarig.identification.point_selection import matches
from smarig.preisach import FodTable, ForcCurve, ForcTable, State
from smarig.record import FORC_PROTOCOL, Run
from smarig.replay import MemoryHistory, memory_histories

Integers = NDArray[np.int64]
_FodRow = tuple[float, float, float, int, int, int]


@dataclass(frozen=True, eq=False)
class DescendingCurve:
    """One curve: number, maximum α, inputs β (n,) falling from at most α, outputs y (n,)."""

    curve: int
    alpha: float
    beta: Array
    y: Array


@dataclass(frozen=True, eq=False)
class FodData:
    """FOD points of one hysteresis: arrays (k,) in order of measurement.

    ``alpha`` ≥ ``beta`` are inputs and ``y`` outputs in ``unit`` (raw: the encoder's zero is arbitrary). ``curve``
    counts curves from 0. ``major`` marks the major loop (rising branch, descent from the top). ``point`` is the
    index of the point in its run and ``run`` the index of that run. ``lower`` and ``upper`` are the smallest and
    largest input. With ``mirrored``, all values are in the mirror (−u, −y).
    """

    alpha: Array
    beta: Array
    y: Array
    curve: Integers
    major: NDArray[np.bool_]
    run: Integers
    point: Integers
    unit: str
    lower: float
    upper: float
    mirrored: bool

    def __len__(self) -> int:
        return self.y.size

    @property
    def curves(self) -> int:
        """Number of different curves that descend from a maximum."""
        return np.unique(self.alpha[self.alpha > self.beta]).size

    def descending_curves(self) -> list[DescendingCurve]:
        """The curves that descend from a maximum, in order of measurement; repeated readings are averaged."""
        found: list[DescendingCurve] = []
        for number in np.unique(self.curve):
            mine = self.curve == number
            alpha = float(self.alpha[mine].max())
            mine &= self.alpha == alpha
            beta, where = np.unique(self.beta[mine], return_inverse=True)
            y = np.bincount(where, self.y[mine]) / np.bincount(where)
            if beta[0] < alpha:
                found.append(DescendingCurve(int(number), alpha, beta[::-1], y[::-1]))
        return found

    def where(self, mask: NDArray[np.bool_]) -> "FodData":
        """The points of a mask (k,); curve numbers and range stay."""
        names = ("alpha", "beta", "y", "curve", "major", "run", "point")
        return replace(self, **{name: getattr(self, name)[mask] for name in names})

    def as_table(self) -> tuple[Array, Array, Array]:
        """Nodes of α (m,), of β (n,) and y (m, n), NaN for β > α; repeated points are averaged.

        This needs a regular partition. Raises DataError with the first missing (α, β).
        """
        alphas = np.unique(self.alpha)
        betas = np.unique(np.concatenate([[self.lower], self.alpha, self.beta]))
        rows, columns = np.searchsorted(alphas, self.alpha), np.searchsorted(betas, self.beta)
        sums, counts = np.zeros((alphas.size, betas.size)), np.zeros((alphas.size, betas.size))
        np.add.at(sums, (rows, columns), self.y)
        np.add.at(counts, (rows, columns), 1)
        missing = np.argwhere((counts == 0) & (betas <= alphas[:, None]))
        if missing.size:
            i, j = missing[0]
            raise DataError(
                f"The FOD data do not fill one partition: there is no point at α = {alphas[i]:g}, "
                f"β = {betas[j]:g} ({len(missing)} such cells). Measure it, or fit a surface."
            )
        return alphas, betas, np.divide(sums, counts, out=np.full_like(sums, np.nan), where=counts > 0)

    def __repr__(self) -> str:
        kind = "FOA, mirrored" if self.mirrored else "FOD"
        return (
            f"FodData({kind}: {len(self)} points, {self.curves} curves, "
            f"range [{self.lower:g}, {self.upper:g}], y in {self.unit or '?'})"
        )


def fod_data(runs: Sequence[Run] | Run) -> FodData:
    """FOD (or mirrored FOA) points of one or several runs, whichever are more.

    Raises DataError with the needed inputs if there are fewer than two curves.
    """
    runs = [runs] if isinstance(runs, Run) else list(runs)
    data = first_order_points(runs)
    if data.curves >= 2:
        return data
    names = ", ".join(run.path.name for run in runs)
    top = f"{data.upper:g}" if len(data) else "the largest input"
    if data.curves == 1:
        raise DataError(
            f"{names}: only one curve falls from a maximum after saturation, but a hysteresis needs several. "
            f"From saturation ({data.lower:g}), rise to different maxima up to {top} and fall back after each."
        )
    raise DataError(
        f"{names}: no first-order descending curves: the input never rises from negative saturation and "
        "falls again. Drive it to the smallest input first (or begin there), rise to a maximum, fall back "
        "in steps, and repeat with other maxima."
    )


def first_order_points(runs: Sequence[Run]) -> FodData:
    """``fod_data`` without a minimum number of curves: possibly few points, or none."""
    if not runs:
        raise UsageError("No run was given. Name at least one run file with FOD data.")
    units = {run.unit for run in runs}
    if len(units) > 1:
        raise DataError(
            f"The runs measure in different units ({', '.join(sorted(units))}). Identify them separately."
        )
    forc = [run.info.protocol == FORC_PROTOCOL for run in runs]
    if any(forc) and not all(forc):
        raise DataError("Reversal curves and other runs were given together. Identify them separately.")
    if all(forc):
        return _reversal_curves(runs)
    plain, mirror = (_follow_memory(runs, mirrored) for mirrored in (False, True))
    # The major loop is the same in the mirror, so the points inside it determine the direction of the curves.
    return mirror if np.sum(~mirror.major) > np.sum(~plain.major) else plain


def select(data: FodData, expression: str) -> FodData:
    """The points for which an expression on curve, alpha, beta holds, e.g. ``curve%2==0``.

    In mirrored data, alpha and beta are mirrored too. Raises UsageError if the expression is not understood or
    finds no point.
    """
    chosen = matches(expression, {"curve": data.curve, "alpha": data.alpha, "beta": data.beta})
    if not chosen.any():
        raise UsageError(
            f"Selection '{expression}' finds no point. There are curves 0 to {data.curve.max(initial=0)}, "
            f"alpha and beta between {data.lower:g} and {data.upper:g}."
        )
    return data.where(chosen)


# --- following the memory -----------------------------------------------------------------------------


def _follow_memory(runs: Sequence[Run], mirrored: bool) -> FodData:
    lower, upper, records = memory_histories(runs, mirrored=mirrored)
    rows: list[_FodRow] = []
    curve = 0
    for index, history in enumerate(records):
        if rows and not history.continued:
            curve = rows[-1][3] + 1
        places = _fod_points(history, curve)
        rows += [(a, b, history.outputs[k], c, index, k) for k, a, b, c in places]
        curve = places[-1][3] if places else curve
    return _assembled(rows, (lower, upper), runs[0].unit, mirrored)


def _fod_points(history: MemoryHistory, curve: int) -> list[tuple[int, float, float, int]]:
    """(point, α, β, curve) of the FOD points of one run; a curve starts where the input rises again."""
    places: list[tuple[int, float, float, int]] = []
    before, fell = history.start, history.continued
    for k, state in enumerate(history.states):
        place = _fod_point(before, state)
        before = state
        if place is None or state is None or place[0] <= state.extrema[0]:
            continue  # points that rest in negative saturation are on no curve
        alpha, beta = place
        if fell and alpha == beta:
            curve, fell = curve + 1, False
        fell = fell or alpha > beta
        places.append((k, alpha, beta, curve))
    return places


def _fod_point(before: State | None, now: State | None) -> tuple[float, float] | None:
    """(α, β) of a point from the memory before and at it, None if it is not a FOD point."""
    if now is None or now.diagonal:
        return None
    lower = now.extrema[0]
    if now.u <= lower:  # back in saturation: the end of the descending curve
        if before is None or before.diagonal:
            return lower, lower
        return (before.extrema[1] if len(before.extrema) > 1 else before.u), lower
    if len(now.extrema) == 1:
        return now.u, now.u
    return (now.extrema[1], now.u) if len(now.extrema) == 2 else None


# --- reversal curves of magnetism -----------------------------------------------------------------------


def _reversal_curves(runs: Sequence[Run]) -> FodData:
    """Curves numbered by the ``step`` column, rising from a reversal input below positive saturation."""
    rows: list[_FodRow] = []
    lower, upper, first = np.inf, -np.inf, 0
    for index, run in enumerate(runs):
        u, y, step = -run["input"], -run["position"], run["step"]
        known = np.isfinite(u) & np.isfinite(y)
        lower, upper = min(lower, float(u[known].min())), max(upper, float(u[known].max()))
        place = np.cumsum(known) - 1  # index among the run's points
        for number, label in enumerate(np.unique(step[known & (step >= 0)])):
            members = np.flatnonzero(known & (step == label))
            alpha = float(u[members].max())
            rows += [(alpha, u[k], y[k], first + number, index, int(place[k])) for k in members]
        first = rows[-1][3] + 1 if rows else 0
    return _assembled(rows, (lower, upper), runs[0].unit, True)


def _assembled(rows: list[_FodRow], ends: tuple[float, float], unit: str, mirrored: bool) -> FodData:
    table = np.array(rows, dtype=float).reshape(len(rows), 6)
    alpha, beta, y = table[:, :3].T
    curve, run, point = table[:, 3:].T.astype(np.int64)
    top = np.max(alpha, initial=-np.inf)
    return FodData(alpha, beta, y, curve, (alpha == beta) | (alpha == top), run, point, unit, *ends, mirrored)


def table(data: FodData) -> FodTable | ForcTable:
    """``FodTable`` if every β ≤ α of one partition was measured, else ``ForcTable`` of the curves."""
    try:
        return FodTable.from_arrays(*data.as_table(), unit=data.unit)
    except DataError:  # irregular: curves with points of their own
        return curve_table(data)


def curve_table(data: FodData) -> ForcTable:
    """Table of the curves, each from its peak down; repeated readings and repeated curves are averaged."""
    curves = []
    for alpha in np.unique(data.alpha):
        mine = data.alpha == alpha
        beta, where = np.unique(data.beta[mine], return_inverse=True)
        y = np.bincount(where, data.y[mine]) / np.bincount(where)
        if beta[-1] == alpha and beta.size > 1:
            curves.append(ForcCurve(float(alpha), beta[::-1], y[::-1]))
    return ForcTable.from_curves(curves, unit=data.unit)
