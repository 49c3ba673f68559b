"""How the position of a wire of a rig changes with the load alone: Y(σ) = y(σ) + c (σ − σ₀), c in output units per MPa.

Each run of a rig is zeroed under its own load, so runs under constant loads do not show it. A run under a load that
changes does: c follows from what the model leaves of it, by least squares with a zero of its own.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from smarig.core import Array, DataError, stored_number
from smarig.measurement import ConditionTable
from smarig.record import Run
from smarig.replay import Model, simulate_runs, stress_at_points, stress_of_samples

LEAST_CHANGE_MPA = 1.0
ZERO_SLOPE = "zero_slope"  # key of the load in the fit of a model
FEWEST_POINTS = 3


@dataclass(frozen=True)
class ZeroSlope:
    """c in output units per MPa with its 95 % interval; ``reference_MPa`` is σ₀."""

    value: float
    interval: tuple[float, float]
    unit: str
    reference_MPa: float = 0.0

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "value": self.value,
            "ci95": list(self.interval),
            "unit": self.unit,
            "reference_MPa": self.reference_MPa,
        }


def fitted_zero_slope(stress_MPa: Array, rest: Array, unit: str) -> tuple[ZeroSlope, float]:
    """The slope over stresses (k,) of what a model leaves (k,), and its value at the mean stress. Raises DataError
    unless the stress changes.
    """
    known = np.isfinite(stress_MPa) & np.isfinite(rest)
    if known.sum() < FEWEST_POINTS or np.ptp(stress_MPa[known]) < LEAST_CHANGE_MPA:
        raise DataError(
            "The load hardly changes at the readings, so they do not show how the position depends on it."
        )
    x = stress_MPa[known] - stress_MPa[known].mean()
    square, mean = float(x @ x), float(rest[known].mean())
    slope = float(x @ rest[known]) / square
    left = rest[known] - mean - slope * x
    half = 1.96 * float(np.sqrt(left @ left / (known.sum() - 2) / square))
    return ZeroSlope(slope, (slope - half, slope + half), f"{unit}/MPa"), mean


def zero_slope(model: Model, runs: Sequence[Run], reference_MPa: float) -> ZeroSlope:
    """The slope from runs under changing loads, each with a zero of its own."""
    parts = [_about_means(model, run) for run in runs]
    stress_MPa, rest = (np.concatenate(column) for column in zip(*parts, strict=True))
    return replace(fitted_zero_slope(stress_MPa, rest, model.unit)[0], reference_MPa=reference_MPa)


def _about_means(model: Model, run: Run) -> tuple[Array, Array]:
    stress_MPa, rest = stress_at_points(run), run.points()[1] - simulate_runs(model, [run])[0]
    if stress_MPa is None:
        raise DataError(
            f"The load of {run.path} is constant, so it does not show how the position depends on it."
        )
    known = np.isfinite(stress_MPa) & np.isfinite(rest)
    return stress_MPa - np.mean(stress_MPa[known]), rest - np.mean(rest[known])


def zero_slope_of(model: Model) -> tuple[float, float] | None:
    """(c, σ₀) of a model; None if its runs did not show it. Raises DataError if its file is damaged."""
    load = model.fit.get("load")
    stored = load.get(ZERO_SLOPE) if isinstance(load, dict) else None
    if stored is None:
        return None
    if not isinstance(stored, dict):
        raise DataError(f"Model '{model.name}' is damaged: its {ZERO_SLOPE} is no table.")
    value, reference_MPa = (
        stored_number(stored.get(key), f"{key} of {ZERO_SLOPE}") for key in ("value", "reference_MPa")
    )
    return value, reference_MPa


def with_zero_slope(table: ConditionTable, slope: ZeroSlope) -> ConditionTable:
    """The table with c (σ − σ₀) added to its zeros."""
    added = (slope.value * (np.array(table.values) - slope.reference_MPa)).tolist()
    return replace(table, zeros=tuple(z + a for z, a in zip(table.zeros, added)))


def stress_at_start(run: Run) -> float | None:
    """Stress in MPa at the first sample of a run; None if it is unknown."""
    changing = stress_of_samples(run)
    if changing is not None:
        return float(changing[0]) if changing.size else None
    stored = run.info.conditions.get("stress")
    mean = stored.get("mean") if isinstance(stored, dict) else None
    return float(mean) if isinstance(mean, int | float) else None
