"""A diagnosis in pictures: what the model misses and what is left, rivals, detection, look-alikes, held-out gain.

Replays the two models along the story that was diagnosed; decides nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.cluster.hierarchy import leaves_list, linkage
from scipy.spatial.distance import squareform

from smarig.diagnosis.critique import LEAST_SPREAD, Score
from smarig.diagnosis.diagnose import Diagnosis
from smarig.diagnosis.gain import Gain
from smarig.diagnosis.noise import propagated, remembered
from smarig.diagnosis.verdict import TEMPERATURE
from smarig.diagnosis.visibility import SAME, Visibility
from smarig.identification.lived import subject_of
from smarig.preisach.sensitivity import sensitivity
from smarig.report.conditions import count_size, exact_unit, label_of, protocol_of
from smarig.report.figure import Figure, Panel, Trace, axis, dots, line, packed
from smarig.report.figures_representation import band
from smarig.report.numbers import number, thousands
from smarig.report.style import FAINT, FIRST, GREY, INK, MODEL, SECOND, SEQUENCE
from smarig.story.retelling import COUPLED, Retelling, retold
from smarig.story.told import Readings, Story

Array = NDArray[np.float64]
STEEP = 0.25  # of a steep place's slope: where a residual is worth telling as a temperature
NAMED, GENERIC = FIRST, SECOND
_WIDER = 1.15  # axes, beyond what is drawn
DRAUGHTY = 1.02  # noise with draughts over that without: worth a band of its own
_BESIDE = 0.13  # blocks: distance of the two models' marks


# --- what was missed ---------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Replay:
    """The story as the base model tells it, and as the extended one does (None without one)."""

    d: Diagnosis
    base: Retelling
    extended: Retelling | None

    @classmethod
    def of(cls, d: Diagnosis) -> "Replay":
        """Lived through once more where there is an extended model."""
        after = retold(d.story, subject_of(d.model, d.story.runs[0])) if d.extended else None
        return cls(d, d.first.told, after)

    @property
    def told(self) -> tuple[tuple[Retelling, str, str], ...]:
        """(retelling, name of its residuals, colour)."""
        first = (self.base, "measured − base model", INK)
        return (first, (self.extended, "measured − extended model", MODEL)) if self.extended else (first,)

    def missed(self, told: Retelling, kind: str) -> Array:
        """Measured minus predicted (n,) of one kind of reading; its free zero removed (currents have none)."""
        story = self.d.story
        error = readings(story, kind).value - told.values[kind]
        if kind == "current":
            return error
        zero = story.zero if story.given else np.zeros(error.size)
        return error - np.array([error[zero == z].mean() for z in zero])


def readings(story: Story, kind: str) -> Readings:
    """The readings of one kind."""
    return next(r for r in story.kinds if r.kind == kind)


def noise_of(d: Diagnosis, kind: str) -> tuple[float, float]:
    """Rms noise of one kind of reading: its own, and with the draughts that the hysteresis remembers."""
    critic = d.levels[-1].critique if d.levels else d.first
    fitted, before = critic.refitted, 0
    for r in d.story.kinds[: [r.kind for r in d.story.kinds].index(kind)]:
        before += len(r)
    here = slice(before, before + len(readings(d.story, kind)))
    if kind not in COUPLED:
        own = _rms(fitted.scale[here])
        return own, own
    J, times = remembered(critic.subject.hysteresis, critic.told)  # pyright: ignore[reportArgumentType]
    share = np.diag(propagated(J, times, fitted.noise.correlation_s))[here] * critic.told.follows[here] ** 2
    own = _rms(fitted.noise.white[here])
    return own, float(np.hypot(own, fitted.noise.temperature_K * np.sqrt(share.mean())))


def slopes(d: Diagnosis) -> Array:
    """∂y/∂u to the input (k,) of the base model at the settled points."""
    states = d.first.told.states[: len(d.story.settled)]
    return np.array([sensitivity(d.first.subject.hysteresis, state)[-1] for state in states])  # pyright: ignore[reportArgumentType]


def plainest(d: Diagnosis) -> Score | None:
    """The variable that explains most beyond chance, if any explains anything."""
    best = d.first.best(1, generic=True)
    return best[0] if best else None


def plainest_position(d: Diagnosis) -> str:
    """The name of the variable that explains most of the positions ("time" if none does)."""
    scores = [
        s for s in d.first.scores if s.candidate.generic and " of " not in s.candidate.name and s.net > 0
    ]
    return max(scores, key=lambda s: s.net).candidate.depends_on if scores else "time"


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


_KINDS = {
    "settled": "settled positions",
    "moving": "positions while the wire moves",
    "resistance": "the wire's resistance",
    "current": "measured current − command",
    "room": "the thermometer in the box",
}


def _missed_figure(replay: Replay, kind: str, names: Sequence[str], title: str) -> Figure:
    d = replay.d
    own, whole = noise_of(d, kind)
    r = readings(d.story, kind)
    unit = exact_unit(r.unit)
    errors = [replay.missed(told, kind) for told, _, _ in replay.told]
    reach = _WIDER * max(2 * whole, *(float(np.abs(e).max()) for e in errors))
    panels = [
        _missed_panel(
            d, kind, name, error, (label, colour), (own, whole), (f"Measured − model ({unit})", reach)
        )
        for name in names
        for error, (_, label, colour) in zip(errors, replay.told)
    ]
    zero = "" if kind == "current" else ", less its mean (the zero is free)"
    draughts = (
        f" Grey band: ± 2 σ of a reading ({own:.2g} {unit}); "
        f"light band: ± 2 σ with draughts as the hysteresis remembers them ({whole:.2g} {unit}, rms)."
        if whole > DRAUGHTY * own
        else f" Grey band: ± 2 σ of a reading ({own:.2g} {unit})."
    )
    rms = " → ".join(number(_rms(e)) for e in errors)
    return Figure(
        panels,
        title,
        [
            f"Measured minus predicted{zero}, n = {len(r)}, rms {rms} {unit}{_models(replay)}.{draughts}",
            "Every density was identified anew from these very readings, so what a density can take up is not in the "
            "picture."
            if kind in COUPLED
            else "",
            _one_count(d) if kind in ("settled", "moving") else "",
            *place_of(d),
        ],
        label_of(*d.story.runs),
        440,
    )


def _one_count(d: Diagnosis) -> str:
    size = count_size(d.story.runs[0])
    return f"1 count: {size:.3g} {exact_unit(d.story.unit)}." if size else ""


def _models(replay: Replay) -> str:
    return " (black: base model; green, same axes: extended model)" if replay.extended else ""


def _missed_panel(
    d: Diagnosis,
    kind: str,
    name: str,
    error: Array,
    style: tuple[str, str],
    noise: tuple[float, float],
    upright: tuple[str, float],
) -> Panel:
    x, x_axis = against(d, name, kind)
    low, high = float(x.min()), float(x.max())
    bands = [band(low, high, 2 * noise[0], "± 2 σ of a reading")]
    if noise[1] > DRAUGHTY * noise[0]:
        bands.insert(
            0, band(low, high, 2 * noise[1], "± 2 σ with draughts") | {"fillcolor": "rgba(107,114,128,.10)"}
        )
    data: list[Trace] = [
        *bands,
        line([low, high], [0, 0], "zero", GREY, width=1, showlegend=False),
        dots(x, error, style[0], style[1], size=5),
    ]
    layout: dict[str, Any] = {"xaxis": x_axis, "yaxis": axis(upright[0], range=[-upright[1], upright[1]])}
    if name == "time":
        layout["shapes"] = _beginnings(d.story)
    return Panel(data, layout, 360)


def _beginnings(story: Story) -> list[dict[str, Any]]:
    """A dotted upright line where a run begins."""
    at = clock(
        story, np.array([story.settled.t_s[np.argmax(story.run == k)] for k in range(1, len(story.runs))])
    )[0]
    style = {"type": "line", "yref": "paper", "y0": 0, "y1": 1, "layer": "below"}
    return [
        style | {"x0": t, "x1": t, "line": {"color": GREY, "width": 1, "dash": "dot"}} for t in at.tolist()
    ]


def clock(story: Story, t_s: Array) -> tuple[Array, str]:
    """Times in hours or minutes with the unit, or samples where there is no clock."""
    if story.given == "samples":
        return t_s, "samples"
    return (t_s / 3600, "h") if story.drive.end_s[-1] > 7200 else (t_s / 60, "min")


def against(d: Diagnosis, name: str, kind: str) -> tuple[Array, dict[str, Any]]:
    """A variable's values (n,) at the readings of one kind, and its axis."""
    story, r, u = d.story, readings(d.story, kind), exact_unit(d.story.runs[0].input_unit)
    unit, target, base = exact_unit(story.unit), story.target_K, d.first.told
    before = np.concatenate([target[:1], target[:-1]])
    if name == "cycle":
        travel = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(base.values["settled"])))])
        return travel[r.step], axis(f"Travel so far, there and back ({unit})")
    if name == "level" and kind in ("settled", "moving"):
        return base.values[kind], axis(f"Predicted position ({unit})")
    if name == "level":
        return target[r.step], axis(f"Target of the step ({u})")
    if name == "step":
        return (target - before)[r.step], axis(f"Change of target that led here ({u})")
    if name == "hold":
        return np.maximum(story.hold_s, 1.0)[r.step], axis("Length of the hold (s)", type="log")
    if name == "rate" and story.given:
        return story.speed, axis(f"Rate of the input on its branch ({u}/s)", type="log")
    if name == "rate":
        since = (r.t_s - _begun(story)[r.step]) * np.sign(target - before)[r.step]
        return since, axis("Time since the step began, < 0: cooling steps (s)")
    if name == "history" and story.given:
        return story.reversal, axis(f"Input at the last reversal ({u})")
    if name == "history":
        return before[r.step], axis(f"Target of the step before ({u})")
    if name == "reversals":
        turned = np.abs(np.diff(np.sign(np.diff(target)), prepend=1)) > 0
        return np.concatenate([[0.0], np.cumsum(turned)])[r.step], axis("Reversals so far")
    t, t_unit = clock(story, r.t_s)
    return t, axis(f"Clock time of the sitting ({t_unit})")


