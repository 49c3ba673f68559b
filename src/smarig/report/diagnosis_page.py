"""The page of a diagnosis: what the model misses, why, what could not have been seen, what was gained.

Puts figures, tables and sentences in order; decides nothing.
"""

import re
from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from smarig.diagnosis.candidates import SEEN
from smarig.diagnosis.critique import Critique
from smarig.diagnosis.diagnose import NORMAL_95, WIDER, Diagnosis
from smarig.diagnosis.refine import Refined
from smarig.diagnosis.visibility import SAME
from smarig.model.effect import Kind, Parameter, Planted
from smarig.model.planted import kinds
from smarig.report.conditions import count_size, exact_unit, label_of
from smarig.report.figure import Figure
from smarig.report.figures_diagnosis import (
    Replay,
    called,
    channel_figure,
    detection_figure,
    gain_figure,
    gain_words,
    lookalikes_figure,
    nats,
    noise_of,
    residual_figure,
    rivals_figure,
    singles,
    slopes,
    temperature_figure,
)
from smarig.report.html import Html, bullets, cards, joined, notice, paragraph, table, tag
from smarig.report.numbers import duration, number
from smarig.report.page import Section, page
from smarig.report.run_page import endings, lead
from smarig.report.tables import conditions_table, marks_table, provenance_table

Parts = Iterator[Html | Figure]
Spread = Mapping[tuple[str, str], float]
_BOXES = {
    "silent": "good",
    "named": "good",
    "ambiguous": "warning",
    "unknown": "bad",
    "not_identifiable": "warning",
}


def diagnosis_page(d: Diagnosis) -> str:
    """One self-contained page (HTML) of a diagnosis, for ``write_page``."""
    replay = Replay.of(d)
    sections = [Section(title, short, list(parts(replay))) for title, short, parts in _SECTIONS]
    runs = d.story.runs
    return page(
        "Diagnosis: what the model misses",
        f"{lead(runs[0])}; model {d.model.name}",
        [section for section in sections if section.parts],
        label=label_of(*runs),
        notices=endings(list(runs)),
    )


# --- verdict -----------------------------------------------------------------------------------------------


def _summary(replay: Replay) -> Parts:
    d = replay.d
    doubt = d.verdict.word == "silent" and not d.first.silent
    yield notice("warning" if doubt else _BOXES[d.verdict.word], paragraph(tag("b", verdict_sentence(d))))
    if _worse(d):
        words = (
            "The extended model predicts the held-out runs worse than the base model does: do not use it yet."
        )
        yield notice("bad", paragraph(words))
    yield cards([_detected(d), _error(d), *_gained(d), _used(d)])
    yield bullets(re.sub(r"-(?=\d)", "−", line) for line in d.text().splitlines())


def verdict_sentence(d: Diagnosis) -> str:
    """The verdict for people, in one sentence."""
    word, best = d.verdict.word, d.best
    if word == "silent" and not d.first.silent:
        return (
            "Silent, with a doubt: something stands out, but no effect and no variable explains enough of it."
        )
    if word == "silent":
        return "Silent: the model explains these data as well as data in which nothing is hidden."
    if word == "not_identifiable":
        return (
            "These data cannot tell: no effect of the catalogue could have been seen in them, however large."
        )
    if word == "unknown":
        return f"Unknown: something is wrong and depends on {d.verdict.depends_on}, but no effect known explains it."
    assert best is not None  # noqa: S101 - named and ambiguous verdicts have an explanation
    if word == "ambiguous":
        names = ", ".join(d.verdict.names)
        return f"One of a set: {names} (together 90 % probable). The best is {_strengths(best)}."
    meant = " ".join(p.kind.summary for p in best.effects)
    return f"Named: {_strengths(best)}. {meant}"


def _worse(d: Diagnosis) -> bool:
    """Whether the effects that were added cost on held-out data."""
    return d.extended and d.gain is not None and d.gain.extended > 1.02 * d.gain.base


def _detected(d: Diagnosis) -> tuple[str, str, str]:
    least = 1 / (d.nulls + 1)
    p = f"≤ {least:.2g}" if d.first.p_value <= least * 1.001 else f"= {d.first.p_value:.2g}"
    return "Chance of such an alarm", f"p {p}", f"by {d.nulls} nulls; an alarm needs p < {d.alpha:g}"


