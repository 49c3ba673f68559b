"""The page `smarig characterise` ends with: one wire, from conditions to validated model."""

from pathlib import Path

import numpy as np

from smarig.identification.verify import verify
from smarig.model.fod_surface import FodSurface
from smarig.report import figures_model as model_figures
from smarig.report import tables
from smarig.report.evidence import Evidence
from smarig.report.figure import Figure
from smarig.report.figures_representation import superposed
from smarig.report.figures_run import hysteresis_graph, swing, time_series
from smarig.report.figures_verification import against_data, resimulated
from smarig.report.html import Html, bullets, cards, notice, paragraph, tag
from smarig.report.page import Section, page
from smarig.report.run_page import notices
from smarig.report.words import duration, number


def characterisation_page(evidence: Evidence) -> str:
    """The whole page as HTML text."""
    sections = [
        Section("The wire in five numbers", "Summary", _summary(evidence)),
        Section("Rig and conditions", "Conditions", _conditions(evidence)),
        Section("Is a Preisach model justified?", "Representation", _representation(evidence)),
        Section("Identification", "Identification", _identification(evidence)),
        Section("Preisach density", "Density", _density(evidence)),
        Section("Against data it has not seen", "Validation", _validation(evidence)),
        Section("Records", "Records", _records(evidence)),
        Section("Provenance", "Provenance", [tables.provenance(evidence)]),
    ]
    first = next(iter(evidence.runs.values()))
    lead = f"Wire {first.meta.get('wire')} on rig {first.meta.get('rig')}, {evidence.best.model.arrangement}."
    above = [n for run in evidence.runs.values() for n in notices(run)]
    return page(evidence.title, lead, sections, twin=evidence.twin, notices=above)


def _summary(evidence: Evidence) -> list[Html | Figure]:
    best, unit = evidence.best, evidence.best.data.unit
    judged = evidence.verifications[evidence.chosen].runs[0] if evidence.chosen in evidence.verifications else None
    floor = judged.noise_floor if judged else best.model.noise_floor.value
    hours = sum(float(run["t_s"][-1] - run["t_s"][0]) for run in evidence.runs.values())
    numbers = [
        ("Travel", f"{number(float(np.ptp(best.data.y)))} {unit}", "between the ends of the major loop"),
        (
            "Model error on unseen data",
            f"{number(judged.settled.rms if judged else None)} {unit}",
            f"rms, n = {judged.settled.n if judged else 0}; noise floor {number(floor)} {unit}",
        ),
        ("Best surface", best.surface, f"of {', '.join(evidence.identifications)}"),
        ("Density", "μ ≥ 0" if best.density.M_P else "μ < 0 somewhere", "M_P" if best.density.M_P else "M_PC, not M_P"),
        ("Rig time", duration(hours), f"{len(best.data)} FOD points on {best.data.curves} curves"),
    ]
    found: list[Html | Figure] = [cards(numbers)]
    if evidence.discoveries:
        found.append(notice("good", paragraph(tag("b", "Discovered.")), bullets(evidence.discoveries)))
    if evidence.warnings:
        found.append(notice("warning", paragraph(tag("b", "Mind.")), bullets(evidence.warnings)))
    return found


def _conditions(evidence: Evidence) -> list[Html | Figure]:
    train = evidence.runs.get("first_order_descending") or next(iter(evidence.runs.values()))
    parts: list[Html | Figure] = [tables.description(train), tables.constants(train.meta.get("actuator", ""))]
    if evidence.calibration is not None:
        parts.append(tables.calibration(evidence.calibration))
    return parts


def _representation(evidence: Evidence) -> list[Html | Figure]:
    if not evidence.representation:
        return [paragraph("The campaign held neither a wiping-out nor a congruency test.")]
    intro = "Wiping-out and congruent minor loops together are necessary and sufficient for a Preisach model (§3.3)."
    return [paragraph(intro), *(superposed(test, evidence.twin) for test in evidence.representation)]


def _identification(evidence: Evidence) -> list[Html | Figure]:
    best = evidence.best
    parts: list[Html | Figure] = [model_figures.fod_curves(best), tables.errors(evidence), tables.parameters(evidence)]
    parts += [model_figures.surface_plot(best), model_figures.parameters_against_alpha(best)]
    train = [run for run in evidence.runs.values() if run.path.name in {Path(p.run).name for p in best.model.provenance}]
    for name, result in evidence.identifications.items():
        if train:
            judged = verify(result.model, train).runs[0]
            parts.append(resimulated(name, judged, result.data.unit, result.model.input.unit, evidence.twin))
    return parts


def _density(evidence: Evidence) -> list[Html | Figure]:
    crossing = evidence.best.curves.cross
    said = (
        "Curves cross inside the major loop: μ is negative somewhere (Prop. 4.6)."
        if crossing
        else "No curves cross. That alone does not prove μ ≥ 0: Prop. 4.6 goes one way only; see min μ."
    )
    analytic = [r for r in evidence.identifications.values() if _analytic(r)]
    if not analytic:
        return [paragraph(said), paragraph("Tables have no density without differentiation; none is drawn.")]
    chosen = evidence.best if _analytic(evidence.best) else analytic[0]
    return [paragraph(said), model_figures.density_plots(chosen)]


def _analytic(result) -> bool:
    return isinstance(model_figures._image(result), FodSurface)


def _validation(evidence: Evidence) -> list[Html | Figure]:
    if not evidence.verifications:
        return [paragraph("The campaign held no run for validation: nothing can be said of the model's error.")]
    verified = evidence.verifications[evidence.chosen]
    unit_in = evidence.best.model.input.unit
    return [against_data(evidence.chosen, judged, verified.unit, unit_in, evidence.twin) for judged in verified.runs]


def _records(evidence: Evidence) -> list[Html | Figure]:
    parts: list[Html | Figure] = []
    for name, run in evidence.runs.items():
        parts.append(tag("h3", name.replace("_", " ")))
        parts.append(swing(run) if name == "initialise" and np.nanmin(run["input"]) < 0 else time_series(run))
        if run.settled and name != "initialise":
            parts.append(hysteresis_graph(run))
    return parts