def _begun(story: Story) -> Array:
    """When each settled step began, on the story's clock (k,)."""
    first = story.runs[0]
    zero = float(first["t_s"][0]) - float(first.meta.get("period_s") or 0.1)
    return np.array([step.t_start_s for run in story.runs for step in run.settled]) - zero


def temperature_figure(replay: Replay) -> Figure | None:
    """Residuals as the offset of the input that would make them, where the wire is steep enough to tell."""
    d = replay.d
    slope = slopes(d)
    steep = slope > STEEP * float(np.quantile(slope, 0.9))
    if not steep.any() or slope.max() <= 0:
        return None
    u, unit = exact_unit(d.story.runs[0].input_unit), exact_unit(d.story.unit)
    offsets = [replay.missed(told, "settled")[steep] / slope[steep] for told, _, _ in replay.told]
    doubt = 2 * noise_of(d, "settled")[0] / slope[steep]
    reach = _WIDER * max(float(np.max(np.abs(offset) + doubt)) for offset in offsets)
    names = dict.fromkeys((plainest_position(d), "time"))
    panels = [
        _offset_panel(d, name, steep, (offset, doubt), (label, colour), (f"Equivalent offset ({u})", reach))
        for name in names
        if name != "rate"
        for offset, (_, label, colour) in zip(offsets, replay.told)
    ]
    rms = " → ".join(number(_rms(offset)) for offset in offsets)
    return Figure(
        panels,
        f"The same as an offset of the input: how many {u} more would make each residual.",
        [
            f"Residual of a settled position over the base model's slope ∂y/∂u to its input, where that is more than "
            f"{100 * STEEP:.0f} % of its 90 % quantile: {int(steep.sum())} of {steep.size} points, slopes "
            f"{slope[steep].min():.2g} to {slope[steep].max():.2g} {unit}/{u}; rms {rms} {u}{_models(replay)}.",
            f"Bars: ± 2 σ of a reading over that slope. Draughts of {_draught(d)} {u} are not in the bars. "
            "A disturbance of the input would lie on one curve here, but for what the density has taken up.",
            *place_of(d),
        ],
        label_of(*d.story.runs),
        440,
    )


