"""τ from a measured wire temperature after steps of the drive: first order, with a dead time if it is significant.

    T(t) = T₀ + ΔT (1 − e^{−(t − d)/τ}) for t > d, T₀ before        (thesis (5.1) with constant current)

τ and d are common to all steps; T₀ and ΔT belong to each step. Readings are averaged over short bins, so that
repeated time stamps and polling faster than the sensor converts have no effect. The result is the time constant of
wire and temperature sensor together, which these data cannot separate.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from smarig.core import Array, f_quantile
from smarig.identification.calibration.holds import DriveHold, drive_holds, drive_name, valid_rows
from smarig.identification.interval_estimate import Estimate, quantile, variance_inflation
from smarig.record import Run

_BINS = 300
_MOST_STEPS = 20
_SIGNIFICANT = 0.99


@dataclass(frozen=True, eq=False)
class TemperatureTransient:
    """Mean readings after one step of the drive: time since the step t_s (n,), temperature (n,)."""

    t_s: Array
    temperature: Array


@dataclass(frozen=True, eq=False)
class _TransientFit:
    tau_s: float
    dead_s: float
    square: float
    freedom: float
    residuals: list[Array]
    spread: Array  # standard errors of log τ and d


def tau_from_temperature(runs: Sequence[Run]) -> dict[str, Estimate | str]:
    """``tau`` and ``dead_time``, each an Estimate or the sentence why the data do not determine it."""
    found = [(run, h) for run in runs if run.has("temperature_degC") for h in drive_holds(run)]
    transients = [x for x in (_transient(run, hold) for run, hold in found) if x is not None]
    if not transients:
        why = (
            "no run has a measured wire temperature"
            if not any(run.has("temperature_degC") for run in runs)
            else "the measured temperature never follows a step of the drive that is then held"
        )
        return {
            name: f"{text} cannot be determined from temperature: {why}."
            for name, text in _PARAMETER_TEXTS.items()
        }
    transients.sort(key=lambda x: -float(np.ptp(x.temperature)))
    return _estimates(transients[:_MOST_STEPS], ", ".join(sorted({_source(run) for run, _ in found})))


_PARAMETER_TEXTS = {"tau": "The time constant τ", "dead_time": "A dead time"}


def _source(run: Run) -> str:
    name = drive_name(run)
    quantity = run.info.input.text_of("quantity", name) if name == "input" else "current"
    return f"steps of {quantity} in {run.path.name}"


def _transient(run: Run, hold: DriveHold) -> TemperatureTransient | None:
    rows = slice(hold.begin, hold.end)
    t, temperature = run["t_s"][rows], run["temperature_degC"][rows]
    keep = np.isfinite(t) & np.isfinite(temperature) & valid_rows(run)[rows]
    if keep.sum() < 10:
        return None
    t, temperature = t[keep] - t[keep][0], temperature[keep]
    bins = np.floor(t / max(t[-1], 1e-12) * (_BINS - 1)).astype(int)
    kept, index, count = np.unique(bins, return_inverse=True, return_counts=True)
    if kept.size < 10:
        return None
    mean = np.bincount(index, temperature) / count
    return TemperatureTransient(np.bincount(index, t) / count, mean) if np.ptp(mean) > 0 else None


def _estimates(transients: list[TemperatureTransient], source: str) -> dict[str, Estimate | str]:
    plain, delayed = _fit(transients, False), _fit(transients, True)
    gain = (plain.square - delayed.square) / max(delayed.square / delayed.freedom, 1e-300)
    dead = gain > f_quantile(_SIGNIFICANT, 1, delayed.freedom)
    fit = delayed if dead else plain
    n = sum(x.t_s.size for x in transients)
    longest = max(float(x.t_s[-1]) for x in transients)
    rms = np.sqrt(fit.square / n)
    half = quantile(fit.freedom) * fit.spread
    low, high = fit.tau_s * np.exp(-half[0]), fit.tau_s * np.exp(half[0])
    result: dict[str, Estimate | str] = {}
    if not np.isfinite(half[0]) or half[0] > np.log(3.0) or fit.tau_s > 3 * longest:
        result["tau"] = (
            f"The time constant τ cannot be determined: {longest:.3g} s after a step, with readings that scatter "
            f"by {rms:.2g} °C, give {low:.2g} s to {high:.2g} s. Hold the step longer."
        )
    else:
        text = f"temperature after {len(transients)} step(s), {source}; wire and sensor together, first order"
        text += f" with a dead time of {fit.dead_s:.2g} s" if dead else " without dead time"
        text += f", residual rms {rms:.2g} °C, interval widened for correlated residuals"
        result["tau"] = Estimate(fit.tau_s, (float(low), float(high)), "s", text, n)
    if dead:
        ends = (max(fit.dead_s - half[1], 0.0), fit.dead_s + half[1])
        result["dead_time"] = Estimate(
            fit.dead_s, ends, "s", f"delay before the first-order rise; {source}", n
        )
    else:
        result["dead_time"] = "The transients show no dead time."
    return result


def _fit(transients: list[TemperatureTransient], delayed: bool) -> _TransientFit:
    longest = max(float(x.t_s[-1]) for x in transients)
    finest = longest / _BINS

    def residuals(x: Array) -> Array:
        return np.concatenate([_projected(v, np.exp(x[0]), x[1] if delayed else 0.0)[0] for v in transients])

    taus = np.log(np.geomspace(finest, 5 * longest, 30))
    deads = longest * np.array([0.0, 0.01, 0.03, 0.06, 0.1, 0.2, 0.3]) if delayed else np.zeros(1)
    starts = [(float(np.sum(residuals(np.array([a, d])) ** 2)), a, d) for a in taus for d in deads]
    _, log_tau, dead = min(starts)
    start = [log_tau, min(max(dead, 1e-6 * longest), 0.49 * longest)] if delayed else [log_tau]
    limits = ([np.log(finest / 10), 0.0], [np.log(100 * longest), 0.5 * longest])
    best = least_squares(
        residuals, start, bounds=tuple(v[: len(start)] for v in limits), x_scale=[1.0, finest][: len(start)]
    )
    tau, dead = float(np.exp(best.x[0])), float(best.x[1]) if delayed else 0.0
    return _fit_with_standard_errors(transients, tau, dead, delayed)


def _fit_with_standard_errors(
    transients: list[TemperatureTransient], tau: float, dead: float, delayed: bool
) -> _TransientFit:
    parts = [_projected(v, tau, dead) for v in transients]
    errors = [r for r, _ in parts]
    slopes = np.concatenate([g[:, : 1 + delayed] for _, g in parts])
    square = sum(float(r @ r) for r in errors)
    n, p = slopes.shape[0], 1 + delayed + 2 * len(transients)
    f = variance_inflation(errors)
    freedom = max(n / f - p, 1.0)
    curvature = slopes.T @ slopes
    if np.linalg.cond(curvature) > 1e12:
        return _TransientFit(tau, dead, square, freedom, errors, np.full(2, np.inf))
    spread = np.sqrt(square / max(n - p, 1) * f * np.diag(np.linalg.inv(curvature)))
    return _TransientFit(tau, dead, square, freedom, errors, spread)


def _projected(x: TemperatureTransient, tau: float, dead: float) -> tuple[Array, Array]:
    """Residuals (n,) at the best T₀ and ΔT, and derivatives (n, 2) by log τ and d with those two projected out."""
    since = np.maximum(x.t_s - dead, 0.0) / tau
    decay = np.exp(-since)
    basis = np.linalg.qr(np.column_stack([np.ones_like(since), 1 - decay]))[0]
    rest = x.temperature - basis @ (basis.T @ x.temperature)
    rise = np.linalg.lstsq(np.column_stack([np.ones_like(since), 1 - decay]), x.temperature, rcond=None)[0][1]
    slopes = -rise * np.column_stack([since * decay, np.where(x.t_s > dead, decay / tau, 0.0)])
    return rest, slopes - basis @ (basis.T @ slopes)
