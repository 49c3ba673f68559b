"""Runs as a family over one variable: their load, the day they were made, or their order."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smarig.core import UsageError
from smarig.identification import Estimate
from smarig.record import Run
from smarig.report.components.figure import Figure, Panel, axis, line
from smarig.report.components.run_description import display_unit, extent, source_label
from smarig.report.components.style import COMPARED
from smarig.report.transformation.tangent_figures import estimate_traces
from smarig.transformation import TEMPERATURES, headline

_DAY_S = 86400.0
_SAME_DAY_S = 3600.0


@dataclass(frozen=True)
class FamilyVariable:
    """What the runs of a family differ by: ``name``, ``unit`` and the ``values`` of the runs."""

    name: str
    unit: str
    values: tuple[float, ...]

    @property
    def title(self) -> str:
        """The variable as the title of an axis."""
        return f"{self.name} ({self.unit})" if self.unit else self.name

    @property
    def order(self) -> list[int]:
        """The runs in the order of the variable."""
        return sorted(range(len(self.values)), key=lambda k: self.values[k])

    def text(self, k: int) -> str:
        """The value of a run with its unit."""
        return f"{self.values[k]:.3g}{' ' + self.unit if self.unit else ''}"


@dataclass(frozen=True)
class FamilyFigures:
    """The headline figures of each run of a family, by name: stroke always, others as far as a run gives them."""

    variable: FamilyVariable
    strokes: tuple[float, ...]
    figures: tuple[dict[str, Estimate], ...]


def family_figures(runs: Sequence[Run]) -> FamilyFigures:
    """Variable, strokes and headline figures of runs."""
    return FamilyFigures(
        _variable(runs), tuple(extent(run, "position") for run in runs), tuple(map(_headline, runs))
    )


def _headline(run: Run) -> dict[str, Estimate]:
    try:
        return headline(run) if run.has("input") else {}
    except UsageError:
        return {}


def _variable(runs: Sequence[Run]) -> FamilyVariable:
    loads = [_stress(run) for run in runs]
    if None not in loads and len(set(loads)) > 1:
        return FamilyVariable("Stress", "MPa", tuple(value for value in loads if value is not None))
    starts = [run.info.start_epoch for run in runs]
    known = [start for start in starts if start is not None]
    if len(known) == len(runs) and max(known) - min(known) > _SAME_DAY_S:
        days = tuple((start - min(known)) / _DAY_S for start in known)
        if max(days) >= 2:
            return FamilyVariable("Time since the first run", "days", days)
        return FamilyVariable("Time since the first run", "h", tuple(24 * day for day in days))
    return FamilyVariable("Run, in the order given", "", tuple(float(k + 1) for k in range(len(runs))))


def _stress(run: Run) -> float | None:
    """The mean of the recorded stress of a run in MPa, rounded to a tenth; None if unknown."""
    stored = run.info.conditions.get("stress")
    mean = stored.get("mean") if isinstance(stored, dict) and stored.get("unit") == "MPa" else None
    return round(float(mean), 1) if isinstance(mean, int | float) and np.isfinite(mean) else None


def trend_figure(found: FamilyFigures, runs: Sequence[Run]) -> Figure | None:
    """Stroke, and temperatures and width where known, against the variable; None for fewer than three runs."""
    if len(runs) < 3:
        return None
    order, x = found.variable.order, np.array(found.variable.values)
    across = axis(found.variable.title, **({} if found.variable.unit else {"dtick": 1}))
    unit = display_unit(runs[0].unit)
    stroke_trace = line(
        x[order],
        np.array(found.strokes)[order],
        "stroke",
        COMPARED[0],
        mode="lines+markers",
        marker={"size": 7},
    )
    panels = [
        Panel([stroke_trace], {"xaxis": across, "yaxis": axis(f"Stroke ({unit})"), "showlegend": False}, 340)
    ]
    points = list(zip(x.tolist(), found.figures))
    temperatures = [t for name in TEMPERATURES for t in estimate_traces(name, points)]
    if temperatures:
        title = axis(f"Transformation temperature ({display_unit(runs[0].input_unit)})")
        panels.append(Panel(temperatures, {"xaxis": across, "yaxis": title}, 340))
    words = "Bars: 95 % intervals." if temperatures else ""
    return Figure(panels, "Trends over the runs.", [words], source_label(*runs), 460)