def _draught(d: Diagnosis) -> str:
    critic = d.levels[-1].critique if d.levels else d.first
    return number(critic.refitted.noise.temperature_K, 2)


def _offset_panel(
    d: Diagnosis,
    name: str,
    steep: NDArray[np.bool_],
    offset: tuple[Array, Array],
    style: tuple[str, str],
    upright: tuple[str, float],
) -> Panel:
    x, x_axis = against(d, name, "settled")
    ends = [float(x.min()), float(x.max())]
    bars = {"type": "data", "array": packed(offset[1]), "color": FAINT, "thickness": 1, "width": 0}
    data: list[Trace] = [
        line(ends, [0, 0], "zero", GREY, width=1, showlegend=False),
        dots(x[steep], offset[0], style[0], style[1], size=5, error_y=bars),
    ]
    layout: dict[str, Any] = {"xaxis": x_axis, "yaxis": axis(upright[0], range=[-upright[1], upright[1]])}
    if name == "time":
        layout["shapes"] = _beginnings(d.story)
    return Panel(data, layout, 340)


def place_of(d: Diagnosis) -> tuple[str, ...]:
    """The caption's last sentence: which runs, on what rig."""
    run, protocols = d.story.runs[0], ", ".join(dict.fromkeys(map(protocol_of, d.story.runs)))
    rig, wire, seed = (run.meta.get(key) for key in ("rig", "wire", "seed"))
    parts = [
        f"{len(d.story.runs)} training run{'s' if len(d.story.runs) > 1 else ''} ({protocols}"
        + ("; a dotted line where the next begins)" if len(d.story.runs) > 1 else ")"),
        f"rig {rig}" if rig else "",
        f"wire {wire}" if wire else "",
        f"seed {seed}" if label_of(run) and seed is not None else "",
    ]
    return ("; ".join(part for part in parts if part) + ".",)


