"""R/hA and hA from measured wire temperatures in steady state, (5.3).

    T = Tₐ + (R/hA) i²        and, with a measured voltage,        T = Tₐ + (V i)/hA

Without an ambient channel, Tₐ is fitted too. Steady means are one reading per step (a run without a clock), or the
last fifth of a hold of at least 5 τ. Readings at the end of the sensor's range are left out. The emissivity error
of an infra-red sensor is not corrected, because the data do not show it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smarig.core import Array
from smarig.identification.calibration.holds import at_range_end, drive_holds, valid_rows
from smarig.identification.interval_estimate import Estimate, LinearFit, linear_fit
from smarig.record import Run

_TIME_CONSTANTS = 5.0
_FEWEST = 5
_NONLINEARITY_RATIO = 3.0
_NAMES = {"R_over_hA": "The steady temperature per squared current R/hA", "hA": "The heat loss hA"}


@dataclass(frozen=True, eq=False)
class _SteadyReadings:
    """Steady readings of one run, each (n,), in order."""

    current_A: Array
    voltage_V: Array
    temperature_degC: Array
    ambient_degC: Array


def heat_loss(runs: Sequence[Run], tau: Estimate | None) -> dict[str, Estimate | str]:
    """``R_over_hA`` (K/A²) and ``hA`` (W/K), each an Estimate or the sentence why the data do not determine it."""
    thermal = [run for run in runs if run.has("temperature_degC") and run.has("current_A")]
    if not thermal:
        return {name: _unavailable_text(name, _missing_channels_text(runs)) for name in _NAMES}
    if any(np.nanmin(run["current_A"]) < -0.05 * np.nanmax(run["current_A"]) for run in thermal):
        why = "currents of both signs heat two wires in turn, and the measured wire is not recorded"
        return {name: _unavailable_text(name, why) for name in _NAMES}
    steady = [_steady(run, tau) for run in thermal]
    steady = [s for s in steady if s.current_A.size >= _FEWEST and np.ptp(s.current_A) > 0]
    if not steady:
        why = f"there are fewer than {_FEWEST} steady readings at different currents (holds of 5 τ, with τ known)"
        return {name: _unavailable_text(name, why) for name in _NAMES}
    where = ", ".join(run.path.name for run in thermal)
    return {"R_over_hA": _per_squared_current(steady, where), "hA": _per_watt(steady, where)}


def _unavailable_text(name: str, why: str) -> str:
    return f"{_NAMES[name]} cannot be determined: {why}."


def _missing_channels_text(runs: Sequence[Run]) -> str:
    if not any(run.has("temperature_degC") for run in runs):
        return "no run has a measured wire temperature"
    return "no run with a measured wire temperature has a measured current"


def _per_squared_current(steady: list[_SteadyReadings], where: str) -> Estimate | str:
    fit = _linear_heat_loss([(s, s.current_A**2) for s in steady])
    if fit is None or fit.x[0] <= 0:
        return _unavailable_text("R_over_hA", "the temperature does not rise with the squared current")
    k, half = float(fit.x[0]), float(fit.half[0])
    return Estimate(k, (k - half, k + half), "K/A^2", _source("squared current", fit, steady, where), fit.n)


def _per_watt(steady: list[_SteadyReadings], where: str) -> Estimate | str:
    powered = [s for s in steady if np.isfinite(s.voltage_V).all()]
    if not powered:
        return _unavailable_text(
            "hA", "no run with steady temperatures has a measured voltage, so only R/hA can be determined"
        )
    fit = _linear_heat_loss([(s, s.voltage_V * s.current_A) for s in powered])
    if fit is None or fit.x[0] - fit.half[0] <= 0:
        return _unavailable_text("hA", "the temperature does not clearly rise with the electrical power")
    slope, half = float(fit.x[0]), float(fit.half[0])
    ends = (1 / (slope + half), 1 / (slope - half))
    return Estimate(1 / slope, ends, "W/K", _source("electrical power", fit, powered, where), fit.n)


def _linear_heat_loss(data: list[tuple[_SteadyReadings, Array]]) -> LinearFit | None:
    """T − Tₐ on x through zero if all runs know Tₐ, else T on x with one Tₐ per run."""
    if all(np.isfinite(s.ambient_degC).all() for s, _ in data):
        return linear_fit([(x[:, None], s.temperature_degC - s.ambient_degC) for s, x in data])
    own = np.eye(len(data))
    return linear_fit(
        [
            (np.column_stack([x, np.tile(own[k], (x.size, 1))]), s.temperature_degC)
            for k, (s, x) in enumerate(data)
        ]
    )


def _source(against: str, fit: LinearFit, steady: list[_SteadyReadings], where: str) -> str:
    text = f"steady wire temperature against {against} in {where}, residual rms {fit.rms:.2g} °C"
    jitter = np.concatenate([np.diff(s.temperature_degC, 2) for s in steady]).std() / np.sqrt(6)
    if fit.rms > _NONLINEARITY_RATIO * max(jitter, 1e-12):
        text += (
            f" against {jitter:.2g} °C of scatter: the relation is not linear (R varies with phase, h with "
            "temperature, or the sensor does not measure the wire alone), and the interval is widened for it"
        )
    return text


def _steady(run: Run, tau: Estimate | None) -> _SteadyReadings:
    names = ("current_A", "voltage_V", "temperature_degC", "ambient_degC")
    needed = np.isfinite(run["current_A"]) & np.isfinite(run["temperature_degC"])
    keep = needed & valid_rows(run) & ~at_range_end(run["temperature_degC"])
    if not run.has("t_s"):
        return _SteadyReadings(*(run[name][keep] for name in names))
    long_enough = _TIME_CONSTANTS * tau.value if tau else np.inf
    windows = []
    for hold in drive_holds(run):
        begin, end = run["t_s"][hold.begin], run["t_s"][hold.end - 1]
        rows = np.arange(hold.begin, hold.end)
        rows = rows[keep[rows] & (run["t_s"][rows] >= end - 0.2 * (end - begin))]
        if end - begin >= long_enough and rows.size:
            windows.append([float(run[name][rows].mean()) for name in names])
    return _SteadyReadings(*np.array(windows, dtype=float).reshape(-1, 4).T)
