"""Decides by the loop areas, exactly, whether a Preisach model is dissipative with any storage function.

    dissipative (supply u ẏ, bounded range and memory)  ⇔  A(M, m) = 2∬_{m≤β≤α≤M} μ(α − β) ≥ 0 for all m < M

The thesis proves the sufficient condition μ ≥ 0 (Thm 7.4) and asks for a necessary one (ch. 9). This condition is
necessary and sufficient, whatever the signs of μ and g. Proof and figures: docs/explanation/dissipativity.md. Tables
and relay measures are decided by an exact minimum, analytic surfaces by a verified lower bound. No sampling is used.
"""

from dataclasses import dataclass, replace
from functools import singledispatch

import numpy as np
from scipy.optimize import minimize

from smarig.core import UsageError
from smarig.preisach import Everett, FodSurface, FodTable, Mirrored, RelayMeasure
from smarig.theory.energy.loop_area_bounds import AreaBound, area_bound, least_area, negative_small_loop
from smarig.theory.energy.moments import area as area_of
from smarig.theory.energy.moments import rounding

_FIRST_CELLS, _MAX_CELLS = 64, 512
_TIGHTNESS = 0.05  # relative accuracy of the bound at which a negative minimum is known well enough


@dataclass(frozen=True)
class DissipativityCertificate:
    """What is proved about the loop areas of a model, in output times input units.

    ``dissipative`` is None if the bound is not tight enough to decide. ``area`` is the smallest loop area found, at the
    loop ``at`` = (M, m). Every loop area is at least ``lower_bound``, which equals ``area`` if the minimum is exact.
    ``area`` is never above 0, the value of the degenerate loop M = m. Areas within ``tolerance`` of zero are rounding;
    an exact minimum that small is given as 0. ``evaluations`` counts the loops or cells evaluated. ``unit`` is that of
    the areas and ``input_unit`` that of the loop; they are empty if the hysteresis has no units.
    """

    dissipative: bool | None
    area: float
    at: tuple[float, float]
    lower_bound: float
    evaluations: int
    tolerance: float
    unit: str = ""
    input_unit: str = ""

    @property
    def text(self) -> str:
        """One sentence for a report."""
        if self.dissipative is None:
            return f"Undecided: {self.reason}."
        head = "Dissipative" if self.dissipative else "Not dissipative with any storage function"
        return f"{head}: {self.reason}."

    @property
    def reason(self) -> str:
        """The area that decides, as a clause."""
        high, low = self.at
        bound = _with_unit(f"{self.lower_bound:.3g}", self.unit)
        if self.dissipative:
            return f"no loop gives energy back in a cycle (every loop area is at least {bound})"
        if self.dissipative is None:
            smallest = _with_unit(f"{self.area:.3g}", self.unit)
            return f"all loop areas exceed {bound}; the smallest one found is {smallest}"
        loop = _with_unit(f"{low:.4g} ↔ {high:.4g}", self.input_unit)
        return f"the loop {loop} gives back {_with_unit(f'{-self.area:.4g}', self.unit)} in every cycle"


def _with_unit(number: str, unit: str) -> str:
    return f"{number} {unit}" if unit else number


def certify(hysteresis: Everett) -> DissipativityCertificate:
    """Decide the dissipativity of a surface, a table, a relay measure, or the mirror image of one.

    >>> from smarig.preisach import thesis_surface
    >>> certify(thesis_surface("one_e")).dissipative, certify(thesis_surface("one_p")).dissipative
    (True, False)
    """
    # an operator is accepted in place of its hysteresis
    return _certified(getattr(hysteresis, "hysteresis", hysteresis))


@singledispatch
def _certified(hysteresis: Everett) -> DissipativityCertificate:
    raise UsageError(
        f"Dissipativity of a {type(hysteresis).__name__} cannot be decided exactly. "
        "Give an analytic surface, a table on one partition, or a measure of relays."
    )


@_certified.register
def _certified_mirrored(hysteresis: Mirrored) -> DissipativityCertificate:
    image = certify(hysteresis.image)
    high, low = image.at
    # magnetic curves are given mirrored, and their inputs are not in kelvin
    return replace(image, at=(-low, -high), unit="", input_unit="")


@_certified.register
def _certified_relays(hysteresis: RelayMeasure) -> DissipativityCertificate:
    return _exact(*_least_of_relays(hysteresis), rounding(hysteresis))


@_certified.register
def _certified_table(hysteresis: FodTable) -> DissipativityCertificate:
    cells = (hysteresis.nodes.size - 1) * (hysteresis.nodes.size - 2) // 2
    return _in_units(_exact(*least_area(hysteresis), cells, rounding(hysteresis)), hysteresis.unit)


@_certified.register
def _certified_surface(hysteresis: FodSurface) -> DissipativityCertificate:
    return _in_units(_bounded(hysteresis, rounding(hysteresis)), hysteresis.unit)


def _in_units(found: DissipativityCertificate, unit: str) -> DissipativityCertificate:
    return replace(found, unit=f"{unit}·K", input_unit="K") if unit else found


def _exact(
    area: float, at: tuple[float, float], evaluations: int, tolerance: float
) -> DissipativityCertificate:
    area = 0.0 if area >= -tolerance else area
    return DissipativityCertificate(area == 0.0, area, at, area, evaluations, tolerance)


def _least_of_relays(measure: RelayMeasure) -> tuple[float, tuple[float, float], int]:
    """A changes only at thresholds. It is the Everett function of the measure mass · (α − β)."""
    losses = RelayMeasure.from_arrays(
        measure.alpha, measure.beta, measure.mass * (measure.alpha - measure.beta)
    )
    high, low = np.unique(measure.alpha), np.unique(measure.beta)
    areas = np.where(high[:, None] > low, losses.swept(high[:, None], low), 0.0)
    i, j = np.unravel_index(int(np.argmin(areas)), areas.shape)
    return float(min(areas[i, j], 0.0)), (float(high[i]), float(low[j])), areas.size


def _bounded(surface: FodSurface, tolerance: float) -> DissipativityCertificate:
    """Halve the cells until the bound decides and, if the answer is no, until it is tight."""
    small = negative_small_loop(surface)
    cells, evaluations = _FIRST_CELLS, 0
    while True:
        bound = area_bound(surface, cells, tolerance)
        evaluations += cells * (cells + 1) // 2
        area, at = _refined_minimum(surface, bound)
        negative = area < -tolerance
        if small is not None and not negative:
            (area, at), negative = small, True
        verified = bound.low >= 0.0 and not negative
        tight = negative and bound.low > (1 + _TIGHTNESS) * area
        if verified or tight or 2 * cells > _MAX_CELLS:
            break
        cells *= 2
    verdict = True if verified else (False if negative else None)
    if not negative:
        area, at = 0.0, (at[0], at[0])
    return DissipativityCertificate(verdict, area, at, bound.low, evaluations, tolerance)


def _refined_minimum(surface: FodSurface, bound: AreaBound) -> tuple[float, tuple[float, float]]:
    """The smallest area among the nodes, refined to the nearby minimum."""
    if bound.area >= 0:
        return bound.area, bound.at
    scale = (surface.upper - surface.lower) / 100
    found = minimize(
        lambda x: float(area_of(surface, x[0] * scale, x[1] * scale)) / abs(bound.area),
        np.array(bound.at) / scale,
        bounds=[(surface.lower / scale, surface.upper / scale)] * 2,
        method="L-BFGS-B",
    )
    high, low = (float(v) * scale for v in found.x)
    if low < high and found.fun < -1:
        return float(area_of(surface, high, low)), (high, low)
    return bound.area, bound.at