# --- rivals and detection ----------------------------------------------------------------------------------


def rivals_figure(d: Diagnosis) -> Figure:
    """Explanations of the last level by nats behind the best; single candidates by gain beyond chance."""
    panels, behind = [_bars(singles(d))], ""
    if d.levels:
        level = d.levels[-1]
        lead = [level.lead(k) for k in range(len(level.explanations))]
        panels.insert(0, _behind([" + ".join(r.names) for r in level.explanations], lead))
        behind = (
            "First panel: the explanations that competed last, all parameters fitted, by how many nats they fit worse "
            f"than the best; {TEMPERATURE:g} nats cost a factor e in probability. Second panel, by another measure "
            "(the noise as believed before any effect was in):"
        )
    each = "each candidate by itself" if behind else "Each candidate by itself"
    return Figure(
        panels,
        "Rivals.",
        [
            behind,
            f"{each} on the first critique, weak and in proportion: gain in log likelihood beyond the median of its "
            "gain on nulls. Blue: an effect of the catalogue; vermilion: a smooth function of a variable, which names "
            "no cause. Axes: linear near 0, logarithmic beyond.",
            *place_of(d),
        ],
        label_of(*d.story.runs),
        460,
    )


def singles(d: Diagnosis, named: int = 6, plain: int = 4) -> list[Score]:
    """The single candidates that gain most beyond chance, named and generic, most first; three at least."""
    by_net = sorted(d.first.scores, key=lambda s: -s.net)
    known = [s for s in by_net if not s.candidate.generic][:named]
    found = [*known, *[s for s in by_net if s.candidate.generic][:plain]]
    found.sort(key=lambda s: -s.net)
    return found[: max(3, sum(s.net > 0.5 for s in found))]


def _behind(names: Sequence[str], lead: Sequence[float]) -> Panel:
    rows = _places(len(names))
    texts = ["best" if v <= 0 else nats(v) for v in lead]
    data = [_bar(lead, rows, NAMED, texts)]
    return Panel(
        data, _rows(names, rows, "Nats behind the best explanation", [0.0, *lead]), _high(len(names))
    )


