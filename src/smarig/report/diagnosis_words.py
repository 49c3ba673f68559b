"""What a diagnosis says in sentences: verdict, strengths with their intervals, gain, what shows an effect.

Knows nothing of pages and figures.
"""

import re
from collections.abc import Iterable, Mapping

from smarig.diagnosis.diagnose import NORMAL_95, Diagnosis
from smarig.diagnosis.gain import Gain
from smarig.diagnosis.refine import Refined
from smarig.diagnosis.sentences import share_words
from smarig.model.effect import Kind, Parameter, Planted
from smarig.report.conditions import exact_unit
from smarig.report.html import Html, joined, tag
from smarig.report.numbers import number

Spread = Mapping[tuple[str, str], float]


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
        return f"One of a set: {names} (together 90 % probable). The best is {strengths(best)}."
    meant = " ".join(p.kind.summary for p in best.effects)
    return f"Named: {strengths(best)}. {meant}"


def findings(d: Diagnosis) -> list[str]:
    """What the diagnosis says of itself, with true minus signs."""
    return [re.sub(r"(?<![\w])-(?=\d)", "−", line) for line in d.text().splitlines()]


def strengths(found: Refined) -> str:
    """The effects, each with its strength alone."""
    return " + ".join(f"{p.kind.name}, {_value(p, p.kind.primary, found.spread)}" for p in found.effects)


def explanation(effects: Iterable[Planted], spread: Spread) -> str:
    """The effects, each with all its parameters."""
    return " + ".join(_effect(p, spread) for p in effects)


def _effect(planted: Planted, spread: Spread) -> str:
    values = "; ".join(_value(planted, p, spread) for p in planted.kind.parameters)
    return f"{planted.kind.name}: {values}"


def _value(planted: Planted, parameter: Parameter, spread: Spread) -> str:
    """A parameter, with its 95 % interval where its standard deviation is known."""
    value, unit = planted.values[parameter.name], unit_of(parameter.unit)
    sd = spread.get((planted.kind.name, parameter.name))
    half = None if sd is None else NORMAL_95 * sd
    ends = "" if half is None else f" (95 %: {number(value - half)} to {number(value + half)})"
    return f"{_plain(parameter)} {number(value)}{unit}{ends}"


def _plain(parameter: Parameter) -> str:
    """``swing_K`` in K → "swing", ``latent_J_per_g`` → "latent": the unit is said beside the value."""
    if parameter.name.startswith("percent_per_"):
        return "rate"
    name = parameter.name.removesuffix(f"_{parameter.unit.replace('/', '_per_')}")
    return name.removesuffix("_percent").replace("_", " ")


def unit_of(unit: str) -> str:
    """A unit behind a number, for readers."""
    if unit == "range":
        return " of the range"
    return "" if unit in ("", "1") else f" {exact_unit(unit)}"


def apart(kind: Kind) -> Html:
    """An effect, what it is and what would show it and nothing else."""
    return joined([tag("b", kind.name), f". {kind.summary} What shows it: {kind.separated_by.rstrip('.')}."])


def gain_words(gain: Gain, d: Diagnosis) -> str:
    """R in a sentence."""
    unit = exact_unit(d.story.unit)
    if not d.extended:
        return (
            f"Base model {gain.base:.3g} {unit} rms. Nothing was added to the model, so nothing was gained."
        )
    share, ends = gain.removable_share, gain.interval()
    if share is None:
        rms = f"Rms {gain.base:.3g} → {gain.extended:.3g} {unit}"
        return f"{rms}: the base model is at the floor of what can be foretold already."
    between = (
        f" (95 % by drawing blocks again: {share_words(ends[0])} to {share_words(ends[1])})" if ends else ""
    )
    return (
        f"Rms {gain.base:.3g} → {gain.extended:.3g} {unit}. R = {share_words(share)}{between}: the share of the "
        "squared error above the floor that the effects remove."
    )
