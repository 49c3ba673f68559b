"""The top of a diagnosis page: the verdict in a box, key figures on cards, and the findings in sentences."""

from collections.abc import Iterator

from smarig.diagnosis import CALIBRATION_BOXES, PREDICTION_LIMIT, Diagnosis, p_text, share_text
from smarig.report.components.html import Html, bullets, cards, notice, paragraph, tag
from smarig.report.components.run_description import display_unit
from smarig.report.diagnosis.verdict_text import findings, verdict_sentence

_Card = tuple[str, str, str]
_WORSE_RATIO = 1.02  # times the base model's error: a larger error is a loss
_BOX_STYLES = {
    "silent": "good",
    "named": "bad",
    "ambiguous": "warning",
    "unknown": "bad",
    "not_identifiable": "warning",
}
# How serious a verdict is in a list of pages: a named cause is a good diagnosis of a bad wire.
SEVERITY_LEVELS = {
    "silent": "good",
    "named": "bad",
    "ambiguous": "bad",
    "unknown": "bad",
    "not_identifiable": "warning",
}


def summary(d: Diagnosis) -> Iterator[Html]:
    """The box, the cards and the sentences."""
    doubt = d.verdict.word == "silent" and d.first.alarm
    yield notice(
        "warning" if doubt or _held_out_worse(d) else _BOX_STYLES[d.verdict.word],
        paragraph(tag("b", verdict_sentence(d))),
    )
    if _held_out_worse(d):
        words = "The extended model predicts the held-out runs worse than the base model. Do not use it yet."
        yield notice("bad", paragraph(words))
    if d.extended and d.error.extended > _WORSE_RATIO * d.error.base:
        words = "The extended model has a larger error than the base model even on its own training points."
        yield notice("bad", paragraph(words))
    yield cards([_detection_card(d), _error_card(d), *_gain_cards(d), _points_card(d)])
    yield bullets(findings(d))


def _held_out_worse(d: Diagnosis) -> bool:
    """Whether the added effects increase the error on held-out data."""
    return d.extended and d.gain is not None and d.gain.extended > _WORSE_RATIO * d.gain.base


def _detection_card(d: Diagnosis) -> _Card:
    note = (
        f"calibrated on {CALIBRATION_BOXES} simulated wires without an effect; an alarm needs p ≤ {d.alpha:g}"
    )
    return "Probability by chance", f"p {p_text(d.first.calibrated_p)}", note


def _error_card(d: Diagnosis) -> _Card:
    e, unit = d.error, display_unit(d.error.unit)
    after = f" → {e.extended:.3g}" if d.extended else ""
    note = f"{'base → extended; ' if d.extended else ''}{d.point_noise_text}; given model {e.original:.3g}"
    return f"Settled points, rms ({unit})", f"{e.base:.3g}{after}", note


def _gain_cards(d: Diagnosis) -> Iterator[_Card]:
    if d.gain is None:
        yield "Gain on held-out data", "unknown", "no held-out run"
    elif not d.extended:
        unit, g = display_unit(d.error.unit), d.gain
        yield (
            f"Held-out error, rms ({unit})",
            f"{g.base:.3g}",
            f"{g.blocks} blocks; {PREDICTION_LIMIT} {g.floor:.2g}; no effect was added",
        )
    else:
        yield _removed_error_card(d)


def _removed_error_card(d: Diagnosis) -> _Card:
    g, unit = d.gain, display_unit(d.error.unit)
    assert g is not None  # noqa: S101 - called only with held-out runs
    ends = g.interval()
    share = "at the floor" if g.removable_share is None else f"R = {share_text(g.removable_share)}"
    between = f"95 %: {share_text(ends[0])} to {share_text(ends[1])}; " if ends else ""
    note = f"{between}{g.blocks} blocks; {g.base:.3g} → {g.extended:.3g} {unit} rms, {PREDICTION_LIMIT} {g.floor:.2g}"
    return "Removable share, held-out runs", share, note


def _points_card(d: Diagnosis) -> _Card:
    others = ", ".join(f"{len(r)} {r.kind}" for r in d.timeline.other_readings) or "no other readings"
    return "Settled points used", str(len(d.timeline.settled)), f"{others}; computed in {d.seconds:.0f} s"