def _bars(scores: Sequence[Score]) -> Panel:
    rows = _places(len(scores))
    net = [s.net for s in scores]
    colour = [GENERIC if s.candidate.generic else NAMED for s in scores]
    data = [_bar(net, rows, colour, [nats(v) for v in net])]
    names = [called(s) for s in scores]
    return Panel(data, _rows(names, rows, "Gain beyond chance (nats)", [0.0, *net]), _high(len(names)))


def _places(count: int) -> Array:
    """Rows from the top down."""
    return np.arange(float(count))[::-1]


def called(score: Score) -> str:
    """A candidate's name for readers: "depends on time of room" for a generic one."""
    name = score.candidate.name.lstrip("?")
    return f"depends on {name}" if score.candidate.generic else name


def nats(value: float) -> str:
    """A gain as it is worth telling: to a tenth, whole ones from 100.

    >>> nats(2653.9), nats(6.28), nats(-0.002), nats(-2.5)
    ('2\u202f654', '6.3', '0', '−2.5')
    """
    if abs(value) < 0.05:
        return "0"
    return (f"{value:.1f}" if abs(value) < 100 else thousands(round(value))).replace("-", "−")


def _bar(values: Sequence[float], rows: Array, colour: Any, texts: Sequence[str]) -> Trace:
    return {
        "type": "bar",
        "orientation": "h",
        "x": packed(np.arcsinh(values)),
        "y": packed(rows),
        "text": list(texts),
        "textposition": "outside",
        "cliponaxis": False,
        "marker": {"color": colour},
        "width": 0.6,
        "hoverinfo": "text",
        "showlegend": False,
    }


def _high(rows: int) -> int:
    return 110 + 30 * rows


def _rows(names: Sequence[str], rows: Array, title: str, values: Sequence[float]) -> dict[str, Any]:
    """Layout with a name on each row and an axis that is linear near 0 and logarithmic beyond."""
    upright = axis("", tickvals=rows.tolist(), ticktext=list(names), range=[-0.7, len(names) - 0.3], ticks="")
    return {"xaxis": stretched(title, min(values), max(values)), "yaxis": upright, "showlegend": False}


def stretched(title: str, low: float, high: float) -> dict[str, Any]:
    """An axis for arcsinh of a quantity, with the quantity's own numbers on it."""
    sizes = np.array([1.0, 3.0]) * 10.0 ** np.arange(0, 9)[:, None]
    every = np.concatenate([-sizes.ravel()[::-1], [0.0], sizes.ravel()])
    ends = np.arcsinh([min(low, 0.0), max(high, 1.0)])
    room = 0.3 * float(np.ptp(ends))
    ends = [float(ends[0]) - (room if low < 0 else 0.0), float(ends[1]) + room]
    shown = [v for v in every.tolist() if ends[0] <= np.arcsinh(v) <= ends[1]]
    shown = [v for v in shown if v == 0 or len(shown) < 9 or abs(v) in sizes[:, 0]]
    texts = [_tick(v) for v in shown]
    return axis(title, tickvals=np.arcsinh(shown).tolist(), ticktext=texts, tickangle=0, range=ends)


def _tick(value: float) -> str:
    """A round number; powers of ten from 10 000."""
    power = int(np.log10(max(abs(value), 1.0)) + 1e-9)
    plain = f"{value:g}" if power < 4 else f"{value / 10**power:g}·10<sup>{power}</sup>"
    return plain.replace("-", "−").replace("1·10<", "10<")


