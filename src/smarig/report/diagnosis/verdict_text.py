"""The sentences of a diagnosis page: verdict, strengths with intervals, gain and next experiment."""

import re
from collections.abc import Iterable, Iterator, Mapping

from smarig.diagnosis import (
    AT_FLOOR,
    DOUBT,
    PREDICTION_LIMIT,
    Diagnosis,
    HeldOutGain,
    ParameterFit,
    parameter_interval,
    share_text,
    unknown_text,
    variable_experiment,
)
from smarig.plant import Effect, EffectType, Parameter, effect_types, parameter_words
from smarig.report.components.html import Html, bullets, joined, notice, paragraph, tag
from smarig.report.components.numbers import distinct_digits, duration, number
from smarig.report.components.run_description import display_unit

ParameterSigmas = Mapping[tuple[str, str], float]


def verdict_sentence(d: Diagnosis) -> str:
    """The verdict in one or two sentences."""
    word, best = d.verdict.word, d.best
    if word == "silent" and d.first.alarm:
        return f"No finding, with a doubt: {DOUBT}."
    if word == "silent":
        return "No finding: the model explains these data as well as it explains data without any effect."
    if word == "not_identifiable":
        return "These data cannot decide: they cannot show any effect of the catalogue at any strength."
    if word == "unknown":
        return f"Unknown: {unknown_text(d)}."
    assert best is not None  # noqa: S101 - named and ambiguous verdicts have an explanation
    if word == "ambiguous":
        names = ", ".join(d.verdict.names)
        return f"Ambiguous: one of {names} (together 0.9 of the score). The best is {strengths_text(best)}."
    return f"Named: {strengths_text(best)}. {changes_text(d)}"


def changes_text(d: Diagnosis) -> str:
    """What each effect of the best explanation does, a sentence each, in the unit of the output where it is known."""
    assert d.best is not None  # noqa: S101 - asked of named verdicts only
    h = d.model.hysteresis
    stroke, unit = abs(float(h.everett(h.upper, h.lower))), display_unit(d.model.unit)
    return " ".join(effect.change_text(stroke, unit) for effect in d.best.effects)


def findings(d: Diagnosis) -> list[str]:
    """The lines of the diagnosis's text, with true minus signs."""
    return [re.sub(r"(?<![\w])-(?=\d)", "−", line) for line in d.lines()]


def strengths_text(found: ParameterFit) -> str:
    """The effects, each with its strength and what else was fitted: a swing has no sign without its phase."""
    return " + ".join(
        f"{p.kind.name}, {'; '.join(_value_text(p, q, found.spread) for q in _fitted(p, found))}"
        for p in found.effects
    )


def _fitted(effect: Effect, found: ParameterFit) -> list[Parameter]:
    primary, *others = effect.kind.parameters
    return [primary, *(p for p in others if (effect.kind.name, p.name) in found.spread)]


def explanation_text(effects: Iterable[Effect], spread: ParameterSigmas) -> str:
    """The effects, each with all its parameters."""
    return " + ".join(_effect_text(p, spread) for p in effects)


def _effect_text(effect: Effect, spread: ParameterSigmas) -> str:
    values = "; ".join(_value_text(effect, p, spread) for p in effect.kind.parameters)
    return f"{effect.kind.name}: {values}"


def _value_text(effect: Effect, parameter: Parameter, spread: ParameterSigmas) -> str:
    """A parameter, with its 95 % interval where its standard deviation is known."""
    value, unit = effect.values[parameter.name], unit_suffix(parameter.unit)
    ends = parameter_interval(parameter, value, spread.get((effect.kind.name, parameter.name)))
    digits = distinct_digits(*ends) if ends else 3
    between = f" (95 %: {number(ends[0], digits)} to {number(ends[1], digits)})" if ends else ""
    name = parameter_words(parameter.name, parameter.unit)
    shown = "" if name == f"{parameter.unit}s" else unit  # cycles 24, no unit
    return f"{name} {number(value, digits)}{shown}{between}"


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


def gain_text(gain: HeldOutGain, d: Diagnosis) -> str:
    """The gain on held-out data and R in a sentence."""
    unit = display_unit(d.timeline.unit)
    if not d.extended:
        return f"Base model: rms error {gain.base:.3g} {unit}. No effect was added to the model, so there is no gain."
    share, ends = gain.removable_share, gain.interval()
    if share is None:
        return f"Rms error {gain.base:.3g} → {gain.extended:.3g} {unit}. {AT_FLOOR}"
    between = f" (95 %, by resampling blocks: {share_text(ends[0])} to {share_text(ends[1])})" if ends else ""
    return (
        f"Rms error {gain.base:.3g} → {gain.extended:.3g} {unit}. R = {share_text(share)}{between}: the extension "
        f"removes this share of the squared error above the {PREDICTION_LIMIT}."
    )


def next_experiment(d: Diagnosis) -> Iterator[Html]:
    """The proposed separating run, or advice by verdict."""
    run = d.separating_run
    if run is not None:
        hours = run.get("rig_hours")
        time = f", {duration(3600 * float(hours))} on the rig" if hours is not None else ""
        yield notice("good", paragraph(tag("b", f"{run['protocol']}{time}")), paragraph(str(run["why"])))
        return
    yield from _advice(d)


def _advice(d: Diagnosis) -> Iterator[Html]:
    types = {t.name: t for t in effect_types()}
    word, names = d.verdict.word, d.verdict.names
    if word == "unknown" and d.verdict.depends_on is None:
        yield paragraph("Repeat the same run. A real effect appears again; noise does not.")
    elif word == "unknown":
        yield paragraph(variable_experiment(d.verdict.depends_on or ""))
    elif word == "silent" and d.first.alarm:
        yield paragraph("Repeat the same run. A real effect appears again; noise does not.")
    elif word == "silent":
        yield paragraph(
            "No experiment is needed. Section “What could not have been seen” lists effects that may still be present."
        )
    elif word == "not_identifiable":
        yield paragraph(
            "Make a run that can show an effect. The list above states what would show each effect."
        )
    else:
        yield paragraph(
            "What would decide between them:"
            if word == "ambiguous"
            else "What would confirm it independently:"
        )
    if names and word in ("named", "ambiguous"):
        yield bullets(distinguishing_text(types[n]) for n in names)
    elif names:
        yield paragraph("What would confirm or rule out the nearest names:")
        yield bullets(distinguishing_text(types[n]) for n in names)
