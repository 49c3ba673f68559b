"""What a diagnosis says in sentences: verdict, strengths with their intervals, gain, what shows an effect.

Knows nothing of pages and figures.
"""

import re
from collections.abc import Iterable, Iterator, Mapping

from smarig.diagnosis import NORMAL_95, Diagnosis, HeldOutGain, ParameterFit, share_text
from smarig.plant import Effect, EffectType, Parameter, effect_types
from smarig.report.components.html import Html, bullets, joined, notice, paragraph, tag
from smarig.report.components.numbers import duration, number
from smarig.report.components.run_description import display_unit

ParameterSigmas = Mapping[tuple[str, str], float]


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
        return "These data cannot decide: no effect of the catalogue could have been seen in them, however large."
    if word == "unknown":
        return f"Unknown: something is wrong and depends on {d.verdict.depends_on}, but no effect known explains it."
    assert best is not None  # noqa: S101 - named and ambiguous verdicts have an explanation
    if word == "ambiguous":
        names = ", ".join(d.verdict.names)
        return f"One of a set: {names} (together 90 % probable). The best is {strengths_text(best)}."
    meant = " ".join(p.kind.summary for p in best.effects)
    return f"Named: {strengths_text(best)}. {meant}"


def findings(d: Diagnosis) -> list[str]:
    """What the diagnosis says of itself, with true minus signs."""
    return [re.sub(r"(?<![\w])-(?=\d)", "−", line) for line in d.text().splitlines()]


def strengths_text(found: ParameterFit) -> str:
    """The effects, each with its strength alone."""
    return " + ".join(f"{p.kind.name}, {_value_text(p, p.kind.primary, found.spread)}" for p in found.effects)


def explanation_text(effects: Iterable[Effect], spread: ParameterSigmas) -> str:
    """The effects, each with all its parameters."""
    return " + ".join(_effect_text(p, spread) for p in effects)


def _effect_text(effect: Effect, spread: ParameterSigmas) -> str:
    values = "; ".join(_value_text(effect, p, spread) for p in effect.kind.parameters)
    return f"{effect.kind.name}: {values}"


def _value_text(effect: Effect, parameter: Parameter, spread: ParameterSigmas) -> str:
    """A parameter, with its 95 % interval where its standard deviation is known."""
    value, unit = effect.values[parameter.name], unit_suffix(parameter.unit)
    sd = spread.get((effect.kind.name, parameter.name))
    half = None if sd is None else NORMAL_95 * sd
    ends = "" if half is None else f" (95 %: {number(value - half)} to {number(value + half)})"
    return f"{_plain_name(parameter)} {number(value)}{unit}{ends}"


def _plain_name(parameter: Parameter) -> str:
    """``swing_K`` in K → "swing", ``latent_J_per_g`` → "latent": the unit is said beside the value."""
    if parameter.name.startswith("percent_per_"):
        return "rate"
    name = parameter.name.removesuffix(f"_{parameter.unit.replace('/', '_per_')}")
    return name.removesuffix("_percent").replace("_", " ")


def unit_suffix(unit: str) -> str:
    """A unit behind a number, for readers."""
    if unit == "range":
        return " of the range"
    return "" if unit in ("", "1") else f" {display_unit(unit)}"


def distinguishing_text(kind: EffectType) -> Html:
    """An effect, what it is and what would show it and nothing else."""
    return joined([tag("b", kind.name), f". {kind.summary} What shows it: {kind.separated_by.rstrip('.')}."])


def gain_text(gain: HeldOutGain, d: Diagnosis) -> str:
    """R in a sentence."""
    unit = display_unit(d.timeline.unit)
    if not d.extended:
        return (
            f"Base model {gain.base:.3g} {unit} rms. Nothing was added to the model, so nothing was gained."
        )
    share, ends = gain.removable_share, gain.interval()
    if share is None:
        rms = f"Rms {gain.base:.3g} → {gain.extended:.3g} {unit}"
        return f"{rms}: the base model is at the floor of what can be predicted already."
    between = (
        f" (95 % by drawing blocks again: {share_text(ends[0])} to {share_text(ends[1])})" if ends else ""
    )
    return (
        f"Rms {gain.base:.3g} → {gain.extended:.3g} {unit}. R = {share_text(share)}{between}: the share of the "
        "squared error above the floor that the effects remove."
    )


def next_experiment(d: Diagnosis) -> Iterator[Html]:
    """The run asked for, or advice by verdict."""
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
        yield bullets(distinguishing_text(types[n]) for n in names)
    elif names:
        yield paragraph("What would confirm or rule out the nearest names:")
        yield bullets(distinguishing_text(types[n]) for n in names)
