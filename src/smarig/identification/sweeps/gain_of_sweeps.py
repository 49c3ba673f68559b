"""R/hA of a wire from its sweeps, which needs a second source: current and position alone cannot tell it.

With c times the R/hA, every input is c times as large. A hysteresis with thresholds c times as far apart then gives the
same position at every time. So the gain needs the wire's temperature, or a hysteresis that is already known in kelvin:

    T(t) = Tₐ + (R/hA) x(t),      x the squared current after a first-order lag τ          (temperature)
    y(t) = Γ[c u(t)] + zero,      Γ a model of the same wire, u by the actuator's R/hA     (reference)
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from smarig.core import Array, DataError
from smarig.identification.calibration.holds import at_range_end
from smarig.identification.interval_estimate import Estimate, linear_fit, quantile
from smarig.identification.sweeps.sweep_record import SweepRecord
from smarig.preisach import Everett, Preisach

UNDETERMINED = (
    "The steady temperature per squared current R/hA cannot be determined from current and position: a wire with twice "
    "the R/hA and a hysteresis twice as wide in kelvin gives the same record. The model keeps the actuator's value. "
    "Measure the wire's temperature, or give a model of this wire with --reference."
)
_FACTOR = 2.0  # the gain is searched within this factor of the actuator's
_STEP = 1e-3  # of log c, for derivatives


def gain_of_sweeps(
    records: Sequence[SweepRecord], tau_s: float, reference: Everett | None = None
) -> Estimate | str:
    """R/hA in K/A² as an Estimate, or the sentence why the data do not determine it."""
    if reference is not None:
        return _by_reference(records, tau_s, reference)
    thermal = [r for r in records if r.run.has("temperature_degC") and not r.actuator.two_wire]
    return _by_temperature(thermal, tau_s) if thermal else UNDETERMINED


def _by_temperature(records: Sequence[SweepRecord], tau_s: float) -> Estimate | str:
    """The slope of the wire's temperature over the lagged squared current; each sweep is a segment."""
    segments: list[tuple[Array, Array]] = []
    for record in records:
        T, room = (record.run[name][record.first :] for name in ("temperature_degC", "ambient_degC"))
        x = record.rises_K(tau_s) / record.actuator.gain_K_per_A2
        known = np.isfinite(T) & record.valid & ~at_range_end(T)
        room = np.where(np.isfinite(room), room, np.nan)
        above, columns = (T - room, x[:, None]) if np.isfinite(room[known]).all() else (T, None)
        columns = np.column_stack([x, np.ones_like(x)]) if columns is None else columns
        for rows in np.split(np.arange(x.size), np.flatnonzero(np.diff(record.sweep)) + 1):
            used = rows[known[rows]]
            segments += [(columns[used], above[used])] if used.size else []
    if not segments or len({columns.shape[1] for columns, _ in segments}) > 1:
        return (
            "R/hA cannot be determined: the wire's temperature is not known together with that of the room."
        )
    fit = linear_fit(segments)
    if fit is None or fit.x[0] - fit.half[0] <= 0:
        return "R/hA cannot be determined: the wire's temperature does not rise with the squared current."
    value, half = float(fit.x[0]), float(fit.half[0])
    text = f"wire temperature along the sweeps, residual rms {fit.rms:.2g} °C"
    return Estimate(value, (value - half, value + half), "K/A^2", text, fit.n)


def _by_reference(records: Sequence[SweepRecord], tau_s: float, reference: Everett) -> Estimate | str:
    """The factor on the input for which the reference follows the sweeps best."""
    gain, edge = records[0].actuator.gain_K_per_A2, np.log(_FACTOR)
    grid = np.linspace(-edge, edge, 15)
    squares = [float(np.mean(_errors(records, tau_s, reference, x) ** 2)) for x in grid.tolist()]
    k = int(np.argmin(squares))
    if k in (0, grid.size - 1):
        return (
            f"R/hA cannot be determined: no value within a factor of {_FACTOR:g} of the actuator's {gain:.4g} K/A² "
            "makes the reference model follow the sweeps. Check that it is a model of this wire with inputs in kelvin."
        )
    fit = least_squares(
        lambda p: _errors(records, tau_s, reference, float(p[0])),
        [grid[k]],
        bounds=(grid[k - 1], grid[k + 1]),
        diff_step=_STEP,
    )
    slope, residual, sweep = np.asarray(fit.jac)[:, 0], np.asarray(fit.fun), _sweeps(records)
    curvature = float(slope @ slope)
    clusters = np.bincount(sweep, slope * residual)
    spread = np.sqrt(max(float(clusters @ clusters), float(np.mean(residual**2)) * curvature)) / curvature
    half = quantile(float(np.unique(sweep).size - 1)) * float(spread)
    value = gain * float(np.exp(fit.x[0]))
    ends = (value * float(np.exp(-half)), value * float(np.exp(half)))
    return Estimate(
        value, ends, "K/A^2", "inputs for which the reference model follows the sweeps", residual.size
    )


def _errors(records: Sequence[SweepRecord], tau_s: float, reference: Everett, log_factor: float) -> Array:
    """Reference minus measurement of each block (m,), about the mean of each record."""
    parts = []
    for record in records:
        inputs, _, block = record.path(tau_s)
        y = Preisach(reference, "negative").follow(np.exp(log_factor) * inputs)[block >= 0]
        error = y - record.means(record.position)[block[block >= 0]]
        parts.append(error - error.mean())
    return np.concatenate(parts)


def _sweeps(records: Sequence[SweepRecord]) -> NDArray[np.int64]:
    labels, first = [], 0
    for record in records:
        used = record.sweep[record.blocks][record.sizes > 0]
        labels.append(first + np.unique(used, return_inverse=True)[1])
        first = int(labels[-1].max()) + 1
    if not labels:
        raise DataError("No run of sweeps was given.")
    return np.concatenate(labels)
