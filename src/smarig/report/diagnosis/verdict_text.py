"""The words of a diagnosis page: verdict with its level, key figures, strengths, and the next experiment."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from smarig.diagnosis import (
    POINT_NOISE,
    PREDICTION_LIMIT,
    CommandedDiagnosis,
    Finding,
    share_text,
    variable_experiment,
)
from smarig.plant import EffectType, effect_types, parameter_words
from smarig.report.components.html import Html, bullets, cards, joined, notice, paragraph, tag
from smarig.report.components.numbers import distinct_digits, duration, number
from smarig.report.components.run_description import display_unit

SEVERITY_LEVELS = {
    "silent": "good",
    "named": "bad",
    "ambiguous": "bad",
    "unknown": "bad",
    "not_identifiable": "warning",
}


def verdict_sentence(d: CommandedDiagnosis) -> str:
    """The verdict; of named effects also what they do."""
    opening = " ".join(findings(d)[: max(len(d.findings), 1)])
    return f"{opening} {changes_text(d)}" if d.verdict.word == "named" else opening


def changes_text(d: CommandedDiagnosis) -> str:
    """What each effect of the verdict does, a sentence each, in the unit of the output where it is known."""
    h = d.model.hysteresis
    stroke, unit = abs(float(h.everett(h.upper, h.lower))), display_unit(d.model.unit)
    return " ".join(effect.change_text(stroke, unit) for effect in d.likely_effects)


def findings(d: CommandedDiagnosis) -> list[str]:
    """The lines of the diagnosis's text, with true minus signs."""
    return [re.sub(r"(?<![\w])-(?=\d)", "−", line) for line in d.lines()]


def strengths_text(found: Sequence[Finding]) -> str:
    """The effects, each with the values that were fitted: a swing has no sign without its phase."""
    return " + ".join(f"{f.name}, {'; '.join(_fitted(f))}" for f in found)


def _fitted(found: Finding) -> list[str]:
    primary, *others = found.parameters.items()
    return [_value_text(*primary), *(_value_text(name, v) for name, v in others if v["ci95"])]


def _value_text(name: str, found: Mapping[str, Any]) -> str:
    """A parameter, with its 95 % interval where it is known."""
    ends, unit = found["ci95"], found["unit"]
    digits = distinct_digits(*ends) if ends else 3
    between = f" (95 %: {number(ends[0], digits)} to {number(ends[1], digits)})" if ends else ""
    words = parameter_words(name, unit)
    shown = "" if words == f"{unit}s" else unit_suffix(unit)  # cycles 24, no unit
    return f"{words} {number(found['value'], digits)}{shown}{between}"


def unit_suffix(unit: str) -> str:
    """The text of a unit after a number."""
    if unit == "range":
        return " of the range"
    return "" if unit in ("", "1") else f" {display_unit(unit)}"


def distinguishing_text(kind: EffectType) -> Html:
    """An effect: its name, its summary, what distinguishes it from all others, and what can be done against it."""
    remedy = f" Against it: {kind.remedy}." if kind.remedy else ""
    return joined(
        [tag("b", kind.name), f". {kind.summary} What shows it: {kind.separated_by.rstrip('.')}.{remedy}"]
    )


def next_experiment(d: CommandedDiagnosis) -> Iterator[Html]:
    """The proposed separating run, or advice by verdict."""
    run = d.separating_run
    if run is not None:
        hours = run.get("rig_hours")
        time = f", {duration(3600 * float(hours))} on the rig" if hours is not None else ""
        yield notice("good", paragraph(tag("b", f"{run['protocol']}{time}")), paragraph(str(run["why"])))
        return
    if d.verdict.word == "silent" and (left_open := list(_left_open(d))):
        yield paragraph("Nothing stands out in what was tested. More is known after this:")
        yield bullets(left_open)
        return
    yield paragraph(_advice(d))
    if d.verdict.names:
        types = {t.name: t for t in effect_types()}
        yield bullets(distinguishing_text(types[n]) for n in d.verdict.names)


def _left_open(d: CommandedDiagnosis) -> Iterator[str]:
    """What a silent diagnosis has not tested, each with the run that would; nothing if it has tested everything."""
    if d.gain is None:
        yield (
            "No run was held out, so the model has predicted blocks of its own runs only. Run validation with another "
            "seed, and give that run with --held-out."
        )
    if d.too_short_to_name:
        yield (
            f"The runs have {d.evidence.blocks} excursions, too few for the name of a cause. More have "
            "first_order_descending, and validation with more points."
        )
    if d.not_identifiable:
        yield "Section “What could not have been seen” lists effects that may be present, with what would show each."
    if d.given_is_far:
        yield "The given model is far from these data. Identify the wire again from them, and verify that model."


def _advice(d: CommandedDiagnosis) -> str:
    match d.verdict.word:
        case "silent":
            return (
                "No experiment is needed. These runs would show each effect of the catalogue at some strength, and the "
                "held-out runs do not contradict the plain model."
            )
        case "not_identifiable":
            return "Make a run that can show an effect. The list above states what would show each effect."
        case "unknown" if d.verdict.depends_on is None:
            return "Repeat the same run. A real effect appears again; noise does not."
        case "unknown":
            return variable_experiment(d.verdict.depends_on or "")
        case "ambiguous":
            return "What would decide between them:"
        case _:
            return "What would confirm it independently:"


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
