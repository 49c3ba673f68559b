"""Transformation temperatures of a run as JSON."""

from typing import Any

from smarig.transformation.cycle_figures import TEMPERATURES, Drawn
from smarig.transformation.run_figures import RunFigures


def run_json(run: RunFigures) -> dict[str, Any]:
    """The object of one run: means, cycles, drift, and which branches were used."""
    return {
        "run": run.name,
        "input_unit": run.record.input_unit,
        "unit": run.record.unit,
        "ambient_degC": run.record.ambient_degC,
        "stress_MPa": run.stress_MPa,
        "twin": run.run.twin,
        "wire": run.wire,
        "start_epoch": run.start_epoch,
        "figures": figures_json(run, run.means),
        "cycles": [
            {
                "cycle": c.number,
                "heating": c.heating is not None,
                "cooling": c.cooling is not None,
                "figures": figures_json(run, c.figures),
                "why_not": c.why_not,
            }
            for c in run.cycles
        ],
        "averaged_cycles": list(run.averaged),
        "no_drift": run.no_drift,
        "drift": {name: e.to_json() for name, e in run.drift.items()},
        "unused": [u.to_json() for u in run.unused],
        "notes": list(run.notes),
    }


def figures_json(run: RunFigures, figures: dict[str, Drawn]) -> dict[str, Any]:
    """Figures as JSON objects; temperatures also in °C, and above ambient where the ambient temperature is known."""
    found: dict[str, Any] = {}
    for name, drawn in figures.items():
        low, high = drawn.ci95
        one: dict[str, Any] = {"value": drawn.value, "ci95": [low, high], "unit": run.unit_of(name)}
        if name in TEMPERATURES:
            one["degC"] = run.degC(drawn.value)
            one["above_ambient_K"] = _above_ambient(run, drawn.value)
        found[name] = one
    return found


def _above_ambient(run: RunFigures, value: float) -> float | None:
    degC, ambient = run.degC(value), run.record.ambient_degC
    if degC is not None and ambient is not None:
        return degC - ambient
    return value if run.record.above_ambient else None
