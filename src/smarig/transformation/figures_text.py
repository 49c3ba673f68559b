"""Transformation temperatures as text: a table for each run, then stress and drift."""

from collections.abc import Iterator, Mapping, Sequence

from smarig.core import spaced
from smarig.identification import Estimate
from smarig.transformation.chosen_cycles import cycles_text
from smarig.transformation.cycle_figures import FIGURES, NAMES, TEMPERATURES
from smarig.transformation.run_figures import RunFigures
from smarig.transformation.stress_dependence import LoadSlope, StressSlope

_MOST_UNUSED = 5


def result_text(
    runs: Sequence[RunFigures],
    stress: Sequence[StressSlope],
    load: Sequence[LoadSlope],
    history: Mapping[str, Estimate],
) -> str:
    """The whole result."""
    lines = [line for run in runs for line in _run_lines(run)]
    if stress:
        lines += [
            "",
            "Stress dependence (Clausius–Clapeyron coefficient C = dσ/dT):",
            *map(_stress_line, stress),
        ]
    if load:
        lines += ["", "Load dependence (no stress is known):", *map(_load_line, load)]
    if history:
        lines += ["", "Drift over the cycles of all runs, in order of their start:", *_drift_lines(history)]
    return "\n".join(lines)


def value_text(run: RunFigures, figure: str) -> str:
    """A mean with its interval: "81.3 °C (80.4 to 82.1)"; temperatures above ambient also in °C."""
    drawn, unit = run.means[figure], run.unit_of(figure)
    low, high = drawn.ci95
    if figure in run.at_least:
        return f"at least {drawn.value:.4g}{spaced(shown_unit(unit))}"
    own = f"{drawn.value:.4g}{spaced(shown_unit(unit))} ({low:.4g} to {high:.4g})"
    degC = run.degC(drawn.value) if figure in TEMPERATURES else None
    if figure not in TEMPERATURES or unit == "degC":
        return own
    return f"{own}, {'°C not known' if degC is None else f'{degC:.4g} °C'}"


def shown_unit(unit: str) -> str:
    """A unit as shown: °C for degC."""
    return "" if unit == "1" else unit.replace("degC", "°C")


def _run_lines(run: RunFigures) -> Iterator[str]:
    stress = "" if run.stress_MPa is None else f", stress {run.stress_MPa:.4g} MPa"
    above = " Temperatures are above ambient." if run.record.above_ambient else ""
    one = "1 cycle" if len(run.cycles) == 1 else cycles_text(run.averaged)
    count = f"means over {one}" if len(run.averaged) > 1 else one
    yield f"{run.name}: {count}{stress}. 95 % intervals in brackets.{above}"
    for name in FIGURES:
        if name in run.means:
            yield f"  {NAMES.get(name, name):<25} {value_text(run, name)}"
        else:
            yield f"  {NAMES.get(name, name):<25} not given: {why_not(run, name)}"
    if run.drift:
        yield "  drift per cycle:"
        yield from (f"  {line}" for line in _drift_lines(run.drift))
    if run.no_drift and len(run.cycles) > 1:
        yield f"  drift not given: {run.no_drift}."
    yield from (f"  {note}" for note in run.notes)
    unit = shown_unit(run.record.input_unit)
    yield from (f"  Not used: {u.sentence(unit)}" for u in run.unused[:_MOST_UNUSED])
    if len(run.unused) > _MOST_UNUSED:
        yield f"  Not used: {len(run.unused) - _MOST_UNUSED} more branches (all with --json)."


def why_not(run: RunFigures, figure: str) -> str:
    """Why no cycle has a figure."""
    reasons = [c.why_not[figure] for c in run.cycles if figure in c.why_not]
    return reasons[0] if reasons else "no cycle has it"


def _stress_line(s: StressSlope) -> str:
    low, high = s.dT_dstress_ci95_K_per_MPa
    slope = f"dT/dσ = {s.dT_dstress_K_per_MPa:.3g} K/MPa ({low:.3g} to {high:.3g})"
    span = f"{s.stress_range_MPa[0]:.4g} to {s.stress_range_MPa[1]:.4g} MPa of {s.load}, n = {s.n}"
    if s.C_MPa_per_K is None:
        return f"  {s.temperature}: C not determined: the interval of its inverse contains 0. {slope}; {span}"
    least, most = s.C_ci95_MPa_per_K
    return f"  {s.temperature}: C = {s.C_MPa_per_K:.3g} MPa/K ({least:.3g} to {most:.3g}). {slope}; {span}"


def _load_line(s: LoadSlope) -> str:
    low, high = s.ci95
    span = f"{s.load_range[0]:.4g} to {s.load_range[1]:.4g} {s.unit}, n = {s.n}"
    return f"  {s.temperature}: {s.K_per_unit:.3g} K/{s.unit} ({low:.3g} to {high:.3g}); {span}"


def _drift_lines(drift: Mapping[str, Estimate]) -> Iterator[str]:
    for name, e in drift.items():
        low, high = e.ci95
        unit = shown_unit(e.unit.removesuffix("/cycle"))
        per = f"{unit}/cycle" if unit else "per cycle"
        yield f"  {NAMES.get(name, name):<25} {e.value:+.3g} {per} ({low:+.3g} to {high:+.3g}, n = {e.n})"