def _error(d: Diagnosis) -> tuple[str, str, str]:
    e, unit = d.error, exact_unit(d.error.unit)
    after = f" → {e.extended:.3g}" if d.extended else ""
    note = f"{'base → extended; ' if d.extended else ''}noise floor {e.noise_floor:.2g}; as given {e.given:.3g} {unit}"
    return "Settled points, rms", f"{e.base:.3g}{after} {unit}", note


def _gained(d: Diagnosis) -> Iterator[tuple[str, str, str]]:
    if d.gain is None:
        yield "Gain on held-out data", "unknown", "no held-out run"
    elif not d.extended:
        unit, g = exact_unit(d.error.unit), d.gain
        yield (
            "Held-out error, rms",
            f"{g.base:.3g} {unit}",
            f"{g.blocks} blocks; floor {g.floor:.2g}; nothing was added",
        )
    else:
        yield _removed(d)


def _removed(d: Diagnosis) -> tuple[str, str, str]:
    g, unit = d.gain, exact_unit(d.error.unit)
    assert g is not None  # noqa: S101 - asked only with held-out runs
    ends = g.interval()
    share = "at the floor" if g.removable_share is None else f"R = {g.removable_share:.2f}"
    between = f"95 %: {ends[0]:.2f} to {ends[1]:.2f}; " if ends else ""
    note = f"{between}{g.blocks} blocks; {g.base:.3g} → {g.extended:.3g} {unit} rms, floor {g.floor:.2g}"
    return "Removable error removed on held-out runs", share.replace("-", "−"), note.replace("-", "−")


def _used(d: Diagnosis) -> tuple[str, str, str]:
    others = ", ".join(f"{len(r)} {r.kind}" for r in d.story.others) or "no other readings"
    return "Settled points used", str(len(d.story.settled)), f"{others}; computed in {d.seconds:.0f} s"


def _strengths(found: Refined) -> str:
    """The effects, each with its strength alone."""
    return " + ".join(f"{p.kind.name}, {_value(p, p.kind.primary, found.spread)}" for p in found.effects)


def _explanation(effects: Iterable[Planted], spread: Spread) -> str:
    return " + ".join(_effect(p, spread) for p in effects)


def _effect(planted: Planted, spread: Spread) -> str:
    values = "; ".join(_value(planted, p, spread) for p in planted.kind.parameters)
    return f"{planted.kind.name}: {values}"


def _value(planted: Planted, parameter: Parameter, spread: Spread) -> str:
    """A parameter, with its 95 % interval where its standard deviation is known."""
    value, unit = planted.values[parameter.name], _unit(parameter.unit)
    sd = spread.get((planted.kind.name, parameter.name))
    half = None if sd is None else NORMAL_95 * WIDER * sd
    ends = "" if half is None else f" (95 %: {number(value - half)} to {number(value + half)})"
    return f"{_plain(parameter)} {number(value)}{unit}{ends}"


def _plain(parameter: Parameter) -> str:
    """``swing_K`` in K → "swing": the unit is said beside the value."""
    if parameter.name.startswith("percent_per_"):
        return "rate"
    return parameter.name.removesuffix(f"_{parameter.unit}").removesuffix("_percent").replace("_", " ")


def _unit(unit: str) -> str:
    return "" if unit in ("", "1") else f" {exact_unit(unit)}"


# --- residuals, rivals, detection ---------------------------------------------------------------------------


def _residuals(replay: Replay) -> Parts:
    d = replay.d
    if replay.extended is None:
        yield paragraph("No effect was added to the model, so there is no picture after.")
    yield residual_figure(replay)
    for figure in (channel_figure(replay), temperature_figure(replay)):
        if figure:
            yield figure
    if d.error.base > 1.5 * d.error.given:
        yield notice(
            "warning",
            paragraph(
                f"The density identified anew by the diagnosis fits its own data less well than the model as given: "
                f"{d.error.base:.3g} against {d.error.given:.3g} {exact_unit(d.error.unit)} rms. Part of what is drawn "
                "above may be that density's. The verdict rests on the critic, which allows for any smooth density."
            ),
        )


def _rivals(replay: Replay) -> Parts:
    d = replay.d
    if d.levels:
        yield _explanations_table(d)
    yield _singles_table(d)
    yield rivals_figure(d)


