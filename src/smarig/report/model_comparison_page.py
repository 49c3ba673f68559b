"""The page of several models beside each other: errors on the same runs, residuals, densities, origins."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from smarig.identification.density_report import density_report
from smarig.identification.verify import PredictionErrors, RunVerification, verify
from smarig.record import Run
from smarig.replay import Model
from smarig.report.comparison_labels import banner, check_comparable_count
from smarig.report.density_figures import per_square
from smarig.report.html import Html, bullets, joined, notice, paragraph, table
from smarig.report.identification_plot_data import hysteresis_description
from smarig.report.model_comparison_figures import densities_figure, residuals_figure
from smarig.report.model_tables import M_P, M_PC
from smarig.report.numbers import number
from smarig.report.page import Section, page
from smarig.report.run_comparison_figures import coloured_name
from smarig.report.run_description import display_unit, source_label
from smarig.report.run_page import ending_notices
from smarig.report.run_tables import provenance_table, quality_table

_Verifications = Mapping[str, Mapping[str, RunVerification]]  # run → model → verification


def models_page(models: Mapping[str, Model], runs: Mapping[str, Run]) -> str:
    """One page (HTML) of models by name, judged on runs by name in the order of their sitting.

    Errors as of ``verify``; UsageError when there are more models than can be told apart.
    """
    check_comparable_count(list(models), "models")
    found = {name: verify(model, list(runs.values())).runs for name, model in models.items()}
    verifications = {run: {name: found[name][k] for name in models} for k, run in enumerate(runs)}
    figures = [residuals_figure(name, run, verifications[name]) for name, run in runs.items()]
    sections = [
        Section(
            "Errors",
            "Errors",
            [
                _errors(verifications, display_unit(next(iter(models.values())).unit)),
                *_warnings(verifications),
            ],
        ),
        Section("What each predicts, and misses", "Residuals", figures),
        Section("Weighting functions", "Density μ", [densities_figure(models)]),
        Section("The models", "Models", [_origins(models)]),
        Section("The runs", "Runs", [quality_table(runs), provenance_table(runs)]),
    ]
    label, words = banner([source_label(run) for run in runs.values()])
    title = f"Models on the same runs: {', '.join(models)}"
    notices = ending_notices(list(runs.values()))
    return page(title, _lead(runs), sections, label=label, simulated=words, notices=notices)


def _lead(runs: Mapping[str, Run]) -> str:
    return f"Verified on {', '.join(Path(name).name for name in runs)}"


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
        "Model minus measured at settled points; nrmse is the share of the measured travel. "
        "rms / noise near one means that nothing is left to explain.",
    )


def _error_cells(e: PredictionErrors) -> tuple[str, str, str, str]:
    return str(e.n), number(e.rms), f"{100 * e.nrmse:.2f} %", number(e.max_abs)


def _zero_text(each: RunVerification) -> str:
    return "known" if each.offset_kind == "known" else f"fitted, {number(each.offset)}"


def _pooled(verifications: _Verifications) -> list[tuple[object, ...]]:
    """Each model over all runs together."""
    names = list(next(iter(verifications.values())))
    rows = []
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
    return [notice("warning", paragraph("Is this a fair judgement?"), bullets(warnings))] if warnings else []


def _origins(models: Mapping[str, Model]) -> Html:
    return table(
        ("Model", "Hysteresis", "Effects", "Rig", "From", "Fit, rms", "min μ", "Class", "Made"),
        [_origin(k, name, model) for k, (name, model) in enumerate(models.items())],
        joined(
            [
                "Where each model comes from. ",
                M_P,
                ": μ ≥ 0 everywhere; passivity and the stability theorems need it.",
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
        f"{len(model.provenance)} run(s): {protocols}{' (twin)' if model.twin else ''}",
        f"{number(fit)} {display_unit(model.unit)}" if isinstance(fit, float) else "–",
        f"{number(report.mu_min)} {per_square(model.unit, model.input.unit)}",
        M_P if report.M_P else M_PC if report.M_PC else "neither",
        made,
    )
