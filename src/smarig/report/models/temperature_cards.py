"""Cards of the transformation temperatures and the width of a characterised wire."""

import math
from collections.abc import Iterable

from smarig.core import spaced
from smarig.record import Run
from smarig.report.components.html import Html, cards
from smarig.report.components.numbers import interval_text, to_uncertainty
from smarig.report.components.run_description import display_unit
from smarig.report.transformation.transformation_tables import figure_name, figures_of
from smarig.transformation import HEADLINE, RunFigures

_STROKE = "stroke"  # has a card of its own
_DIFFERENCES = ("width", "span")  # of temperatures
_COMPUTED = " No thermometer was on the wire: its temperature is computed from the measured current."


def temperature_cards(runs: Iterable[Run]) -> tuple[Html, str]:
    """A_s, A_f, M_s, M_f and width with their 95 % intervals, of the run with the narrowest, and a sentence on it.

    Most campaigns have no full loop of their own: the heating branch is then assembled from first-order curves, and the
    intervals are as wide as the distances of their readings.
    """
    found = [(figures, run) for run in runs if run.settled and (figures := figures_of(run)) is not None]
    if not found:
        return Html(""), ""
    best, run = min(found, key=lambda pair: _spread(pair[0]))
    shown = []
    for name in HEADLINE:
        if name == _STROKE or name not in best.means:
            continue
        estimate = best.estimate(name)
        low, high = estimate.ci95
        half, unit = (high - low) / 2, spaced(display_unit(estimate.unit))
        interval = interval_text(low, high, unit)
        interval = interval and f"95 %: {interval}"
        above = (
            ""
            if estimate.unit != "K" or name in _DIFFERENCES
            else f"above ambient{_degC(best, estimate.value)}; "
        )
        shown.append(
            (figure_name(name), f"{to_uncertainty(estimate.value, half)}{unit}", f"{above}{interval}")
        )
    name = run.path.name.removesuffix(".run.sqlite")
    assembled = f" ({' and '.join(best.assembled)} assembled from its curves)" if best.assembled else ""
    computed = "" if run.has("temperature_degC") or not run.info.input.from_ else _COMPUTED
    more = "; smarig transformation says what limits them" if best.notes else ""
    return cards(shown), f" Temperatures by tangents to {name}{assembled}{more}.{computed}"


def _degC(figures: RunFigures, above_K: float) -> str:
    """The same in °C, where the run knows the room's temperature."""
    degC = figures.degC(above_K)
    return "" if degC is None else f", {degC:.1f} °C"


def _spread(figures: RunFigures) -> float:
    ends = [figures.estimate(name).ci95 for name in HEADLINE if name in figures.means and name != _STROKE]
    widths = [high - low for low, high in ends if high - low < math.inf]
    return sum(widths) / len(widths) if widths else math.inf
