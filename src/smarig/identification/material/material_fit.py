"""Least squares of the law on all records at once, from several starting values.

    minimise Σ [ε_k − ε(T, σ; law) − ε_0]²

The law is smooth in its parameters along a given history, so Levenberg–Marquardt within bounds serves. Each start is
fitted to a part of the readings; the best one is then fitted to all.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from smarig.core import Array
from smarig.identification.material.law import MaterialLaw
from smarig.identification.material.material_path import MaterialBranch, strain_along
from smarig.identification.material.material_records import MaterialRecord
from smarig.identification.material.parameters import PARAMETERS, Choice
from smarig.identification.material.starting_values import EXPONENTS, bounded, starting_values, starting_zeros

COARSE_READINGS = 30  # of a branch, for the starts
PERCENT = 100.0  # residuals are in % of strain
_LEAST_WIDTH_K = 0.1
_STEP_RATIO = 1e-4
_STEP = 1e-7  # of differences, relative to the range of a parameter


@dataclass(frozen=True, eq=False)
class MaterialFit:
    """The law with its zeros of strain; at the minimum, residuals (n,) in 1, and their Jacobian (n, p + 1).

    ``inner``: the parameters as they are fitted, the zeros, and log E_M/E_A, whose column is 0 unless it is assumed.
    """

    law: MaterialLaw
    choice: Choice
    zeros: Array
    inner: Array
    residuals: Array
    jacobian: Array
    at_bound: tuple[str, ...]

    def strain(self, record: MaterialRecord, zero: int) -> Array:
        """Strain (n,) of the law along a record, from the zero of that number."""
        return self.zeros[zero] + strain_along(
            self.law, record.temperature_degC, record.acting_MPa, record.branches
        )


def fit_material(
    records: Sequence[MaterialRecord], choice: Choice, near: MaterialLaw | None = None
) -> MaterialFit:
    """The law that fits the records best, from all starts; of those around ``near``, from it and half of them."""
    coarse = [_thinned(r) for r in records]
    tries = []
    starts = (
        starting_values(records, choice)
        if near is None
        else [_values_of(near, choice), *starting_values(records, choice, EXPONENTS[1:])]
    )
    for values in starts:
        modulus = values.get("modulus_austenite", choice.fixed.get("modulus_austenite", 0.0))
        inner = [
            *(PARAMETERS[n].inner(v) for n, v in values.items()),
            *starting_zeros(records, choice, modulus),
        ]
        tries.append(_least_squares(coarse, choice, np.array(inner), 30))
    best = min(tries, key=lambda found: found.cost)
    found = _least_squares(records, choice, best.x, 100)
    values, zeros = _outer(choice, found.x)
    low, high = (ends[: len(choice.free)] for ends in choice.inner_bounds())
    inner = np.append(found.x, choice.log_ratio)
    margin = 1e-3 * (high - low)
    ends = (found.x[: low.size] < low + margin) | (found.x[: low.size] > high - margin)
    return MaterialFit(
        law=_law(choice, values),
        choice=choice,
        zeros=zeros,
        inner=inner,
        residuals=-found.fun / PERCENT,
        jacobian=np.column_stack([found.jac / PERCENT, _ratio_column(records, choice, inner)]),
        at_bound=tuple(n for n, end in zip(choice.free, ends) if end),
    )


def _values_of(law: MaterialLaw, choice: Choice) -> dict[str, float]:
    return bounded({name: getattr(law, name) for name in choice.free})


def _least_squares(records: Sequence[MaterialRecord], choice: Choice, start: Array, most: int) -> Any:
    low, high = choice.inner_bounds()
    measured = np.concatenate([r.strain for r in records])

    def error(inner: Array) -> Array:
        values, zeros = _outer(choice, inner)
        law = _law(choice, values)
        model = [
            zeros[zero] + strain_along(law, r.temperature_degC, r.acting_MPa, r.branches)
            for r, zero in zip(records, choice.zeros)
        ]
        return PERCENT * (np.concatenate(model) - measured)

    return least_squares(
        error,
        np.clip(start, low, high),
        jac=lambda inner: _jacobian(error, inner, low, high),
        bounds=(low, high),
        x_scale=_scales(choice),
        max_nfev=most,
    )


def _jacobian(error: Callable[[Array], Array], inner: Array, low: Array, high: Array) -> Array:
    """Differences (n, p) towards the inside of the bounds."""
    here, columns = error(inner), []
    for k in range(inner.size):
        step = _STEP * min(high[k] - low[k], 100.0)
        step = -step if inner[k] + step > high[k] else step
        moved = inner.copy()
        moved[k] += step
        columns.append((error(moved) - here) / step)
    return np.stack(columns, axis=1)


def _scales(choice: Choice) -> Array:
    """The size of a usual change of each parameter as it is fitted."""
    sizes = {"degC": 10.0, "MPa": 20.0, "1/K": 3e-6}
    found = []
    for name in choice.free:
        p = PARAMETERS[name]
        strain = name in ("strain_least", "strain_saturated")
        found.append(0.3 if p.by_log else 0.01 if strain else sizes.get(p.unit, 0.2))
    return np.array([*found, *[1e-3] * choice.n_zeros])


def law_at(choice: Choice, inner: Array) -> MaterialLaw:
    """The law of parameters as they are fitted."""
    return _law(choice, _outer(choice, inner)[0], float(inner[-1]))


def _ratio_column(records: Sequence[MaterialRecord], choice: Choice, inner: Array) -> Array:
    """The derivative (n,) of the strain by log E_M/E_A."""
    if not choice.assumes_ratio:
        return np.zeros(sum(r.strain.size for r in records))
    ends = []
    for step in (-_STEP_RATIO, _STEP_RATIO):
        law = law_at(choice, inner + np.append(np.zeros(inner.size - 1), step))
        ends.append([strain_along(law, r.temperature_degC, r.acting_MPa, r.branches) for r in records])
    return (np.concatenate(ends[1]) - np.concatenate(ends[0])) / (2 * _STEP_RATIO)


def _outer(choice: Choice, inner: Array) -> tuple[dict[str, float], Array]:
    values = {n: PARAMETERS[n].outer(float(x)) for n, x in zip(choice.free, inner)}
    return values, inner[len(choice.free) : len(choice.free) + choice.n_zeros]


def _law(choice: Choice, values: dict[str, float], log_ratio: float | None = None) -> MaterialLaw:
    """The law of trial values: a finish that passed its start stays below it."""
    for high, low in (("austenite_finish", "austenite_start"), ("martensite_start", "martensite_finish")):
        values = values | {low: min(values[low], values[high] - _LEAST_WIDTH_K)}
    return choice.law(values, log_ratio)


def _thinned(record: MaterialRecord) -> MaterialRecord:
    """Every so manyth reading of each branch, with its ends."""
    rows: list[int] = []
    branches: list[MaterialBranch] = []
    for b in record.branches:
        first = len(rows)
        kept = np.unique(np.linspace(b.first, b.stop - 1, COARSE_READINGS).round().astype(int))
        rows += kept.tolist()
        branches.append(MaterialBranch(first, len(rows), b.cooling))
    index = np.array(rows)
    return replace(
        record,
        temperature_degC=record.temperature_degC[index],
        stress_MPa=record.stress_MPa[index],
        strain=record.strain[index],
        branches=tuple(branches),
    )
