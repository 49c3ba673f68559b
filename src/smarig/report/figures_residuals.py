"""What a model misses, in the rig's unit: residuals against the variable that shows most and against time.

Before and after the effects, side by side. Knows nothing of why the model misses it.
"""

from collections.abc import Sequence
from typing import Any

from smarig.diagnosis.critique import Score
from smarig.diagnosis.diagnose import Diagnosis
from smarig.report.conditions import count_size, exact_unit, label_of
from smarig.report.diagnosed import Array, Replay, models_words, noise_of, place_of, readings, rms
from smarig.report.figure import Figure, Panel, Trace, dots, line
from smarig.report.figures_representation import band
from smarig.report.numbers import number
from smarig.report.residual_variables import against, laid_out, plainest_position, reaches, upright
from smarig.report.style import GREY
from smarig.story.retelling import COUPLED

_DRAUGHTY = 1.02  # noise with draughts over that without: worth a band of its own
_KINDS = {
    "settled": "settled positions",
    "moving": "positions while the wire moves",
    "resistance": "the wire's resistance",
    "current": "measured current − command",
    "room": "the thermometer in the box",
}


def residual_figure(replay: Replay) -> Figure:
    """Residuals in the rig's unit: against the variable that shows most and against time, before and after."""
    d = replay.d
    name = plainest_position(d)
    kind = "moving" if name == "rate" and any(r.kind == "moving" for r in d.story.others) else "settled"
    return _missed_figure(
        replay, kind, list(dict.fromkeys((name, "time"))), f"What the model misses: {_KINDS[kind]}."
    )


def channel_figure(replay: Replay) -> Figure | None:
    """The same for another channel, where that is the one that tells most."""
    best = plainest(replay.d)
    _, of, kind = best.candidate.name.partition(" of ") if best else ("", "", "")
    if best is None or not of:
        return None
    return _missed_figure(replay, kind, [best.candidate.depends_on], f"Where it shows most: {_KINDS[kind]}.")


def plainest(d: Diagnosis) -> Score | None:
    """The variable that explains most beyond chance, if any explains anything."""
    best = d.first.best(1, generic=True)
    return best[0] if best else None


def _missed_figure(replay: Replay, kind: str, names: Sequence[str], title: str) -> Figure:
    d = replay.d
    own, whole = noise_of(d, kind)
    r = readings(d.story, kind)
    unit = exact_unit(r.unit)
    errors = [replay.missed(told, kind) for told, _, _ in replay.told]
    reach = reaches(errors, 2 * whole)
    panels = [
        _missed_panel(
            d,
            kind,
            name,
            error,
            (label, colour),
            (own, whole),
            upright(f"Measured − model ({unit})", own_reach, reach),
        )
        for name in names
        for error, own_reach, (_, label, colour) in zip(errors, reach, replay.told)
    ]
    zero = "" if kind == "current" else ", less its mean (the zero is free)"
    draughts = (
        f" Grey band: ± 2 σ of a reading (σ = {own:.2g} {unit}, rms); "
        f"light band: ± 2 σ with noise of the temperature as the hysteresis remembers it (σ = {whole:.2g} {unit}, rms)."
        if whole > _DRAUGHTY * own
        else f" Grey band: ± 2 σ of a reading (σ = {own:.2g} {unit}, rms)."
    )
    sizes = " → ".join(number(rms(e)) for e in errors)
    return Figure(
        panels,
        title,
        [
            f"Measured minus predicted{zero}, n = {len(r)}, rms {sizes} {unit}{models_words(replay, reach)}.{draughts}",
            "Every density was identified anew from these very readings, so what a density can take up is not in the "
            "picture."
            if kind in COUPLED
            else "",
            _one_count(d) if kind in ("settled", "moving") else "",
            *place_of(d, dotted="time" in names),
        ],
        label_of(*d.story.runs),
        440,
    )


def _one_count(d: Diagnosis) -> str:
    size = count_size(d.story.runs[0])
    return f"1 count: {size:.3g} {exact_unit(d.story.unit)}." if size else ""


def _missed_panel(
    d: Diagnosis,
    kind: str,
    name: str,
    error: Array,
    style: tuple[str, str],
    noise: tuple[float, float],
    y_layout: dict[str, Any],
) -> Panel:
    x, x_axis = against(d, name, kind)
    low, high = float(x.min()), float(x.max())
    bands = [band(low, high, 2 * noise[0], "± 2 σ of a reading")]
    if noise[1] > _DRAUGHTY * noise[0]:
        bands.insert(
            0, band(low, high, 2 * noise[1], "± 2 σ with draughts") | {"fillcolor": "rgba(107,114,128,.10)"}
        )
    data: list[Trace] = [
        *bands,
        line([low, high], [0, 0], "zero", GREY, width=1, showlegend=False),
        dots(x, error, style[0], style[1], size=5),
    ]
    return Panel(data, laid_out(d, name, x_axis, y_layout), 360)