def _explanations_table(d: Diagnosis) -> Html:
    level, known = d.levels[-1], dict(d.verdict.explanations)
    rivals = [
        (_explanation(r.effects, {}), nats(level.lead(k)), _chance(known.get(r.names)))
        for k, r in enumerate(level.explanations)
        if k > 0
    ]
    best = _explanation(level.best.effects, level.best.spread)
    return table(
        ("Explanation", "Nats behind the best", "Probability"),
        [(tag("b", best), "0", _chance(known.get(level.best.names))), *rivals],
        "Explanations that competed last, best first, every parameter fitted to all readings at once. The best gains "
        f"{nats(level.gain)} nats over {_smaller(d)}.",
    )


def _smaller(d: Diagnosis) -> str:
    return "the best with one effect less" if len(d.levels) > 1 else "the base model"


def _chance(p: float | None) -> str:
    if p is None:
        return "–"
    return "< 0.001" if p < 1e-3 else "> 0.999" if p > 0.999 else f"{p:.3f}"


def _singles_table(d: Diagnosis) -> Html:
    rows = [
        (
            called(s),
            nats(s.net),
            nats(s.high - s.median),
            nats(s.standard),
        )
        for s in singles(d)
    ]
    return table(
        (
            "By itself",
            "Gain beyond chance (nats)",
            "Chance: 95 % of nulls stay below (nats)",
            "In spreads",
        ),
        rows,
        "The candidates that gain most by themselves, on the first critique. A generic one that gains much more than "
        "any name is the sign of a cause that is not in the catalogue.",
    )


def _detection(replay: Replay) -> Parts:
    yield detection_figure(replay.d)
    blind = [s.candidate.name for s in replay.d.first.scores if not s.candidate.traces.shape[1]]
    if blind:
        yield paragraph(f"Not judged, because these data cannot show them: {', '.join(blind)}.")


# --- noise -------------------------------------------------------------------------------------------------


def _noise(replay: Replay) -> Parts:
    d, size = replay.d, count_size(replay.d.story.runs[0])
    unit, u = exact_unit(d.story.unit), exact_unit(d.story.runs[0].input_unit)
    critics = [d.first, *[level.critique for level in d.levels[-1:]]]
    whole = noise_of(d, "settled")[1]
    rows = [
        ("Settled position, σ of a reading", *(number(c.refitted.noise.settled) for c in critics), unit),
        *_in_counts(critics, size),
        (
            "Draughts, σ of the input",
            *(number(c.refitted.noise.temperature_K) for c in critics),
            u,
        ),
        ("Draughts, correlation time", *(number(c.refitted.noise.correlation_s) for c in critics), "s"),
        ("Draughts × rms slope ∂y/∂u", *(number(v) for v in _draughts(d, critics)), unit),
    ]
    header = ("Noise", "Base model", *(["With the effects"] if len(critics) > 1 else []), "Unit")
    yield table(
        header, rows, "Noise as the likelihood judges it, whatever the density; what may be wrong set aside."
    )
    yield paragraph(
        f"Together, with draughts as the hysteresis remembers them until they are wiped out: "
        f"{number(whole, 2)} {unit} rms at a settled point{_counts(whole, size, unit)}."
    )
    yield paragraph(
        f"The critic's own time steps: settled points move by at most {number(d.numerics, 2)} {unit} when every "
        f"step is divided by four, {_beside(d.numerics, d.error.noise_floor)}."
    )


def _in_counts(critics: list[Critique], size: float) -> Iterator[tuple[str, ...]]:
    if size:
        yield (
            "The same in encoder counts",
            *(number(c.refitted.noise.settled / size, 2) for c in critics),
            "counts",
        )


def _counts(value: float, size: float, unit: str) -> str:
    return f", {number(value / size, 2)} counts of {number(size)} {unit}" if size else ""


def _draughts(d: Diagnosis, critics: list[Critique]) -> list[float]:
    slope = float(np.sqrt(np.mean(slopes(d) ** 2)))
    return [c.refitted.noise.temperature_K * slope for c in critics]


def _beside(numerics: float, floor: float) -> str:
    if numerics < 1e-3 * floor:
        return "nothing beside the noise"
    return f"{numerics / floor:.2g} of the noise floor"


# --- what could be seen -------------------------------------------------------------------------------------


def _visibility(replay: Replay) -> Parts:
    d, v = replay.d, replay.d.visibility
    known = {k.name: k for k in kinds()}
    yield _visibility_table(d, known)
    if v.invisible:
        yield paragraph(tag("b", "What these data cannot show at any strength, and what would show it:"))
        yield bullets(_apart(known[n]) for n in v.invisible)
    else:
        yield paragraph(
            f"All {len(v.names)} effects of the catalogue would be seen in these data at some strength."
        )
    figure = lookalikes_figure(v, d)
    if figure:
        yield figure
    alike = [n for n in v.names if v.group(n)]
    if alike:
        yield paragraph(tag("b", "What tells look-alikes apart:"))
        yield bullets(_apart(known[n]) for n in alike)


