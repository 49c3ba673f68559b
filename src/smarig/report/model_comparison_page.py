"""The page that compares models: errors on the same runs, residuals, densities and provenance."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from smarig.core import spaced
from smarig.identification import PredictionErrors, RunVerification, density_report, verify
from smarig.record import Run
from smarig.replay import Model, simulate_samples, with_heating_of
from smarig.report.components.comparison_labels import banner, check_comparable_count
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, error_ground, line
from smarig.report.components.html import Html, bullets, joined, notice, paragraph, table, tag
from smarig.report.components.numbers import number, runs_text
from smarig.report.components.page import Section, page
from smarig.report.components.page_summary import box_level
from smarig.report.components.run_description import (
    count_size,
    display_unit,
    input_title,
    loop_axes,
    run_caption,
    source_label,
)
from smarig.report.components.style import COMPARED, DASHES, INK, MEASURED, SYMBOLS
from smarig.report.models.identification_plot_data import density_of, hysteresis_description
from smarig.report.models.model_tables import M_P, M_PC
from smarig.report.models.plane_figures import map_panel, per_square
from smarig.report.run_page import ending_notices
from smarig.report.runs.run_comparison_figures import coloured_name
from smarig.report.runs.run_tables import provenance_table, quality_table
from smarig.report.runs.sample_path import sample_path

_Verifications = Mapping[str, Mapping[str, RunVerification]]  # run → model → verification


_MOST_MARKS = 400


def models_page(models: Mapping[str, Model], runs: Mapping[str, Run]) -> str:
    """The HTML page of models by name, verified on runs by name in the order of their session.

    Raises the errors of ``verify``, and UsageError for more models than distinguishable colours.
    """
    check_comparable_count(list(models), "models")
    found = {name: verify(model, list(runs.values())).runs for name, model in models.items()}
    verifications = {run: {name: found[name][k] for name in models} for k, run in enumerate(runs)}
    figures = [residuals_figure(name, run, models, verifications[name]) for name, run in runs.items()]
    unit = display_unit(next(iter(models.values())).unit)
    sections = [
        Section(
            "Errors",
            "Errors",
            [
                _verdicts(verifications, unit),
                _errors(verifications, unit),
                *_warnings(verifications),
            ],
        ),
        Section("Predictions and residuals", "Residuals", figures),
        Section("Weighting functions", "Density μ", [densities_figure(models)]),
        Section("The models", "Models", [_origins(models)]),
        Section("The runs", "Runs", [quality_table(runs), provenance_table(runs)]),
    ]
    label, words = banner([source_label(run) for run in runs.values()])
    title = (
        f"Models on the same runs: {', '.join(models)}" if len(models) > 1 else f"Model {next(iter(models))}"
    )
    notices = ending_notices(list(runs.values()))
    lead = f"Verified on {', '.join(Path(name).name for name in runs)}"
    return page(title, lead, sections, label=label, simulated=words, notices=notices)


def _errors(verifications: _Verifications, unit: str) -> Html:
    rows = []
    for run, by_model in verifications.items():
        for k, (model, each) in enumerate(by_model.items()):
            e, floor = each.settled, each.noise_floor
            over = number(e.rms / floor, 3) if floor else "–"
            name = coloured_name(k, f"{model} on {run}")
            rows.append((name, *_error_cells(e), number(floor), over, _zero_text(each)))
    if len(verifications) > 1:
        rows += _pooled(verifications)
    header = ("Model and run", "n", f"rms ({unit})", "nrmse", f"largest ({unit})", f"noise floor ({unit})")
    return table(
        (*header, "rms / noise", f"zero ({unit})"),
        rows,
        "Errors (measured − model) at settled points. nrmse: rms as a share of the measured range "
        "(–: that range is no more than noise). rms / noise near 1: the error is noise.",
    )


def _error_cells(e: PredictionErrors) -> tuple[str, str, str, str]:
    return str(e.n), number(e.rms), f"{100 * e.nrmse:.2f} %" if e.has_share else "–", number(e.max_abs)


def _zero_text(each: RunVerification) -> str:
    return "known" if each.offset_kind == "known" else f"fitted, {number(each.offset)}"


def _pooled(verifications: _Verifications) -> list[tuple[object, ...]]:
    """The errors of each model over all runs."""
    names = list(next(iter(verifications.values())))
    rows: list[tuple[object, ...]] = []
    for k, name in enumerate(names):
        all_of = [by_model[name].settled for by_model in verifications.values()]
        n = sum(e.n for e in all_of)
        rms = float(np.sqrt(sum(e.n * e.rms**2 for e in all_of) / n)) if n else float("nan")
        largest = max(e.max_abs for e in all_of)
        label = coloured_name(k, f"{name} on all runs")
        rows.append((label, str(n), number(rms), "–", number(largest), "–", "–", "–"))
    return rows


def _warnings(verifications: _Verifications) -> list[Html]:
    warnings = [
        f"{model} on {run}: {words}"
        for run, by_model in verifications.items()
        for model, each in by_model.items()
        for words in each.warnings
    ]
    return [notice("warning", paragraph("Limits of this comparison:"), bullets(warnings))] if warnings else []


def _verdicts(verifications: _Verifications, unit: str) -> Html:
    """What each error is, in words; the colour is that of the best model."""
    pairs = [
        (f"{model} on {run}", each)
        for run, by_model in verifications.items()
        for model, each in by_model.items()
    ]
    found = [
        f"{name}: {number(each.settled.rms)}{spaced(unit)} rms, {each.verdict.text}." for name, each in pairs
    ]
    best = min(pairs, key=lambda pair: np.nan_to_num(pair[1].settled.rms, nan=np.inf))[1]
    words = paragraph(tag("b", found[0])) if len(found) == 1 else bullets(found)
    return notice(box_level(best.verdict.level), words)


def _origins(models: Mapping[str, Model]) -> Html:
    return table(
        ("Model", "Hysteresis", "Effects", "Rig", "Runs", "Fit, rms", "min μ", "Class", "Created"),
        [_origin(k, name, model) for k, (name, model) in enumerate(models.items())],
        joined(
            [
                "Provenance of the models. ",
                M_P,
                ": μ ≥ 0 everywhere, as passivity and the stability theorems require.",
            ]
        ),
    )


def _origin(k: int, name: str, model: Model) -> Sequence[object]:
    report, fit = density_report(model.hysteresis), model.fit.get("rms")
    made = model.created[:16].replace("T", " ")
    protocols = ", ".join(dict.fromkeys(p.protocol.replace("_", " ") for p in model.provenance))
    return (
        coloured_name(k, name),
        hysteresis_description(model.hysteresis),
        ", ".join(str(effect.get("name")) for effect in model.effects) or "none",
        model.rig,
        f"{runs_text(len(model.provenance))}: {protocols}{' (twin)' if model.twin else ''}",
        f"{number(fit)}{spaced(display_unit(model.unit))}" if isinstance(fit, float) else "–",
        f"{number(report.mu_min)} {per_square(model.unit, model.input.unit)}",
        M_P if report.M_P else M_PC if report.M_PC else "neither",
        made,
    )


def residuals_figure(
    name: str, run: Run, models: Mapping[str, Model], verifications: Mapping[str, RunVerification]
) -> Figure:
    """The measured loop with those of the models; measured − model against the input, and in order."""
    one = next(iter(verifications.values()))
    order = np.arange(one.input.size, dtype=float) + 1
    thin = slice(None, None, -(-order.size // _MOST_MARKS))
    data = loop_traces(run, models, verifications) or _point_traces(verifications, thin)
    x_title = "Settled point, in order of measurement"
    first = loop_axes(run)
    unit, floor = display_unit(run.unit), one.noise_floor
    sizes = "; ".join(
        f"{m}: rms {number(e.settled.rms)}{spaced(unit)}, n = {e.settled.n}" for m, e in verifications.items()
    )
    fitted = {m: e.offset for m, e in verifications.items() if e.offset_kind == "fitted"}
    zero = ", ".join(f"{m} {number(offset)}{spaced(unit)}" for m, offset in fitted.items())
    return Figure(
        [
            Panel(data, first, 400, explore=True),
            _residual_panel(verifications, one.input, input_title(run), unit, floor),
            replace(_residual_panel(verifications, order, x_title, unit, floor), wide=True, height=280),
        ],
        f"Run {name} and the predictions of the models.",
        [
            f"Second and third panel: measured − model. {sizes}.",
            f"Band: ± 2 σ of the noise floor, σ = {number(floor)}{spaced(unit)}."
            if floor
            else "The noise floor is unknown.",
            f"The zero of the output is unknown, so one additive offset per model was fitted: {zero}."
            if fitted
            else "",
            f"The first panel shows one point in {thin.step}."
            if thin.step > 1 and _drawn_points(data)
            else "",
            run_caption(run),
        ],
        source_label(run),
        460,
    )


def loop_traces(
    run: Run, models: Mapping[str, Model], verifications: Mapping[str, RunVerification]
) -> list[Trace]:
    """The path of the samples as measured and as each model predicts it; empty for a run of points only."""
    kept = sample_path(run["input"], run["position"], count_size(run))
    if not run.settled or kept.size <= len(run.settled):
        return []
    data: list[Trace] = [line(run["input"][kept], run["position"][kept], "measured", MEASURED, width=2.4)]
    for k, (name, model) in enumerate(models.items()):
        along = with_heating_of(model, run)
        y = simulate_samples(model, along)[kept] + verifications[name].offset
        data.append(line(along["input"][kept], y, name, COMPARED[k], width=1.2, dash=DASHES[k]))
    points = next(iter(verifications.values()))
    data.append(dots(points.input, points.measured, "settled points", INK, size=4))
    return data


def _point_traces(verifications: Mapping[str, RunVerification], thin: slice) -> list[Trace]:
    one = next(iter(verifications.values()))
    data: list[Trace] = [line(one.input[thin], one.measured[thin], "measured", MEASURED, width=1.6)]
    for k, (name, each) in enumerate(verifications.items()):
        data.append(
            dots(each.input[thin], each.predicted[thin], name, COMPARED[k], symbol=SYMBOLS[k], size=6)
        )
    return data


def _drawn_points(data: Sequence[Trace]) -> bool:
    """Whether the traces show points, not paths."""
    return not any(trace["name"] == "settled points" for trace in data)


def _residual_panel(
    verifications: Mapping[str, RunVerification], x: np.ndarray, title: str, unit: str, floor: float | None
) -> Panel:
    data = error_ground(x, floor)
    for k, (model, each) in enumerate(verifications.items()):
        data.append(dots(x, each.error, model, COMPARED[k], symbol=SYMBOLS[k], size=6))
    return Panel(data, {"xaxis": axis(title), "yaxis": axis(f"Measured − model ({unit})")}, 360)


def densities_figure(models: Mapping[str, Model]) -> Figure:
    """μ of each model over the Preisach plane, all on one colour scale."""
    grids = {name: density_of(model.hysteresis) for name, model in models.items()}
    # A quantile instead of the maximum, because a noisy cell of a table would leave all others white.
    sizes = [np.abs(mu[np.isfinite(mu)]) for _, _, mu in grids.values()]
    top = max(float(np.quantile(size, 0.995)) for size in sizes if size.size)
    panels, least = [], []
    for name, model in models.items():
        report, units = density_report(model.hysteresis), (model.unit, model.input.unit)
        panels.append(map_panel(name, grids[name], report, units, top or None))
        share = f", {report.negative_cells} of {report.cells} cells negative" if report.cells else ""
        least.append(f"{name}: min μ = {number(report.mu_min)} {per_square(*units)}{share}")
    twin = any(model.twin for model in models.values())
    return Figure(
        panels,
        "Weighting function μ(α, β) = ½ ∂²y/∂α∂β of each model, on one scale.",
        [
            "White is zero, red positive, blue negative; the colour scale ends at the 99.5 % quantile of |μ|. "
            "Outlined and tinted: μ < 0, even if small; cross: the minimum.",
            "; ".join(least) + ".",
            "; ".join(
                f"{name}: identified from {runs_text(len(m.provenance))} of rig {m.rig}"
                for name, m in models.items()
            )
            + ".",
        ],
        "TWIN" if twin else "",
        420,
    )
