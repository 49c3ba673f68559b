"""Tables and cards of transformation temperatures: figures, compared runs, stress dependence, branches."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence

from smarig.core import UsageError, capitalised, spaced
from smarig.record import Run
from smarig.report.components.html import Html, bullets, cards, joined, paragraph, table, tag, with_subscripts
from smarig.report.components.numbers import interval_text, number, signed, to_interval
from smarig.report.components.run_description import display_unit
from smarig.transformation import (
    FIGURES,
    HEADLINE,
    NAMES,
    TEMPERATURES,
    RunFigures,
    StressSlope,
    cycles_text,
    run_figures,
    why_not,
)

_CARDS = (*TEMPERATURES, "stroke", "width")


def figure_name(name: str) -> Html:
    """The name of a figure with its subscript."""
    words = NAMES.get(name, name)
    return joined(
        tag("sub", part[1:]) if part.startswith("_") else part
        for part in re.split(r"(_[spf])", capitalised(words))
    )


def figures_of(run: Run) -> RunFigures | None:
    """The figures of a run; None if it has no full loop over a temperature."""
    try:
        return run_figures(run) if run.has("input") and run.has("position") else None
    except UsageError:
        return None


def temperature_cards(run: RunFigures) -> Html:
    """Cards of A_s, A_f, M_s, M_f, stroke and width; those that are missing say why."""
    return cards([_card(run, name) for name in _CARDS])


def _card(run: RunFigures, name: str) -> tuple[Html, str, str]:
    label = figure_name(name)
    if name not in run.means:
        return label, "–", capitalised(why_not(run, name))
    drawn, unit = run.means[name], spaced(display_unit(run.unit_of(name)))
    interval = interval_text(*drawn.ci95, unit)
    degC = run.degC(drawn.value) if name in TEMPERATURES and run.record.input_unit != "degC" else None
    parts = [f"95 %: {interval}"] if interval else []
    parts += [f"{degC:.1f} °C"] if degC is not None else []
    parts += ["no readings between"] if name in run.gaps else []
    return label, f"{to_interval(drawn.value, drawn.ci95)}{unit}", "; ".join(parts)


def figures_table(run: RunFigures) -> Html:
    """All figures of a run with intervals, drift, number of cycles, or the reason why not."""
    header = ["Quantity", "Value", "95 % interval", "Unit", "Cycles", "Drift per cycle"]
    ambient = run.record.input_unit != "degC"
    if ambient:
        header.insert(2, "°C")
    rows = [_row(run, name, ambient) for name in FIGURES]
    reason = f" Drift not given: {run.no_drift}." if run.no_drift and len(run.cycles) > 1 else ""
    return table(header, rows, f"Figures of {run.name}, means over {cycles_text(run.averaged)}.{reason}")


def runs_table(
    runs: Mapping[str, RunFigures], names: Sequence[str], first: str, caption: str, *, stacked: bool = False
) -> Html:
    """The figures ``names`` of several runs, a row each, in digits that their intervals allow.

    ``runs`` are by label, and ``first`` is the head of that column.
    """
    shown = [name for name in names if any(name in run.means for run in runs.values())]
    units = {
        name: next(display_unit(r.unit_of(name)) for r in runs.values() if name in r.means) for name in shown
    }
    header = (first, *(joined((figure_name(name), f" ({units[name]})")) for name in shown))
    rows = [(label, *(_rounded(run, name) for name in shown)) for label, run in runs.items()]
    return table(header, rows, caption, stacked=stacked)


def _rounded(run: RunFigures, name: str) -> str:
    found = run.means.get(name)
    return "–" if found is None else to_interval(found.value, found.ci95)


def _row(run: RunFigures, name: str, ambient: bool) -> list[object]:
    label = figure_name(name)
    if name not in run.means:
        return [label, f"not given: {why_not(run, name)}", *([""] if ambient else []), "", "", "", ""]
    drawn = run.means[name]
    degC = run.degC(drawn.value) if name in TEMPERATURES else None
    also = [f"{degC:.1f}" if degC is not None else ""] if ambient else []
    drift = run.drift.get(name)
    slope = f"{signed(drift.value)} ({signed(drift.ci95[0])} to {signed(drift.ci95[1])})" if drift else "–"
    return [
        label,
        to_interval(drawn.value, drawn.ci95),
        *also,
        interval_text(*drawn.ci95, missing="–"),
        display_unit(run.unit_of(name)),
        str(run.counts[name]),
        slope,
    ]


def stress_table(slopes: Sequence[StressSlope]) -> Html:
    """C = dσ/dT of each temperature with its interval."""
    header = (
        "Temperature",
        "Load",
        "C (MPa/K)",
        "95 % interval",
        "dT/dσ (K/MPa)",
        "95 % interval",
        "Stress (MPa)",
        "Runs",
    )
    return table(header, [_stress_row(s) for s in slopes], "Clausius–Clapeyron coefficient C = dσ/dT.")


def _stress_row(s: StressSlope) -> tuple[object, ...]:
    least, most = s.C_ci95_MPa_per_K
    low, high = s.dT_dstress_ci95_K_per_MPa
    return (
        figure_name(s.temperature),
        s.load,
        number(s.C_MPa_per_K) if s.C_MPa_per_K is not None else "not determined",
        f"{number(least)} to {number(most)}" if least is not None else "–",
        number(s.dT_dstress_K_per_MPa),
        f"{number(low)} to {number(high)}",
        f"{number(s.stress_range_MPa[0], 4)} to {number(s.stress_range_MPa[1], 4)}",
        str(s.n),
    )


def branches_text(run: RunFigures) -> Html:
    """Which branches were used, and which were not and why."""
    used = sum((c.heating is not None) + (c.cooling is not None) for c in run.cycles)
    unit = display_unit(run.record.input_unit)
    items = [*run.notes, *(f"Not used: {u.sentence(unit)}" for u in run.unused)]
    return joined(
        [
            paragraph(f"{run.name}: branches used: {used}, of cycles: {len(run.cycles)}."),
            bullets(map(with_subscripts, items)),
        ]
    )


_STROKE = "stroke"  # has a card of its own
_DIFFERENCES = ("width", "span")  # of temperatures
_COMPUTED = " No thermometer was on the wire: its temperature is computed from the measured current."


def narrowest_temperature_cards(runs: Iterable[Run]) -> tuple[Html, str]:
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
        unit = spaced(display_unit(estimate.unit))
        interval = interval_text(*estimate.ci95, unit)
        interval = interval and f"95 %: {interval}"
        is_above = estimate.unit == "K" and name not in _DIFFERENCES
        above = f"above ambient{_degC(best, estimate.value)}; " if is_above else ""
        value = f"{to_interval(estimate.value, estimate.ci95)}{unit}"
        shown.append((figure_name(name), value, f"{above}{interval}"))
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
    ends, unit = interval_text(*estimate.ci95), spaced(display_unit(estimate.unit))
    return f"{to_interval(estimate.value, estimate.ci95)}{unit}{ends and f' ({ends})'}"