def _apart(kind: Kind) -> Html:
    return joined([tag("b", kind.name), f" ({_bare(kind.summary)}): {_bare(kind.separated_by)}."])


def _bare(text: str) -> str:
    return text.rstrip(".")


def _visibility_table(d: Diagnosis, known: Mapping[str, Kind]) -> Html:
    v = d.visibility
    rows = []
    for k in np.argsort(-v.delta).tolist():
        name = v.names[k]
        p = known[name].primary
        seen = v.delta[k] > 0
        unit = _unit(p.unit)
        rows.append(
            (
                name,
                f"{number(abs(p.typical))}{unit}",
                number(float(v.delta[k])) if seen else "0",
                f"{number(float(v.least[k]), 2)}{unit}" if seen else "none",
                ", ".join(v.group(name)) or "no one",
            )
        )
    return table(
        ("Effect", "Typical strength", "δ at typical strength", "Least strength found", "Who imitates it"),
        rows,
        f"What these data could have shown. δ: size of an effect's trace in noise σ per reading (rms over "
        f"{d.first.refitted.data.size} readings), after everything a density could explain has been taken out. Least: "
        f"the strength that would stand {SEEN:g} σ out of the noise, in proportion from a weak trace. Imitates: could "
        f"take {100 * SAME:.0f} % or more of the evidence.",
    )


# --- gain and what next -------------------------------------------------------------------------------------


def _held_out(replay: Replay) -> Parts:
    d = replay.d
    if d.gain is None:
        yield paragraph(
            "No held-out run was given, so it is unknown what the effects gain outside their own data."
        )
        return
    yield paragraph(gain_words(d.gain, d))
    yield gain_figure(d.gain, d)


def _next(replay: Replay) -> Parts:
    d = replay.d
    run = d.separating_run
    if run is not None:
        hours = run.get("rig_hours")
        time = f", {duration(3600 * float(hours))} on the rig" if hours is not None else ""
        yield notice("good", paragraph(tag("b", f"{run['protocol']}{time}")), paragraph(str(run["why"])))
        return
    yield from _without_a_run(d)


def _without_a_run(d: Diagnosis) -> Parts:
    known = {k.name: k for k in kinds()}
    word, names = d.verdict.word, d.verdict.names
    if word == "unknown":
        yield paragraph(
            f"Change {d.verdict.depends_on} alone, with everything else as it was: what that changes in the "
            "residuals is the effect by itself."
        )
    elif word == "silent" and not d.first.silent:
        yield paragraph("The same run once more: what is no noise comes again.")
    elif word == "silent":
        yield paragraph(
            "Nothing asks for an experiment. Section “What could not have been seen” says what might still hide."
        )
    elif word == "not_identifiable":
        yield paragraph("A run that can show something at all: see what would show each effect above.")
    else:
        yield paragraph(
            "What would settle it:" if word == "ambiguous" else "What would confirm it independently:"
        )
    if names and word in ("named", "ambiguous"):
        yield bullets(_apart(known[n]) for n in names)
    elif names:
        yield paragraph("What would confirm or rule out the nearest names:")
        yield bullets(_apart(known[n]) for n in names)


def _provenance(replay: Replay) -> Parts:
    d = replay.d
    runs = {f"{k}. {run.path.name}": run for k, run in enumerate(d.story.runs, start=1)}
    yield conditions_table(d.story.runs[0])
    yield marks_table(runs)
    yield provenance_table(runs)
    yield paragraph(
        f"Runs above taught; model {d.model.name}; {d.nulls} nulls, α = {d.alpha:g}. Computed in {duration(d.seconds)}."
    )


_SECTIONS = (
    ("Verdict", "Verdict", _summary),
    ("What the model misses", "Residuals", _residuals),
    ("Rivals", "Rivals", _rivals),
    ("Is anything wrong at all?", "Detection", _detection),
    ("Noise floor and numerics", "Noise", _noise),
    ("What could not have been seen", "Visibility", _visibility),
    ("Gain on held-out blocks", "Gain", _held_out),
    ("The next experiment", "Next", _next),
    ("Rig, honest numbers, provenance", "Provenance", _provenance),
)
