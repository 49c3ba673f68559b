"""The moving model y = Γ[u + k y]: feedback of the output on the input, from minor loops after several histories.

The identification of the moving model: the feedback k of the output on the input, from loops after other
histories.

    y = Γ[u + k y]

First-order curves alone do not determine k: for every k one Γ reproduces all of them, the first-order surface y(α,
β) shifted along its own output, α → α + k y(α, α), β → β + k y(α, β). So Γ is identified again for each k from
those curves, and the errors at the other readings (minor loops at several levels) are a function of k alone. The
surface is interpolated once, smoothly and independently of k, so no prior on Γ biases k. Nevertheless k is weakly
determined: on curves 10 K apart, with noise of a thousandth of the stroke, k = −2, 0 and 2 K/mm were estimated with
a scatter of 0.4 to 0.6, and 25 of 30 intervals contained them. Compare a small p-value with simulated records
without feedback.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, UsageError, root_mean_square, t_quantile, t_tail
from smarig.identification.extended.extremum_chains import excursions, extremum_chains, first_order
from smarig.identification.extended.fitted_extension import ExtensionData, FittedExtension
from smarig.identification.extended.spline_surface import first_order_surface
from smarig.identification.interval_estimate import Estimate
from smarig.preisach import FodTable, dump_hysteresis
from smarig.record import Run
from smarig.theory import MovingPreisach, slope_range


def moving(data: ExtensionData) -> FittedExtension:
    """The feedback k of the output on the input."""
    fit = identify_moving(data.runs)
    kept = {
        "kind": "moving",
        "feedback": fit.feedback.value,
        "hysteresis": dump_hysteresis(fit.hysteresis),
    }
    return FittedExtension("feedback k of the output on the input", {"k": fit.feedback}, fit.p_value, kept)


_FEWEST = 8
_SCAN = 7
_ROUNDS = 3
_STEP = 0.01  # of the reach: wide enough to average over cells of the table
_DRAWS = 24
_SHARE = 0.9  # of the feedback at which the moving model loses its unique solution


@dataclass(frozen=True, eq=False)
class MovingFit:
    """k with its 95 % interval, the p-value of k = 0, the rms errors of the loops with and without feedback, and Γ
    in w.
    """

    feedback: Estimate
    p_value: float
    rms: float
    rms_without: float
    hysteresis: FodTable

    def model(self) -> MovingPreisach:
        """The identified operator."""
        return MovingPreisach(self.hysteresis, self.feedback.value)


def identify_moving(runs: Sequence[Run], *, reach: float | None = None) -> MovingFit:
    """Identify k of y = Γ[u + k y] (input per output unit) from settled points of runs that start in negative
    saturation.

    The runs need first-order curves over the range and loops in addition to them (DataError with fewer than 8 such
    points), best away from the maximum of the density, where a shift does not change a loop. k is searched within ±
    ``reach``, by default a quarter of the input's range per stroke. The fit is least squares over the loops. The
    interval combines their noise and the uncertainty of the surface that the first-order curves leave, by drawing
    surfaces from its posterior. Runs without loops are not simulated, so keep first-order curves in separate runs.
    """
    record = extremum_chains(runs)
    first = first_order(record)
    loops = np.flatnonzero(~first)
    if loops.size < _FEWEST:
        raise DataError(
            f"Only {loops.size} points are not on first-order curves, but the feedback k needs at least {_FEWEST} "
            "such points. Measure minor loops between the same inputs after different histories."
        )
    surface = first_order_surface(record, np.flatnonzero(first))
    table = surface.table
    low, high = _range(table, reach)
    used = np.unique(record.run[loops])

    def misfit(k: float, table: FodTable = table) -> Array:
        model = MovingPreisach(shifted_surface(table, k), k)
        y = record.y.copy()
        for r in used:
            y[record.run == r] = model.simulate(record.u[record.run == r])
        return (y - record.y)[loops]

    scan = np.linspace(low, high, _SCAN)[1:-1].tolist()
    start = min(scan, key=lambda k: float(np.sum(misfit(k) ** 2)))
    k, step = start, _STEP * (high - low)
    for _ in range(_ROUNDS):
        k = min(max(k + _newton(misfit, k, step)[0], low), high)
    _, gain, left = _newton(misfit, k, step)
    without = misfit(0.0)
    # Two kinds of error: the uncertain surface, common to all loops, and the noise of each excursion.
    allowed = np.array([misfit(k, drawn) for drawn in surface.draws(_DRAWS)]) - left
    error = float(np.sqrt(np.mean((allowed @ gain) ** 2) + _between(gain * left, excursions(record)[loops])))
    half = t_quantile(0.975, _DRAWS - 1) * error
    unit = f"input units/{record.unit}" if record.unit else "input units/output unit"
    return MovingFit(
        Estimate(k, (k - half, k + half), unit, "moving model on minor loops", loops.size),
        2 * t_tail(abs(k) / error, _DRAWS - 1),
        root_mean_square(left),
        root_mean_square(without),
        shifted_surface(surface.table, k),
    )


def _newton(misfit: Callable[[float], Array], k: float, step: float) -> tuple[float, Array, Array]:
    """One Gauss–Newton step from k, the derivative of each misfit, and the misfits."""
    slope = (misfit(k + step) - misfit(k - step)) / (2 * step)
    gain, left = slope / float(slope @ slope), misfit(k)
    return -float(gain @ left), gain, left


def shifted_surface(surface: FodTable, k: float) -> FodTable:
    """Γ in w = u + k y that has the given first-order surface in u with feedback k."""
    u, y = surface.nodes, surface.values
    up = u + k * np.diag(y)
    if np.any(np.diff(up) <= 0):
        raise UsageError(
            f"With feedback k = {k:g} the ascending branch turns back, so no such operator exists."
        )
    w = np.linspace(up[0], up[-1], u.size)
    rows = np.full_like(y, np.nan)  # y at (α_i, w_j), α still that of u
    for i in range(u.size):
        rows[i] = np.interp(w, u[: i + 1] + k * y[i, : i + 1], y[i, : i + 1])
    values = np.column_stack([np.interp(w, up, column) for column in rows.T])
    on = np.interp(w, up, np.diag(y))
    i, j = np.indices(values.shape)
    values = np.where(i == j, on[:, None], np.where(j < i, values, np.nan))
    return FodTable(w, values, surface.unit)


def _range(surface: FodTable, reach: float | None) -> tuple[float, float]:
    stroke = float(np.ptp(np.diag(surface.values)))
    reach = 0.25 * (surface.upper - surface.lower) / stroke if reach is None else reach
    if not reach > 0:
        raise UsageError(f"The search range of k must be positive, got {reach:g}.")
    return max(-reach, -_SHARE / slope_range(surface).greatest), reach


def _between(pull: Array, cluster: NDArray[np.intp]) -> float:
    """Variance of the sum of the contributions of all points, which are correlated within clusters (sandwich)."""
    names, which = np.unique(cluster, return_inverse=True)
    return float(np.sum(np.bincount(which, pull) ** 2)) * names.size / max(names.size - 1, 1)