def detection_figure(d: Diagnosis) -> Figure:
    """Every candidate's gain in spreads of its own null against the threshold of their largest."""
    seen = sorted((s for s in d.first.scores if s.candidate.traces.shape[1]), key=lambda s: s.standard)
    top, rows = d.first.threshold, np.arange(float(len(seen)))
    data: list[Trace] = [
        _upright_band(0, 1, len(seen)),
        line(
            np.arcsinh([top, top]), [-0.7, len(seen) - 0.3], f"threshold, α = {d.alpha:g}", INK, dash="dash"
        ),
        _scores(seen, rows, generic=False),
        _scores(seen, rows, generic=True),
    ]
    title = "Gain, in spreads of the candidate's own null"
    layout = _rows([called(s) for s in seen], rows, title, [-1.0, top, *(s.standard for s in seen)])
    layout |= {"showlegend": True, "legend": {"orientation": "h", "x": 0, "y": 1.01, "yanchor": "bottom"}}
    above = sum(s.standard > top for s in seen)
    return Figure(
        [Panel(data, layout, 130 + 17 * len(seen), wide=True)],
        "Detection: is anything wrong at all?",
        [
            f"Each of {len(seen)} candidates by its gain over the base model, (g − median)/(95 % point − median) of "
            f"its own gains on {d.nulls} nulls: the base model's story lived again with noise and nothing hidden. "
            f"Band: from a null's median (0) to its 95 % point (1; at least {LEAST_SPREAD:g} nats).",
            f"Dashed: {top:.3g}, which the largest of all candidates exceeds in {100 * d.alpha:g} % of nulls, so many "
            f"candidates do not make a false alarm likelier. Above it: {above}. p = {d.first.p_value:.2g}, "
            f"where {1 / (d.nulls + 1):.2g} is the least that {d.nulls} nulls can tell.",
            "Axis: linear near 0, logarithmic beyond.",
            *place_of(d),
        ],
        label_of(*d.story.runs),
    )


def _scores(seen: Sequence[Score], rows: Array, *, generic: bool) -> Trace:
    """The named or the generic candidates as dots, with their numbers to hover over."""
    mine = [(s, row) for s, row in zip(seen, rows.tolist()) if s.candidate.generic is generic]
    words = [f"{called(s)}: {s.standard:.3g} spreads, {nats(s.net)} nats" for s, _ in mine]
    name, colour = ("depends on a variable", GENERIC) if generic else ("effect of the catalogue", NAMED)
    x, y = [np.arcsinh(s.standard) for s, _ in mine], [row for _, row in mine]
    return dots(x, y, name, colour, size=8, text=words, hoverinfo="text")


def _upright_band(low: float, high: float, rows: int) -> Trace:
    x = np.arcsinh([low, high, high, low, low])
    y = np.array([-0.7, -0.7, rows - 0.3, rows - 0.3, -0.7])
    fill = {"fill": "toself", "fillcolor": "rgba(107,114,128,.18)", "hoverinfo": "skip"}
    return line(x, y, "null: median to 95 %", GREY, width=0, **fill)


# --- look-alikes and gain -----------------------------------------------------------------------------------


def lookalikes_figure(v: Visibility, d: Diagnosis) -> Figure | None:
    """Which effect could take how much of another's evidence, look-alikes side by side; None below two effects."""
    shown = [k for k, delta in enumerate(v.delta) if delta > 0]
    if len(shown) < 2:
        return None
    share = v.imitated[np.ix_(shown, shown)]
    order = _side_by_side(share)
    share, names = share[np.ix_(order, order)], [v.names[shown[k]] for k in order]
    texts = [
        [f"{100 * s:.0f}" if s >= 0.3 and i != j else "" for j, s in enumerate(row)]
        for i, row in enumerate(share)
    ]
    data: list[Trace] = [
        {
            "type": "heatmap",
            "z": packed(share, single=True),
            "x": names,
            "y": names,
            "zmin": 0,
            "zmax": 1,
            "colorscale": SEQUENCE,
            "text": texts,
            "texttemplate": "%{text}",
            "textfont": {"size": 10},
            "xgap": 1,
            "ygap": 1,
            "colorbar": {"title": {"text": "share imitated", "side": "right"}, "thickness": 12},
            "hovertemplate": "%{x} takes %{z:.2f} of the evidence of %{y}<extra></extra>",
        }
    ]
    layout = {
        "xaxis": axis("… could be taken by this effect", tickangle=-60, ticks="", showgrid=False),
        "yaxis": axis("Evidence of this effect …", autorange="reversed", ticks="", showgrid=False),
    }
    return Figure(
        [Panel(data, layout, 200 + 24 * len(names), wide=True)],
        "Look-alikes: how much of an effect's evidence in these data another effect could take.",
        [
            "0: nothing in common; 1: not to be told apart by these data. Numbers: per cent, from 30. "
            f"From {100 * SAME:.0f} % on they count as one group. Computed before any reading was looked at, but for "
            "the size of the noise, at weak strength, after all that a new density could explain.",
            *place_of(d),
        ],
        label_of(*d.story.runs),
    )


