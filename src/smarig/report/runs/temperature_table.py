"""The transformation temperatures, widths and strokes of compared runs, side by side."""

from collections.abc import Mapping

from smarig.core import spaced
from smarig.record import Run
from smarig.report.components.html import Html, table
from smarig.report.components.numbers import interval_text, to_uncertainty
from smarig.report.components.run_description import display_unit
from smarig.report.transformation.transformation_tables import figure_name, figures_of
from smarig.transformation import HEADLINE, RunFigures

_MOST = 6  # runs: more columns do not fit, and have a figure of their trends


def temperature_table(runs: Mapping[str, Run]) -> Html | None:
    """The figures of each run with their 95 % intervals; None if no run has any, or if the runs are many."""
    found = {name: figures for name, run in runs.items() if (figures := figures_of(run)) is not None}
    if not found or len(found) > _MOST:
        return None
    rows = [
        (figure_name(name), *(_cell(figures, name) for figures in found.values()))
        for name in HEADLINE
        if any(name in figures.means for figures in found.values())
    ]
    assembled = [name for name, figures in found.items() if figures.assembled]
    words = f" Branches assembled from first-order curves: {', '.join(assembled)}." if assembled else ""
    return table(("Quantity", *found), rows, f"By tangents to the branches, with 95 % intervals.{words}")


def _cell(figures: RunFigures, name: str) -> str:
    if name not in figures.means:
        return "–"
    estimate = figures.estimate(name)
    low, high = estimate.ci95
    half = (high - low) / 2
    ends = interval_text(low, high)
    return (
        f"{to_uncertainty(estimate.value, half)}{spaced(display_unit(estimate.unit))}{ends and f' ({ends})'}"
    )
