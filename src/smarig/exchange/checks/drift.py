"""Instrument drift over a set of reversal curves, from their calibration points (n,) in measured order.

Calibration points repeat one state of the sample, so every change of them is drift: of gain (multiplicative) or of
zero (additive), interpolated between successive points. A correction is kept only if it predicts better: every
second interior curve from its two neighbours.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, root_mean_square, spaced
from smarig.record import Run

DriftKind = Literal["none", "multiplicative", "additive"]


@dataclass(frozen=True)
class ForcCurves:
    """Field, moment (n,) and curve number (n,), −1 at calibration points, in measured order."""

    field: Array
    moment: Array
    curve: NDArray[np.int64]


@dataclass(frozen=True)
class DriftDecision:
    """The chosen correction, and the rms held-out error of each kind in the moment's unit over ``n`` points."""

    kind: DriftKind
    error: dict[DriftKind, float]
    n: int

    def sentence(self, unit: str) -> str:
        """The decision with its figures."""
        raw = self.error["none"]
        tried = {k: e for k, e in self.error.items() if k != "none"}
        figures = ", ".join(f"{e:.4g}{spaced(unit)} with {k} correction" for k, e in tried.items())
        verdict = "left as it is" if self.kind == "none" else f"{self.kind} correction helps"
        return (
            f"Drift: held-out error {raw:.4g}{spaced(unit)} as measured, {figures} (n = {self.n}): {verdict}."
        )

    def record(self) -> dict[str, Any]:
        """The decision as plain data, for the description of a run."""
        return asdict(self)


def corrected(curves: ForcCurves, kind: DriftKind) -> ForcCurves:
    """The curves with drift removed: M·m̄/m(k) or M + m̄ − m(k), with the calibration m(k) at sample k.

    m̄ is the mean calibration moment. m(k) is linear between calibration points and constant beyond them.
    """
    positions = np.flatnonzero(curves.curve < 0)
    if kind == "none":
        return curves
    if positions.size < 2:
        raise DataError(
            f"A drift correction needs at least two calibration points; there are {positions.size}."
        )
    calibration = curves.moment[positions]
    drift = np.interp(np.arange(curves.moment.size), positions, calibration)
    if kind == "additive":
        return ForcCurves(curves.field, curves.moment + calibration.mean() - drift, curves.curve)
    if (calibration * calibration.mean() <= 0).any():
        raise DataError("The calibration moments change sign, so they are not moments in saturation.")
    return ForcCurves(curves.field, curves.moment * calibration.mean() / drift, curves.curve)


def correct_drift_if_it_helps(curves: ForcCurves) -> tuple[ForcCurves, DriftDecision]:
    """The curves with the correction that predicts best, and the decision with all figures."""
    kinds: tuple[DriftKind, ...] = ("none", "multiplicative", "additive")
    tried = {kind: corrected(curves, kind) for kind in kinds}
    misses = {kind: held_out_misses(c) for kind, c in tried.items()}
    error = {kind: root_mean_square(m) for kind, m in misses.items()}
    best = min(kinds, key=lambda kind: error[kind])  # the first of equals: no correction without a gain
    return tried[best], DriftDecision(best, error, misses["none"].size)


def held_out_misses(curves: ForcCurves) -> Array:
    """Measured − predicted moment of every second interior curve, from its two neighbours.

    At each field, the moments of the neighbours (linear along the curve) are weighted by the distance of their
    reversal fields. Fields outside the common range of the neighbours are left out.
    """
    parts = _curves(curves)
    if len(parts) < 3:
        raise DataError(f"Held-out prediction needs at least three curves; there are {len(parts)}.")
    misses = [_miss(*parts[k - 1 : k + 2]) for k in range(1, len(parts) - 1, 2)]
    found = np.concatenate(misses)
    if not found.size:
        raise DataError("Neighbouring curves have no field range in common, so none predicts another.")
    return found


def drift_corrected(run: Run) -> tuple[Array, DriftDecision]:
    """Moments (n,) of an imported run of reversal curves, drift-corrected if that helps, and the decision."""
    if not run.has("step") or not (run["step"] < 0).any():
        raise DataError(f"{run.path} has no calibration points (step −1).")
    step = np.nan_to_num(run["step"], nan=-1.0).astype(np.int64)
    curves, decision = correct_drift_if_it_helps(ForcCurves(run["input"], run["position"], step))
    return curves.moment, decision


def _curves(curves: ForcCurves) -> list[tuple[Array, Array]]:
    return list(_in_order(curves))


def _in_order(curves: ForcCurves) -> Iterator[tuple[Array, Array]]:
    edges = np.flatnonzero(np.diff(curves.curve)) + 1
    for part in np.split(np.arange(curves.curve.size), edges):
        if curves.curve[part[0]] >= 0 and part.size > 1:
            order = part[np.argsort(curves.field[part], kind="stable")]
            yield curves.field[order], curves.moment[order]


def _miss(before: tuple[Array, Array], held_out: tuple[Array, Array], after: tuple[Array, Array]) -> Array:
    field, moment = held_out
    low, high = max(before[0][0], after[0][0]), min(before[0][-1], after[0][-1])
    inside = (field >= low) & (field <= high)
    reversals = before[0][0], field[0], after[0][0]
    span = reversals[2] - reversals[0]
    weight = (reversals[1] - reversals[0]) / span if span else 0.5
    positions = field[inside]
    predicted = (1 - weight) * np.interp(positions, *before) + weight * np.interp(positions, *after)
    return moment[inside] - predicted
