"""τ of the heating from sweeps at two rates, with an interval that includes what the model does not describe.

At one rate r a lag of r τ looks like a wider hysteresis; at another rate it has another width. The search is coarse
first, then a cubic through the least squares with the density eliminated. What heats is the square of the current as in
(5.1), or the power in the measured resistance, which falls by a tenth while a wire transforms: whichever leaves less,
because the other one moves τ by several percent. Where that leaves more than twice the noise, latent heat and free
convection are tried (``latent_of_sweeps``), and kept if they explain half of the squares.

The rates of sweeps: whether the same inputs were passed at clearly different rates in one direction.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import fminbound

from smarig.core import Array, DataError, root_mean_square
from smarig.identification.interval_estimate import Estimate
from smarig.identification.sweeps.lag_problem import LagProblem
from smarig.identification.sweeps.latent_of_sweeps import LatentFit, by_power, latent_of_sweeps
from smarig.identification.sweeps.score_interval import half_width
from smarig.identification.sweeps.sweep_heat import SweepHeat
from smarig.identification.sweeps.sweep_record import SweepRecord

LEVELS = 12  # inputs at which rates are compared
_MARGIN = 0.1  # of the range: no level is closer to its ends
_WINDOW = 0.02  # of the range: the rate at a level is the mean over this width


def rate_ratio(records: Sequence[SweepRecord]) -> float:
    """The largest over the smallest rate at which sweeps of one direction pass the same input; median over inputs.

    1 for sweeps at one rate, and if no input was passed twice. A sweep that only the wire's own cooling drives passes
    an input at the same rate as any other such sweep, so it does not count as a second rate.
    """
    ratios = []
    for rising in (True, False):
        rates = [_rates(r, rows, rising) for r in records for rows in _sweeps(r)]
        table = np.array([row for row in rates if np.isfinite(row).any()]).reshape(-1, LEVELS)
        several = np.sum(np.isfinite(table), axis=0) >= 2
        if several.any():
            passed = table[:, several]
            ratios.append(float(np.median(np.nanmax(passed, axis=0) / np.nanmin(passed, axis=0))))
    return max(ratios, default=1.0)


def _sweeps(record: SweepRecord) -> list[NDArray[np.intp]]:
    edges = np.flatnonzero(np.diff(record.sweep)) + 1
    return np.split(np.arange(record.sweep.size), edges)


def _rates(record: SweepRecord, rows: NDArray[np.intp], rising: bool) -> Array:
    """|du/dt| at each level (LEVELS,) of one sweep, NaN where it does not pass in this direction."""
    u, t = record.inputs_K(record.actuator.tau_s)[rows], np.cumsum(record.dt_s[rows])
    found = np.full(LEVELS, np.nan)
    if not rising:
        u = -u
    if u.size < 3 or u[-1] <= u[0]:
        return found
    u = np.maximum.accumulate(u) + 1e-9 * np.arange(u.size)
    share = np.linspace(_MARGIN, 1 - _MARGIN, LEVELS)
    levels = record.lower + share * record.span_K
    low, high = ((levels if rising else -levels) + side * _WINDOW * record.span_K / 2 for side in (-1, 1))
    inside = (low > u[0]) & (high < u[-1])
    seconds = np.interp(high, u, t) - np.interp(low, u, t)
    found[inside] = (high - low)[inside] / seconds[inside]
    return found


FACTOR = 4.0  # τ is searched within this factor of the actuator's value
COARSE, FINE = 20, 50  # intervals of the triangle of the search and of the result
LEAST_RATE_RATIO = 1.25
LEAST_COUNTS = 20.0  # of motion
LEAST_SIGNAL = 10.0  # standard deviation of the motion over the noise: noise alone moves the best τ too
MISFIT = 2.0  # times the noise: a larger residual is stated as lack of fit, and latent heat is tried
EXPLAINED = 0.5  # of what a constant τ leaves of the major loop, in squares: latent heat must explain as much
WIDEST = 0.2  # of τ: a wider half interval counts as not determined
_GRID = 11
_STEP, _OFFSETS = 0.02, (-2, -1, 0, 1, 2)  # of log τ, and multiples of it
_ROUNDS = 4


@dataclass(frozen=True, eq=False)
class SweptTau:
    """τ, the residual rms of block means, and the rms that noise alone would leave, in output units.

    ``heat`` is the law along the sweeps, ``latent`` its latent heat Λ in kelvin for the whole motion, None without.
    """

    tau: Estimate
    rms: float
    noise: float
    blocks: int
    sweeps: int
    rate_ratio: float
    heat: SweepHeat
    latent: Estimate | None = None
    major_rms: float | None = None  # residual rms on the major loop, where latent heat was kept
    constant_rms: float | None = None  # the same of the best constant τ


def tau_of_sweeps(records: Sequence[SweepRecord]) -> SweptTau:
    """τ of the wire of these records. Raises DataError with the reason if they do not determine it."""
    names = ", ".join(r.run.path.name for r in records)
    ratio = rate_ratio(records)
    _check_excitation(records, names, ratio)
    log_tau = _search(LagProblem.of(records, COARSE), math.log(records[0].actuator.tau_s), names)
    problem = LagProblem.of(records, FINE)
    log_tau, slope, residual = _refined(problem, log_tau)
    heat = by_power(records, log_tau)
    if heat is not None:
        by_heat = LagProblem.of([r.with_heat(heat) for r in records], FINE)
        other = _refined(by_heat, log_tau)
        if float(other[2] @ other[2]) < float(residual @ residual):
            log_tau, slope, residual = other
        else:
            heat = None
    half = half_width(slope, residual, problem.sweep)
    noise = float(np.sqrt(np.mean([r.noise**2 for r in records])))
    constant_rms = root_mean_square(residual)
    latent = _latent(records, log_tau, names) if constant_rms > MISFIT * noise else None
    if latent:
        log_tau, half = latent.log_tau, latent.half_log_tau
        residual = LagProblem.of([r.with_heat(latent.heat) for r in records], FINE).projected(log_tau)[1]
    if not half < WIDEST:
        raise DataError(
            f"{names}: the time constant τ cannot be determined: its 95 % interval is ± {100 * min(half, 9.99):.0f} %. "
            "The sweeps move the wire too little for its noise, or no Preisach model follows them. Measure more or "
            "larger reversal curves."
        )
    tau = math.exp(log_tau)
    sweeps = np.unique(problem.sweep).size
    text = f"position in {sweeps} sweeps of {names} at rates of ratio {ratio:.2g}, together with the density"
    return SweptTau(
        tau=Estimate(tau, (tau * math.exp(-half), tau * math.exp(half)), "s", text, residual.size),
        rms=root_mean_square(residual),
        noise=noise,
        blocks=residual.size,
        sweeps=sweeps,
        rate_ratio=ratio,
        heat=latent.heat if latent else heat or SweepHeat(),
        latent=latent.latent if latent else None,
        major_rms=latent.rms if latent else None,
        constant_rms=latent.constant_rms if latent else None,
    )


def _latent(records: Sequence[SweepRecord], log_tau: float, names: str) -> LatentFit | None:
    """The fit with latent heat if it is needed; not of two wires, whose output depends on two temperatures."""
    if records[0].actuator.two_wire:
        return None
    found = latent_of_sweeps(records, log_tau, names)
    kept = found is not None and found.rms**2 < (1 - EXPLAINED) * found.constant_rms**2
    return found if kept else None


def _check_excitation(records: Sequence[SweepRecord], names: str, ratio: float) -> None:
    for record in records:
        y, per_count = record.branches()[1], record.run.info.output.resolution
        motion = float(np.ptp(y)) if y.size else 0.0
        if motion == 0 or motion < LEAST_COUNTS * per_count:
            size = f"{motion / per_count:.3g} counts" if per_count else f"{motion:.3g} {record.run.unit}"
            raise DataError(
                f"{record.run.path}: the output moves by {size} only, too little to identify a lag of the heating. "
                "Sweep over a larger range of inputs."
            )
        if float(np.std(y)) < LEAST_SIGNAL * record.noise:
            raise DataError(
                f"{record.run.path}: the noise of the output, {record.noise:.3g} {record.run.unit} in short means, is "
                f"more than 1/{LEAST_SIGNAL:g} of the standard deviation of its motion, so a lag of the heating cannot "
                "be identified. Sweep over a larger range of inputs, or reduce the noise."
            )
    if ratio < LEAST_RATE_RATIO:
        raise DataError(
            f"{names}: all sweeps pass the same inputs at one rate (ratio {ratio:.2g}). A lag of the heating cannot be "
            "distinguished from a wider hysteresis then, so τ cannot be determined. Measure with two rates, at least a "
            f"factor of {LEAST_RATE_RATIO:g} apart (setting rates_K_per_s), or measure settled points."
        )


def _search(problem: LagProblem, guess: float, names: str) -> float:
    """log τ of the least J on a coarse triangle."""

    def objective(log_tau: float) -> float:
        return problem.projected(log_tau)[0]

    grid = guess + np.linspace(-1, 1, _GRID) * math.log(FACTOR)
    k = int(np.argmin([objective(x) for x in grid.tolist()]))
    if k in (0, grid.size - 1):
        raise DataError(
            f"{names}: the time constant τ cannot be determined: no value within a factor of {FACTOR:g} of the "
            f"actuator's {math.exp(guess):.3g} s follows the sweeps best. Check the actuator of the rig, and whether "
            "another effect than the heating delays the position."
        )
    return np.asarray(fminbound(objective, grid[k - 1], grid[k + 1], xtol=5e-3), dtype=float).item()


def _refined(problem: LagProblem, log_tau: float) -> tuple[float, Array, Array]:
    """(log τ of the least J, slope of the residuals by log τ, residuals).

    The minimum of a cubic through five values, because J rises faster on one side, and has small kinks where inputs
    cross the cells of the triangle.
    """
    slope = np.empty(0)
    for _ in range(_ROUNDS):
        found = [problem.projected(log_tau + k * _STEP) for k in _OFFSETS]
        vertex = _least([objective for objective, _ in found])
        slope = (found[-2][1] - found[1][1]) / (2 * _STEP)
        log_tau += vertex * _STEP
        if abs(vertex) <= 1:
            break
    return log_tau, slope, problem.projected(log_tau)[1]


def _least(values: Sequence[float]) -> float:
    """The offset at which a cubic through values at ``_OFFSETS`` is least; at most the last offset away.

    >>> round(_least([(k - 0.3) ** 2 + 0.1 * (k - 0.3) ** 3 for k in _OFFSETS]), 6)
    0.3
    """
    cubic = np.polynomial.Polynomial.fit(_OFFSETS, values, 3)
    grid = np.linspace(_OFFSETS[0], _OFFSETS[-1], 4001)
    return float(grid[int(np.argmin(cubic(grid)))])
