"""The key figures of a characterisation on cards, and the recommendation of a model."""

import shlex

import numpy as np

from smarig.identification import POSITIVE_KIND, SIMPLER_TOLERANCE
from smarig.report.components.html import Html, cards, joined, notice, paragraph, tag
from smarig.report.components.numbers import duration, number, runs_text
from smarig.report.components.run_description import count_size, duration_s, protocol_name, quality_counts
from smarig.report.models.evidence import Evidence, settled_range, stroke_run, stroke_text
from smarig.report.models.identification_plot_data import density_report_of
from smarig.report.models.model_tables import M_P, M_PC, pooled_rms
from smarig.report.models.plane_figures import density_unit

_Card = tuple[str, str | Html, str | Html]


def characterisation_cards(e: Evidence, *, theory: bool = True) -> Html:
    """Cards of stroke, held-out error with noise floor, class of μ (``theory``), duration and points."""
    of_theory = [_class_card(e)] if theory else []
    return cards([_stroke_card(e), _error_card(e), *of_theory, _duration_card(e), _points_card(e)])


def _stroke_card(e: Evidence) -> _Card:
    run = stroke_run(e)
    if run is None:
        return "Stroke", "unknown", "no settled points"
    stroke, size = settled_range(run), count_size(run)
    counts = f"{stroke / size:.0f} counts, " if size else ""
    return "Stroke", f"{stroke_text(stroke)} {run.unit}", f"{counts}settled points of {protocol_name(run)}"


def _error_card(e: Evidence) -> _Card:
    verification = e.verifications.get(e.chosen)
    rms = pooled_rms(verification)
    if verification is None or rms is None:
        return "Model error on held-out data, rms", "unknown", "no held-out run"
    noise = verification.noise_floor
    floor = f"noise floor of the run {noise:.2g} {verification.unit}" if noise else "noise floor unknown"
    run = stroke_run(e)
    share = f"{100 * rms / settled_range(run):.2f} % of the stroke, " if run is not None else ""
    return (
        "Model error on held-out data, rms",
        f"{rms:.3g} {verification.unit}",
        f"{floor}; {share}n = {verification.points}",
    )


def _class_card(e: Evidence) -> _Card:
    if e.best is None:
        return "Class of μ", "unknown", "no model"
    d = density_report_of(e.best)
    run = next(iter(e.runs.values()))
    name = "μ ≥ 0" if d.M_P else "μ < 0 somewhere"
    of_class = ["in ", M_P] if d.M_P else ["not in ", M_P, *([", in ", M_PC] if d.M_PC else [])]
    least = f"; {e.chosen} model, min μ = {number(d.mu_min)} {density_unit(run)}"
    return "Class of μ", name, joined([*of_class, least])


def _duration_card(e: Evidence) -> _Card:
    total = float(np.nansum([duration_s(run) for run in e.runs.values()]))
    return "Rig time", duration(total), f"{runs_text(len(e.runs))}; computed in {e.seconds:.1f} s"


def _points_card(e: Evidence) -> _Card:
    late = sum(quality_counts(run).timed_out for run in e.runs.values())
    n = sum(len(run.settled) for run in e.runs.values())
    return (
        "Settled points",
        str(n - late),
        f"{_used_text(e)}{late or 'no'} hold{'' if late == 1 else 's'} timed out",
    )


def _used_text(e: Evidence) -> str:
    if e.best is None:
        return ""
    data = e.best.data
    if e.best.positive is not None:
        return f"{e.best.model.fit['points']} with known memory used; "
    return f"{len(data)} FOD points on {data.curves} curves; "


# --- the model the stability results apply to -----------------------------------------------------------


def model_recommendation(e: Evidence) -> Html:
    """A box on which model is in M_P and how well it predicts compared with the chosen one; empty without a model."""
    if e.best is None:
        return Html("")
    if density_report_of(e.best).M_P:
        apply = ". The stability results of chapter 8 apply to it."
        return notice("good", paragraph(f"The {e.chosen} model is in ", M_P, apply))
    words = [f"The {e.chosen} model is not in ", M_P]
    if POSITIVE_KIND not in e.identifications:
        return notice(
            "warning", paragraph(*words, ". The stability results of chapter 8 do not apply to it.")
        )
    words += [
        ". The positive model is in ",
        M_P,
        " by construction, so the stability results of chapter 8 apply to that model. ",
    ]
    names = " ".join(shlex.quote(p.run) for p in e.best.model.provenance)
    command = tag("code", f"smarig identify {names} --surface positive -o positive.model.json")
    return notice(
        "good",
        paragraph(*words, *_prediction_verdict(e, e.best.model.unit)),
        paragraph("To identify the positive model: ", command),
    )


def _prediction_verdict(e: Evidence, unit: str) -> list[str | Html]:
    """Sentences comparing the errors of the positive and the chosen model; empty without held-out data."""
    compared = _compared_errors(e)
    if not compared:
        return []
    worse = [positive > SIMPLER_TOLERANCE * chosen for _, positive, chosen in compared]
    errors = "; ".join(
        f"{where} {positive:.3g} against {chosen:.3g} {unit} rms" for where, positive, chosen in compared
    )
    if all(worse):
        verdict = "The positive model predicts less well"
    elif any(worse):
        verdict = f"The positive model predicts less well {compared[worse.index(True)][0]} only"
    else:
        verdict = "The positive model predicts as well"
    return [tag("b", verdict), f": {errors}. {_other_models_text(e, unit) if any(worse) else ''}"]


def _compared_errors(e: Evidence) -> list[tuple[str, float, float]]:
    """(data, rms of the positive model, rms of the chosen one)."""
    found = []
    rms = e.choice.held_out_rms if e.choice else {}
    if POSITIVE_KIND in rms and e.chosen in rms:
        found.append(("on held-out curves", rms[POSITIVE_KIND], rms[e.chosen]))
    verification = [pooled_rms(e.verifications.get(name)) for name in (POSITIVE_KIND, e.chosen)]
    if verification[0] is not None and verification[1] is not None:
        found.append(("on the held-out run", verification[0], verification[1]))
    return found


def _other_models_text(e: Evidence, unit: str) -> str:
    """The held-out error of the best other model in M_P, if there is one."""
    others = {
        name: pooled_rms(e.verifications.get(name))
        for name, one in e.identifications.items()
        if name != POSITIVE_KIND and density_report_of(one).M_P
    }
    known = {name: rms for name, rms in others.items() if rms is not None}
    if not known:
        return ""
    name = min(known, key=lambda k: known[k])
    return f"The best other model with μ ≥ 0, {name}, has an error of {known[name]:.3g} {unit} on the held-out run."
