"""The top of a diagnosis page: the verdict in a box, key figures on cards, and the findings in sentences."""

from collections.abc import Iterator

from smarig.diagnosis import POINT_NOISE, PREDICTION_LIMIT, CommandedDiagnosis, share_text
from smarig.report.components.html import Html, bullets, cards, notice, paragraph, tag
from smarig.report.components.run_description import display_unit
from smarig.report.diagnosis.verdict_levels import SEVERITY_LEVELS
from smarig.report.diagnosis.verdict_text import findings, verdict_sentence

_Card = tuple[str, str, str]


def summary(d: CommandedDiagnosis) -> Iterator[Html]:
    """The box, the cards and the sentences."""
    yield notice(SEVERITY_LEVELS[d.verdict.word], paragraph(tag("b", verdict_sentence(d))))
    yield cards([_error_card(d), _gain_card(d), _points_card(d)])
    yield bullets(findings(d)[max(len(d.findings), 1) :])


def _error_card(d: CommandedDiagnosis) -> _Card:
    e, unit = d.error, display_unit(d.error.unit)
    after = f" → {e.extended:.3g}" if d.extended else ""
    note = (
        f"{'base → extended; ' if d.extended else ''}{POINT_NOISE} {e.noise_floor:.2g}; "
        f"given model {e.original:.3g}"
    )
    return f"Settled points, rms ({unit})", f"{e.base:.3g}{after}", note


def _gain_card(d: CommandedDiagnosis) -> _Card:
    g, unit = d.gain, display_unit(d.error.unit)
    if g is None:
        return "Gain on held-out data", "unknown", "no held-out run"
    if not d.extended:
        note = f"{g.blocks} blocks; {PREDICTION_LIMIT} {g.floor:.2g}; no effect was added"
        return f"Held-out error, rms ({unit})", f"{g.base:.3g}", note
    ends = g.interval()
    share = "at the floor" if g.removable_share is None else f"R = {share_text(g.removable_share)}"
    between = f"95 %: {share_text(ends[0])} to {share_text(ends[1])}; " if ends else ""
    note = f"{between}{g.blocks} blocks; {g.base:.3g} → {g.extended:.3g} {unit} rms, {PREDICTION_LIMIT} {g.floor:.2g}"
    return "Removable share, held-out runs", share, note


def _points_card(d: CommandedDiagnosis) -> _Card:
    others = ", ".join(f"{len(r)} {r.kind}" for r in d.timeline.other_readings) or "no other readings"
    return "Settled points used", str(len(d.timeline.settled)), f"{others}; computed in {d.seconds:.0f} s"
