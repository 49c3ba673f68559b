"""The accommodation model: minor loops drift towards the mean along the output's path; identified from repeated
loops.

The identification of accommodation: amount κ and path l of the drift of minor loops, from repeated states.

Only differences between repeats of one classical memory state are used. A Preisach model predicts none there, so an
error of the hysteresis itself cancels. For each l the model is linear in κ,

    y − ȳ(state) = κ [D_l − D̄_l(state)] + noise,        D_l = change of the classical output by κ = 1

and l follows from the profile of the squares (thesis §3.5; Vajda & Della Torre, IEEE Trans. Magn. 30:4371, 1994,
also fit a rate and an amount to repeated loops).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from smarig.core import Array, DataError, f_quantile, f_tail
from smarig.identification.extended.extremum_chains import ExtremumChains, extremum_chains
from smarig.identification.extended.fitted_extension import ExtensionData, FittedExtension
from smarig.identification.interval_estimate import Estimate
from smarig.preisach import Everett
from smarig.record import Run
from smarig.theory import AccommodatingPreisach


def accommodating(data: ExtensionData) -> FittedExtension:
    """The drift of minor loops, with amount κ along an output path l."""
    fit = identify_accommodation(data.runs, data.hysteresis)
    if not 0 <= fit.amount.value <= 1:
        raise DataError(
            f"The amount of accommodation is {fit.amount}, outside 0 … 1: repeated loops drift away from the "
            "mean or do not drift."
        )
    kept = {"kind": "accommodating", "amount": fit.amount.value, "path": fit.path.value}
    parameters = {"amount": fit.amount, "path": fit.path}
    return FittedExtension("drift of repeated minor loops", parameters, fit.p_value, kept)


_SHORTEST, _LONGEST, _SCAN = 0.02, 200.0, 17  # strokes


@dataclass(frozen=True)
class AccommodationFit:
    """κ and l with profile intervals, the p-value of "no drift", rms of the repeats without and with the drift.

    The record does not bound l on a side where its interval reaches 0.02 or 200 strokes.
    """

    amount: Estimate
    path: Estimate
    p_value: float
    rms_without: float
    rms: float


def identify_accommodation(runs: Sequence[Run], hysteresis: Everett) -> AccommodationFit:
    """Identify κ and l (strokes) from settled points of runs that start in negative saturation and repeat states.

    ``hysteresis`` is the classical one, identified before. Raises DataError with fewer than 6 degrees of freedom.
    """
    record = extremum_chains(runs)
    y = _within(record.y, record.state)
    freedom = record.y.size - np.unique(record.state).size - 2
    if freedom < 4:
        raise DataError(
            f"The record repeats too few memory states ({max(freedom + 2, 0)} degrees of freedom). Accommodation needs "
            "a minor loop driven several times between the same inputs."
        )
    classical = _outputs(record, hysteresis, 0.0, 1.0)

    def drift(log_path: float) -> Array:
        return _within(_outputs(record, hysteresis, 1.0, float(np.exp(log_path))) - classical, record.state)

    def squares(log_path: float) -> float:
        d = drift(log_path)
        return float(y @ y - (d @ y) ** 2 / max(float(d @ d), 1e-300))

    ends = float(np.log(_SHORTEST)), float(np.log(_LONGEST))
    best = _least(squares, *ends)
    least = squares(best)
    noise = least / freedom
    d = drift(best)
    if not (noise > 0 and float(d @ d) > 0):
        raise DataError(
            "The memory states that the record repeats cannot drift (for example saturations) or have no noise. "
            "Accommodation needs a minor loop driven several times between the same inputs."
        )
    gradient = (drift(best + 1e-3) - drift(best - 1e-3)) / 2e-3
    amount = float(d @ y) / float(d @ d)
    # The error of the amount includes that of l: only the part of D outside ∂D/∂log l counts.
    aside = d - gradient * float(gradient @ d) / max(float(gradient @ gradient), 1e-300)
    half = float(f_quantile(0.95, 1, freedom) * noise / max(float(aside @ aside), 1e-300)) ** 0.5
    bound = noise * f_quantile(0.95, 1, freedom)
    low, high = (np.exp(_crossing(lambda p: squares(p) - least - bound, best, end)) for end in ends)
    gain = (float(y @ y) - least) / 2 / noise
    n = record.y.size
    return AccommodationFit(
        Estimate(amount, (amount - half, amount + half), "1", "repeated memory states", n),
        Estimate(float(np.exp(best)), (float(low), float(high)), "strokes", "repeated memory states", n),
        f_tail(gain, 2, freedom),
        float(np.sqrt(y @ y / (freedom + 2))),
        float(np.sqrt(noise)),
    )


def _outputs(record: ExtremumChains, hysteresis: Everett, amount: float, path: float) -> Array:
    model = AccommodatingPreisach(hysteresis, amount, path)
    return np.concatenate([model.simulate(record.u[record.run == r]) for r in np.unique(record.run)])


def _within(values: Array, state: NDArray[np.intp]) -> Array:
    """Deviations from the mean over the repeats of each memory state."""
    return values - (np.bincount(state, values) / np.bincount(state))[state]


def _least(squares, low: float, high: float) -> float:
    grid = np.linspace(low, high, _SCAN)
    at = int(np.argmin([squares(p) for p in grid]))
    bracket = float(grid[max(at - 1, 0)]), float(grid[min(at + 1, _SCAN - 1)])
    found: Any = minimize_scalar(squares, bounds=bracket, method="bounded", options={"xatol": 1e-4})
    return float(found.x)


def _crossing(above, best: float, end: float) -> float:
    """The point between best and end at which ``above`` turns positive; the end if it does not."""
    if above(end) <= 0:
        return end
    root: Any = brentq(above, best, end, xtol=1e-3)
    return float(root)
