"""The headline figures of a study in the words of the field: temperatures, stroke, width, stress, error and noise."""

from collections.abc import Iterator, Sequence

from smarig.core import capitalised, spaced
from smarig.record import Run
from smarig.report import (
    Html,
    display_unit,
    figure_name,
    interval_text,
    number,
    runs_table,
    signed,
    tag,
    to_uncertainty,
)
from smarig.report import table as html_table
from smarig.study.input_correction import CORRECTED
from smarig.study.runs_by_condition import conditions_text
from smarig.study.study_figure import load_of, load_text
from smarig.study.study_result import StudyResult
from smarig.transformation import FIGURES, TEMPERATURES, RunFigures

Row = tuple[Html | str, str, str]
_SHOWN = ("A_s", "A_f", "M_s", "M_f", "width", "stroke")
_MOST_RUNS = 8  # whose temperatures stand beside the loop


def key_figures(result: StudyResult, run: Run) -> Iterator[Html]:
    """The tables of figures beside the loop of a run: the temperatures of all runs, else of that run, then the rest."""
    runs = result.transformation.runs if result.transformation else ()
    several = len(runs) > 1
    if several:
        yield temperatures_by_run(runs[:_MOST_RUNS], TEMPERATURES, f"Temperatures.{_corrected(result)}")
    found = None if several or result.transformation is None else result.transformation.of(run)
    rows = [
        *(_temperatures(found) if found else ()),
        *_slopes(result),
        *_field_loops(result),
        *_model(result),
    ]
    what = f"{found.name}, and the model.{_corrected(result)}" if found else "The model."
    if any(interval for *_, interval in rows):
        yield html_table(("Quantity", "Value", "95 % interval"), rows, what)
    else:
        yield html_table(("Quantity", "Value"), [(name, value) for name, value, _ in rows], what)


def temperatures_by_run(
    runs: Sequence[RunFigures], names: Sequence[str] = FIGURES, caption: str = "", *, stacked: bool = False
) -> Html:
    """The figures of several runs, a row each; a run is called by its load, in order, where each has another."""
    by_load = {load_text(r.run).replace(" ", "\u00a0"): r for r in sorted(runs, key=lambda r: load_of(r.run))}
    if len(by_load) == len(runs) and "" not in by_load:
        return runs_table(by_load, names, "Load", caption, stacked=stacked)
    return runs_table({r.name: r for r in runs}, names, "Run", caption, stacked=stacked)


def _field_loops(result: StudyResult) -> Iterator[Row]:
    """Coercive field, bias and remanence at each condition; of several loops with their range for an interval."""
    for loops in result.field_loops:
        at = conditions_text(loops.conditions)
        rows = (
            ("Coercive field", loops.coercive, loops.field_unit),
            ("Bias of the field", loops.bias, loops.field_unit),
            ("Remanence", loops.remanence, loops.unit),
            ("Half the range of the output", loops.saturation, loops.unit),
        )
        for name, (mean, low, high), unit in rows:
            ends = number(low), number(high)
            several = f"{' to '.join(ends)} in {loops.loops} loops" if ends[0] != ends[1] else ""
            yield f"{name}, {at}" if at else name, _value(mean, unit), several


def _corrected(result: StudyResult) -> str:
    found = result.transformation and result.transformation.corrected_for
    return f" Corrected for the {CORRECTED[found.name]} of the thermometer." if found else ""


def _model(result: StudyResult) -> Iterator[Row]:
    if result.evaluation is None:
        return
    unit = result.unit
    if result.function is not None:
        over = result.function.rms >= result.function.noise
        yield "Error of the curve, rms", _value(result.function.rms, unit) if over else "within the noise", ""
        yield "Error of the model, rms", _value(result.function.model_rms, unit), ""
        yield "Noise of a reading", _value(result.function.noise, unit, 2), ""
        return
    yield "Error, rms", _value(result.evaluation.best.rms, unit), ""
    yield "Error over the range", f"{number(100 * result.nrmse, 2)} %", ""
    yield capitalised(result.noise_name), _value(result.noise, unit, 2) if result.noise else "not known", ""


def _temperatures(found: RunFigures) -> Iterator[Row]:
    for name in _SHOWN:
        if name in found.means:
            drawn, unit = found.means[name], display_unit(found.unit_of(name))
            low, high = drawn.ci95
            half = (high - low) / 2
            if name in found.at_least:
                yield figure_name(name), f"at least {_value(drawn.value, unit)}", ""
                continue
            yield (
                figure_name(name),
                f"{to_uncertainty(drawn.value, half)}{spaced(unit)}",
                f"{interval_text(low, high)}{_drift_text(found, name)}".removeprefix("; "),
            )


def _drift_text(found: RunFigures, name: str) -> str:
    """By how much a figure changes with each cycle, which the interval of its mean does not show; "" if not at all."""
    drift = found.drift.get(name)
    if drift is None or drift.ci95[0] <= 0 <= drift.ci95[1]:
        return ""
    return f"; drifts by {signed(drift.value, 2)}{spaced(display_unit(found.unit_of(name)))} a cycle"


def _slopes(result: StudyResult) -> Iterator[Row]:
    """Clausius–Clapeyron: the stress that moves A_s and M_s by 1 K; without a stress, their slope over the load."""
    for name, MPa_per_K, (low, high) in result.transformation.slopes if result.transformation else ():
        if name in ("A_s", "M_s") and low is not None and high is not None:
            label = tag("span", figure_name(name), " rises 1 K per")
            yield label, f"{number(MPa_per_K)} MPa", f"{number(low)} to {number(high)}"
    for s in result.transformation.load_slopes if result.transformation else ():
        if s.temperature in ("A_s", "M_s"):
            label = tag("span", figure_name(s.temperature), f" rises per {s.unit} of load")
            yield label, f"{number(s.K_per_unit)} K", f"{number(s.ci95[0])} to {number(s.ci95[1])}"


def _value(value: float, unit: str, digits: int = 3) -> str:
    return f"{number(value, digits)}{spaced(display_unit(unit))}"
