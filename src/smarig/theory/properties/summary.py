"""All properties of chapter 4 of a hysteresis in one result, computed on request and never stored."""

import math
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

from smarig.preisach import Everett, unmirrored
from smarig.theory.properties.branch_and_bound import Extreme
from smarig.theory.properties.classes import MeasureClasses, classes
from smarig.theory.properties.continuity import lipschitz, modulus
from smarig.theory.properties.monotone import (
    Crossing,
    Monotonicity,
    crossing_ascending,
    crossing_descending,
    monotone,
)
from smarig.theory.properties.strip_integrals import K, bound
from smarig.theory.properties.sweep_changes import ChangeBounds, largest_change
from smarig.theory.properties.triangle_grid import MeasureKind, TriangleGrid

_KIND_NAMES = {
    "surface": "a surface",
    "table": "a table",
    "relays": "a measure of relays",
    "sampled": "a sampled hysteresis",
}
INPUT_SHARES = (1 / 16, 1 / 8, 1 / 4, 1 / 2, 1.0)


@dataclass(frozen=True)
class OutputChange:
    """Largest effects of an input change of ``xi`` (K) on the output.

    ``K`` of §4.1 is the largest change for ν ≥ 0. ``bound`` = 2∬|μ| + ∫|g| over the widest strip holds for any ν.
    ``largest`` is the true largest change. ``modulus`` is the largest difference of the outputs of two inputs that stay
    within ``xi`` of each other.
    """

    xi: float
    K: float
    bound: float
    largest: ChangeBounds
    modulus: ChangeBounds


@dataclass(frozen=True, repr=False)
class Properties:
    """Chapter 4 for a hysteresis on [``lower``, ``upper``] with outputs from ``y_lower`` to ``y_upper``.

    ``kind``: surface (bounds proved), table or relays (exact), sampled (nothing proved between samples). ``lipschitz``
    is C of Lemma 4.2 with g: every change is at most C times its ``xi``. ``changes`` are given for 1/16, 1/8, 1/4, 1/2
    and the whole of the input range. ``unit`` is that of outputs, and empty if the hysteresis has none.
    """

    kind: MeasureKind
    lower: float
    upper: float
    y_lower: float
    y_upper: float
    classes: MeasureClasses
    monotone: Monotonicity
    fod_crossing: Crossing | None
    foa_crossing: Crossing | None
    lipschitz: float
    changes: tuple[OutputChange, ...]
    unit: str = ""

    def to_json(self) -> dict[str, Any]:
        """Plain values by field name, including the results for the classes; None for NaN and for infinity."""
        plain = _plain_values(self)
        c = self.classes
        plain["classes"] |= {"M_PC": c.M_PC, "M_P": c.M_P, "positive": c.positive}
        plain["monotone"]["holds"] = self.monotone.holds
        return plain

    def __repr__(self) -> str:
        c, m = self.classes, self.monotone
        unit = f"{self.unit} " if self.unit else ""
        of = ("relay", "relay", "threshold") if c.atoms else ("K²", "K", "K")
        per = [f"{unit}per {what}" for what in of]
        lines = [
            f"Properties of {_KIND_NAMES[self.kind]} on [{self.lower:g}, {self.upper:g}], "
            f"output {self.y_lower:g} … {self.y_upper:g} {unit}".rstrip(),
            f"  classes   M_PC {_yes_no(c.M_PC)}, M_P {_yes_no(c.M_P)}, ν ≥ 0 {_yes_no(c.positive)}",
            f"  μ         least {_extreme_text(c.mu_min)}, largest {_extreme_text(c.mu_max)} {per[0]}",
            f"  g         least {_extreme_text(c.g_min)}, largest {_extreme_text(c.g_max)} {per[1]}; "
            f"{100 * c.reversible_share:.1f} % of the range",
            f"  slopes    rising ≥ {_extreme_text(m.rising)}, falling ≥ {_extreme_text(m.falling)} {per[2]}: "
            "output follows input "
            + (_yes_no(m.holds) if m.holds else f"no, up to {m.setback:.3g} {unit}against it"),
            f"  crossing  FOD {_crossing_text(self.fod_crossing)}; FOA {_crossing_text(self.foa_crossing)}",
            f"  C         {self.lipschitz:.4g} (|Δy| ≤ C |Δu|)",
            "  ξ         K(ξ)      2∬|μ|+∫|g|  largest change      modulus of continuity",
        ]
        lines += [
            f"  {d.xi:<8.4g}  {d.K:<8.4g}  {d.bound:<10.4g}  {_bounds_text(d.largest):<18}  {_bounds_text(d.modulus)}"
            for d in self.changes
        ]
        return "\n".join(lines)


def properties(hysteresis: Everett) -> Properties:
    """All properties of any hysteresis. It takes about a second for a surface.

    >>> from smarig.preisach import thesis_surface
    >>> p = properties(thesis_surface("one_c"))
    >>> p.classes.M_P, p.monotone.holds, p.fod_crossing
    (True, True, None)
    """
    h = getattr(hysteresis, "hysteresis", hysteresis)  # accept an operator in place of its hysteresis
    plane = TriangleGrid.of(h)
    return Properties(
        kind=plane.kind,
        lower=float(h.lower),
        upper=float(h.upper),
        y_lower=float(h.y_lower),
        y_upper=float(h.y_lower + h.everett(h.upper, h.lower)),
        classes=classes(h),
        monotone=monotone(h),
        fod_crossing=crossing_descending(h),
        foa_crossing=crossing_ascending(h),
        lipschitz=lipschitz(h),
        changes=tuple(
            OutputChange(xi, K(h, xi), bound(h, xi), largest_change(h, xi), modulus(h, xi))
            for xi in (share * plane.span for share in INPUT_SHARES)
        ),
        unit=getattr(unmirrored(h), "unit", ""),
    )


def _plain_values(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        return {f.name: _plain_values(getattr(value, f.name)) for f in fields(value)}
    if isinstance(value, tuple):
        return [_plain_values(v) for v in value]
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    return value


def _yes_no(holds: bool) -> str:
    return "yes" if holds else "no"


def _extreme_text(e: Extreme) -> str:
    return "none" if math.isnan(e.value) else f"{e.value:.3g} at ({e.at[0]:.4g}, {e.at[1]:.4g})"


def _crossing_text(c: Crossing | None) -> str:
    return (
        "none found" if c is None else f"{c.lower:.4g} and {c.higher:.4g} near {c.at:.4g}, by {c.depth:.3g}"
    )


def _bounds_text(r: ChangeBounds) -> str:
    if r.bound <= r.attained * (1 + 1e-9):
        return f"{r.attained:.4g}"
    return f"{r.attained:.4g} … {'?' if math.isnan(r.bound) else f'{r.bound:.4g}'}"
