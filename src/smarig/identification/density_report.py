"""The density μ = ½ ∂²y/∂α∂β of a model: its extremes, its class (Ch. 4), and its reversible share.

M_PC: bounded and piecewise continuous on P_r. M_P: also μ ≥ 0. For analytic surfaces the extremes are those of
``preisach.properties``. For tables they come from the masses of cells, never from differentiation. The report is
computed on demand and not stored.
"""

from dataclasses import dataclass, replace
from functools import lru_cache, singledispatch
from itertools import pairwise

import numpy as np

from smarig.preisach import Everett, FodSurface, FodTable, ForcTable, Mirrored, lattice
from smarig.theory import classes

Place = tuple[float, float]
_NAN = float("nan")
_CELLS = 40


@dataclass(frozen=True)
class DensityReport:
    """μ over P_r: minimum and maximum (output per K²) with their places (α, β), classes, reversible part.

    ``g_min`` is the least density of reversible relays on the diagonal (output per K). ``reversible_share`` is
    their share of the whole output range. A ``FodTable`` is reversible on its diagonal cells, so it has a
    ``g_min``; but cells cannot show the reversible share of a wire's output, so that share is NaN for tables.
    ``negative_cells`` of ``cells`` have negative mass (0 of 0 for surfaces).
    """

    mu_min: float
    mu_min_at: Place
    mu_max: float
    mu_max_at: Place
    M_PC: bool
    M_P: bool
    g_min: float = _NAN
    reversible_share: float = _NAN
    negative_cells: int = 0
    cells: int = 0

    def __repr__(self) -> str:
        classes = f"M_PC {'yes' if self.M_PC else 'no'}, M_P {'yes' if self.M_P else 'no'}"
        return f"DensityReport(μ from {self.mu_min:.3g} to {self.mu_max:.3g}, {classes})"


@lru_cache(maxsize=32)  # a page names the extremes of a surface in several places
def density_report(hysteresis: Everett) -> DensityReport:
    """Extremes and classes of a surface, a table, or the mirror image of one (whose μ(α, β) is μ̃(−β, −α))."""
    return _report(hysteresis)


@singledispatch
def _report(hysteresis: Everett) -> DensityReport:
    return _of_cells(hysteresis)


@_report.register
def _of_mirrored(hysteresis: Mirrored) -> DensityReport:
    r = density_report(hysteresis.image)
    low, high = ((-b, -a) for a, b in (r.mu_min_at, r.mu_max_at))
    return replace(r, mu_min_at=low, mu_max_at=high)


@_report.register
def _of_surface(hysteresis: FodSurface) -> DensityReport:
    c = classes(hysteresis)
    low, high = c.mu_min, c.mu_max
    return DensityReport(
        mu_min=low.value,
        mu_min_at=low.at,
        mu_max=high.value,
        mu_max_at=high.at,
        M_PC=c.M_PC,
        M_P=c.M_P,
        g_min=c.g_min.value,
        reversible_share=c.reversible_share,
    )


@_report.register
def _of_curves(hysteresis: ForcTable) -> DensityReport:
    """Interpolated curves are piecewise smooth: their seams are kinks, not jumps."""
    return replace(_of_cells(hysteresis), M_PC=True)


@_report.register
def _of_table(hysteresis: FodTable) -> DensityReport:
    """A finite table is piecewise smooth; its diagonal cells are its reversible part."""
    report = _of_cells(hysteresis)
    if not report.cells:
        return report
    rises = [hysteresis.everett(high, low) for low, high in pairwise(hysteresis.nodes.tolist())]
    return replace(report, M_PC=True, g_min=float(np.min(np.array(rises) / np.diff(hysteresis.nodes))))


def _of_cells(table: Everett) -> DensityReport:
    """Mass of rectangles [α₁, α₂] × [β₁, β₂]: F(α₂, β₁) − F(α₁, β₁) − F(α₂, β₂) + F(α₁, β₂) = 2∬μ."""
    nodes = lattice(table, _CELLS)
    n = nodes.size
    inputs = nodes.tolist()
    F = np.array([[table.everett(a, b) if b <= a else np.nan for b in inputs] for a in inputs])
    mass = F[1:, :-1] - F[:-1, :-1] - F[1:, 1:] + F[:-1, 1:]
    # a table stores outputs: a large zero causes rounding of its masses
    y_lower = abs(float(getattr(table, "y_lower", 0.0)))
    rounding = 1e-12 * float(np.nanmax(np.abs(F))) + 8 * float(np.finfo(float).eps) * y_lower
    mass = np.where(np.abs(mass) <= rounding, 0.0, mass)
    off_diagonal = np.tri(n - 1, k=-1, dtype=bool)
    width = np.diff(nodes)
    mu = np.where(off_diagonal, mass / (2 * width[:, None] * width), np.nan)
    if not off_diagonal.any():
        return DensityReport(_NAN, (_NAN, _NAN), _NAN, (_NAN, _NAN), M_PC=True, M_P=True)
    middle = (nodes[1:] + nodes[:-1]) / 2
    i, j = np.unravel_index(int(np.nanargmin(mu)), mu.shape)
    k, m = np.unravel_index(int(np.nanargmax(mu)), mu.shape)
    negative = int(np.sum(mass[off_diagonal] < 0))
    return DensityReport(
        mu_min=float(mu[i, j]),
        mu_min_at=(float(middle[i]), float(middle[j])),
        mu_max=float(mu[k, m]),
        mu_max_at=(float(middle[k]), float(middle[m])),
        M_PC=False,
        M_P=negative == 0,
        negative_cells=negative,
        cells=int(off_diagonal.sum()),
    )
