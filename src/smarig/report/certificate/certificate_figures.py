"""The figure of a certificate: μ in the Preisach plane with its negative regions, and ψ with its range."""

from dataclasses import replace

import numpy as np

from smarig.certificate import ModelCertificate
from smarig.control import Psi
from smarig.core import Array, spaced
from smarig.identification import DensityReport, density_report
from smarig.replay import Model
from smarig.report.components.figure import Figure, Panel, axis, dots, line
from smarig.report.components.numbers import number
from smarig.report.components.run_description import display_unit
from smarig.report.components.style import INK, MODEL
from smarig.report.models.identification_plot_data import density_of
from smarig.report.models.plane_figures import map_panel, per_square


def certificate_figure(model: Model, found: ModelCertificate, origin: str, label: str) -> Figure:
    """μ over the Preisach plane with its negative regions, and ψ(ℓ)."""
    units = (display_unit(model.unit), model.input.unit)
    report = density_report(model.hysteresis)
    least, g = found.classes.mu_min, found.classes.g_min
    where = f"α = {number(least.at[0], 4)}, β = {number(least.at[1], 4)}{spaced(units[1])}"
    part = f"; {report.negative_cells} of {report.cells} cells are negative" if report.cells else ""
    psi, grid = Psi(model.hysteresis), density_of(model.hysteresis)
    negative_text = "Circles" if report.cells else "Outlined and tinted"
    return Figure(
        [_density_panel(grid, report, units), _psi_panel(psi, units)],
        "Weighting function μ(α, β), and ψ(ℓ), the output of the state α = 2ℓ − β.",
        [
            "First panel: white is zero, red positive, blue negative. "
            f"{negative_text}: μ < 0, even if small; "
            f"cross: the minimum, {number(least.value)} {per_square(*units)} at {where}{part}. "
            f"The minimum of g is {number(g.value)}{spaced(units[0])}/{units[1]}.",
            "Second panel: ψ covers the range from the smallest to the largest output, so each set-point in between "
            "has a diagonal state α = 2ℓ − β"
            + (" (Thm 8.5)." if psi.monotone else "; ψ is not monotone, and the smallest ℓ is used."),
            origin,
        ],
        label,
        440,
    )


def _density_panel(grid: tuple[Array, Array, Array], report: DensityReport, units: tuple[str, str]) -> Panel:
    """The map of μ; circles mark negative cells of a table, whose colours may be too pale to see."""
    panel = map_panel("", grid, report, units)
    alpha, beta, mu = grid
    if not report.negative_cells or alpha.size == mu.shape[0]:
        return panel
    row, column = np.nonzero(mu < 0)
    middle = (alpha[row] + alpha[row + 1]) / 2, (beta[column] + beta[column + 1]) / 2
    rings = dots(middle[1], middle[0], "μ < 0", INK, symbol="circle-open", size=6)
    return replace(panel, data=[*panel.data, rings])


def _psi_panel(psi: Psi, units: tuple[str, str]) -> Panel:
    ell, y = psi.curve
    ends = ([psi.lower, psi.upper], [psi.y_lower, psi.y_upper])
    data = [line(ell, y, "ψ(ℓ)", MODEL, width=2), dots(*ends, "smallest and largest output", INK, size=7)]
    layout = {"xaxis": axis(f"ℓ ({units[1]})"), "yaxis": axis(f"Output ψ(ℓ) ({units[0]})")}
    return Panel(data, layout, 430)
