"""The plain variables that residuals may depend on: smooth terms of each, added to the output or to the input.

A named effect must explain more than any of them. If none does, the variable itself is the finding.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from smarig.identification import MeasuredFit, local_slope
from smarig.measurement import reversals

Array = NDArray[np.float64]
WAVES = 3  # cosines over the ranks of a variable
MIN_RATE_RATIO = 1.5  # rates that differ less show no dependence


def variable_terms(fit: MeasuredFit) -> Iterator[tuple[str, Array]]:
    """(variable, terms (m, k)) for a fit without them: each smooth function alone, and times the slope ∂y/∂v."""
    slope = local_slope(fit)
    slope = slope / (float(np.sqrt(np.mean(slope**2))) or 1.0)
    yield from _rate_terms(fit, slope)
    for name, z in _variables(fit).items():
        basis = _smooth(z)
        if basis.shape[1]:
            yield name, np.hstack([basis, basis * slope[:, None]])


def _rate_terms(fit: MeasuredFit, slope: Array) -> Iterator[tuple[str, Array]]:
    """("rate", terms (m, 8)) if the rates of the branches differ: log |du/dt| times level, slope and direction."""
    plan = fit.problem.plan
    if not all(r.clock for r in plan.records):
        return
    rate = plan.of([_branch_rate(r.u, r.t) for r in plan.records])
    z = np.log(np.maximum(np.abs(rate), 1e-300))
    if np.ptp(z) < np.log(MIN_RATE_RATIO):
        return
    z = 2 * (z - z.min()) / float(np.ptp(z)) - 1
    level = (fit.predicted - fit.predicted.mean()) / (float(np.std(fit.predicted)) or 1.0)
    shapes = (np.ones(z.size), level, slope, slope * np.sign(rate))
    yield "rate", np.column_stack([w * s for w in (z, (3 * z**2 - 1) / 2) for s in shapes])


def _variables(fit: MeasuredFit) -> dict[str, Array]:
    plan = fit.problem.plan
    records = plan.records
    level = plan.of([r.y for r in records])
    found = {"level": fit.predicted if np.ptp(fit.predicted) else level}
    found["cycle"] = plan.of([r.cycle for r in records])
    found["history"] = plan.of([_last_reversal(r.u) for r in records])
    if all(r.clock for r in records):
        starts = np.cumsum([0.0, *[float(np.ptp(r.t)) for r in records]])
        found["time"] = plan.of([r.t - r.t[0] + s for r, s in zip(records, starts.tolist())])
    if len(records) > 1:
        found["run"] = plan.record.astype(float)
    return found


def _last_reversal(u: Array) -> Array:
    """The input at the last reversal before each row."""
    turns = np.array(reversals(u))
    return u[turns[np.clip(np.searchsorted(turns, np.arange(u.size), side="left") - 1, 0, None)]]


def _branch_rate(u: Array, t: Array) -> Array:
    """Mean du/dt of the branch of each row."""
    turns = np.array(reversals(u))
    branch = np.clip(np.searchsorted(turns, np.arange(u.size), side="left") - 1, 0, None)
    return (np.diff(u[turns]) / np.maximum(np.diff(t[turns]), 1e-12))[branch]


def _smooth(z: Array) -> Array:
    """Cosines over the ranks of z, (m, up to ``WAVES``): smooth in z for any distribution of its values."""
    values, where = np.unique(np.round(z, 9), return_inverse=True)
    if values.size < 2:
        return np.empty((z.size, 0))
    counts = np.bincount(where)
    rank = (np.cumsum(counts) - 0.5 * counts) / z.size
    waves = np.arange(1, min(WAVES, values.size - 1) + 1)
    return np.cos(np.pi * rank[:, None] * waves[None, :])[where]