def _side_by_side(share: Array) -> list[int]:
    apart = 1 - np.clip((share + share.T) / 2, 0, 1)
    np.fill_diagonal(apart, 0.0)
    return leaves_list(linkage(squareform(apart, checks=False), "average", optimal_ordering=True)).tolist()


def gain_figure(gain: Gain, d: Diagnosis) -> Figure:
    """Errors at held-out points by block, and the rms of each block, of the base and the extended model."""
    number_of = np.unique(gain.block, return_inverse=True)[1] + 1.0
    models = [("base model", INK, gain.base_error, -_BESIDE)]
    if d.extended:
        models.append(("extended model", MODEL, gain.extended_error, _BESIDE))
    unit, last = exact_unit(d.story.unit), gain.blocks
    errors: list[Trace] = [
        band(0.4, last + 0.6, 2 * gain.floor, "± 2 × noise floor"),
        line([0.4, last + 0.6], [0, 0], "zero", GREY, width=1, showlegend=False),
        *(dots(number_of + shift, error, name, colour, size=5) for name, colour, error, shift in models),
    ]
    blocks = np.arange(1.0, last + 1)
    sizes = [np.array([_rms(e[number_of == b]) for b in blocks]) for _, _, e, _ in models]
    by_block: list[Trace] = [
        line([0.4, last + 0.6], [gain.floor] * 2, "noise floor", GREY, dash="dash", width=1.4),
        *_links(blocks, sizes),
        *(dots(blocks, size, name, colour, size=8) for (name, colour, _, _), size in zip(models, sizes)),
    ]
    x = axis("Held-out block", dtick=1 if last <= 20 else 5, range=[0.4, last + 0.6])
    top = _WIDER * max(float(s.max()) for s in sizes)
    return Figure(
        [
            Panel(errors, {"xaxis": x, "yaxis": axis(f"Measured − model ({unit})")}, 360),
            Panel(by_block, {"xaxis": x, "yaxis": axis(f"rms in the block ({unit})", range=[0, top])}, 360),
        ],
        "Gain where nothing was fitted: held-out settled positions by block.",
        [
            f"n = {gain.block.size} points in {last} blocks; a block is one excursion out and back. The zero is that "
            "of the training runs, and both densities are from those runs alone. First panel: every error; second: "
            f"rms of each block. Noise floor {gain.floor:.2g} {unit}: readings and draughts as remembered.",
            gain_words(gain, d),
        ],
        label_of(*d.story.runs),
        440,
    )


def _links(x: Array, sizes: Sequence[Array]) -> list[Trace]:
    """A line from before to after, block by block."""
    gaps = np.full(x.size, np.nan)
    return [
        line(
            np.column_stack([x, x, gaps]).ravel(),
            np.column_stack([a, b, gaps]).ravel(),
            "",
            FAINT,
            showlegend=False,
        )
        for a, b in pairwise(sizes)
    ]


def gain_words(gain: Gain, d: Diagnosis) -> str:
    """R in a sentence."""
    unit = exact_unit(d.story.unit)
    if not d.extended:
        return (
            f"Base model {gain.base:.3g} {unit} rms. Nothing was added to the model, so nothing was gained."
        )
    share, ends = gain.removable_share, gain.interval()
    if share is None:
        return (
            f"rms {gain.base:.3g} → {gain.extended:.3g} {unit}: the base model is at the noise floor already."
        )
    between = f" (95 % by drawing blocks again: {ends[0]:.2f} to {ends[1]:.2f})" if ends else ""
    return (
        f"rms {gain.base:.3g} → {gain.extended:.3g} {unit}. R = {share:.2f}{between}: the share of the squared error "
        "above the noise floor that the effects remove."
    ).replace("-", "−")


def _rms(values: ArrayLike) -> float:
    return float(np.sqrt(np.mean(np.asarray(values, dtype=float) ** 2)))
