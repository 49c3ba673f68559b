"""The sentences of a study: how large the error is and where, what a simple curve does, and what the diagnosis says."""

import re
from collections.abc import Sequence
from typing import Literal

from smarig.core import capitalised, spaced
from smarig.diagnosis import (
    CommandedDiagnosis,
    MeasuredDiagnosis,
    doubtful_causes,
    offset_sentence,
    variable_words,
)
from smarig.exchange import convert, dimension
from smarig.identification import BETTER, LITTLE_UNPREDICTED, ErrorLevel, ratio_text
from smarig.plant import parameter_words
from smarig.report import display_unit, number
from smarig.study.function_of_input import FunctionOfInput
from smarig.study.held_out_parts import BranchError

LEVEL_WORDS = {
    ErrorLevel.GOOD: "good",
    ErrorLevel.FAIR: "fair, with errors to explain",
    ErrorLevel.POOR: "poor",
}


def measure(value: float, unit: str, digits: int = 3) -> str:
    """A value with its unit as shown."""
    return f"{number(value, digits)}{spaced(display_unit(unit))}"


def error_sentence(
    model: str,
    rms: float,
    unit: str,
    *,
    share: float,
    noise: tuple[float | None, str],
    verdict: str,
    unpredicted: float,
    fitted: bool,
) -> str:
    """How large the error is, and the verdict in words."""
    part = "" if unpredicted < LITTLE_UNPREDICTED else f"{100 * (1 - unpredicted):.0f} % of "
    what = f"fits {part}the data" if fitted else f"predicts {part}the held-out data"
    ratio = _over_noise(rms, noise)
    rest = ", and nothing of the rest" if part else ""
    size = f"{measure(rms, unit)} rms, {number(100 * share, 2)} % of the output's range"
    return f"The model ({model}) {what} to within {size}{ratio}{rest}: {verdict}."


def _over_noise(rms: float, noise: tuple[float | None, str]) -> str:
    """An error as a multiple of the noise, by its name; empty if that is unknown."""
    value, name = noise
    return f", {ratio_text(rms / value)} × the {name}" if value else ""


InnerLoops = Literal["none", "held out", "fitted"]
AS_WELL: dict[InnerLoops, str] = {
    "none": "; no data turn inside the loop.",
    "held out": "; the fitted data do not turn inside the loop, but the held-out data do. Fit such reversals, too.",
    "fitted": ", although the fitted data hold inner loops.",
}


def left_out_sentence(rms: float, unit: str, noise: tuple[float | None, str]) -> str:
    """How large the error is on blocks left out of the fit: where nothing is held out, the honest figure."""
    ratio = _over_noise(rms, noise)
    return f"On blocks left out of the fit, the error is {measure(rms, unit)} rms{ratio}."


PROPORTIONAL_TO_TEMPERATURE = {  # what does this, by the dimension of the output
    "resistance": "the temperature coefficient of resistance",
    "length": "thermal expansion",
    "ratio": "thermal expansion",
}
_MOST_EXPANSION = 3e-5  # per K: that of aluminium is 2.3e-5, of NiTi 0.7e-5 to 1.1e-5


def proportional_sentence(slope: float, unit: str, input_unit: str) -> str:
    """The part of the output that is proportional to the input, and what does this where a temperature drives it."""
    hot = input_unit in ("K", "degC")
    too_large = dimension(unit) == "ratio" and abs(convert(slope, unit, "1")) > _MOST_EXPANSION
    cause = PROPORTIONAL_TO_TEMPERATURE.get(dimension(unit), "") if hot and not too_large else ""
    size = f"about {number(slope, 2)} {display_unit(unit)}/{'K' if hot else display_unit(input_unit)}"
    return f"A part of it is proportional to the input, {size}{f', as {cause} would be' if cause else ''}."


def simple_curve_sentence(
    name: str,
    error: float,
    gain: float,
    unit: str,
    *,
    left_out: bool = False,
    as_well: bool = False,
    inner_loops: InnerLoops = "none",
) -> str:
    """How large the error of the best simple curve is; ``gain`` times that of the model, of its error on blocks
    ``left_out`` of the fit if nothing was held out. ``as_well``: the curve is a pair of branches and about as good as
    the model, as it must be where no data hold ``inner_loops``.
    """
    if as_well:
        ratio = ratio_text(gain)
        times = "as much" if ratio == "1" else f"{ratio} times as much"
        leaves = f"{measure(error, unit)}, {times} as the model"
        return f"A simple curve ({name}) leaves {leaves}{AS_WELL[inner_loops]}"
    than = " than the model on blocks left out of the fit" if left_out else ""
    if gain >= BETTER:
        than_model = " as that of the model on blocks left out of the fit" if left_out else ""
        larger = f"{ratio_text(gain)} times as large{than_model}, {measure(error, unit)}"
        return f"The error of the best simple curve ({name}) is {larger}."
    if gain >= 1:
        as_model = than.replace("than", "as", 1)
        return f"A simple curve ({name}) does nearly as well{as_model}: {measure(error, unit)}."
    return (
        f"A simple curve ({name}) does better{than}: {measure(error, unit)}. Do not use the model as it is."
    )


def function_sentences(found: FunctionOfInput, unit: str, *, fitted: bool) -> list[str]:
    """That the output is a function of the input, how well a curve predicts it, and what the model does."""
    over = found.rms / found.noise if found.noise else 0.0
    noise = f"the noise of a reading, {measure(found.noise, unit)}"
    error = (
        f"{measure(found.rms, unit)} rms, {ratio_text(over)} × the noise of a reading" if over >= 1 else noise
    )
    what = "readings left out of its fit" if fitted else "the held-out data"
    model = "fits the data" if fitted else "predicts them"
    first = "The output is a function of the input; these data show no hysteresis."
    if found.lag_s:
        low, high = found.lag_ci95
        first = (
            f"The output is a function of the input, which acts {number(found.lag_s)} s late ({number(low)} to "
            f"{number(high)} s); these data show no hysteresis: the loop is that of the lag, and grows with the rate."
        )
    return [
        first,
        f"A curve predicts {what} to within {error}.",
        f"The Preisach model {model} to within {measure(found.model_rms, unit)} rms: use the curve.",
    ]


def branch_name(branch: BranchError, *, temperature: bool) -> str:
    """A branch in words."""
    if temperature:
        return "the heating branch" if branch.direction > 0 else "the cooling branch"
    return "a branch of rising input" if branch.direction > 0 else "a branch of falling input"


def where_sentence(branch: BranchError, span: float, units: tuple[str, str], *, temperature: bool) -> str:
    """Where the error is largest; ``units`` of input and output, ``span`` the range of the output."""
    share = number(100 * branch.worst / span, 2) if span else "–"
    where = place_text(branch, units[0], temperature=temperature)
    return f"The error is largest on {where}: {measure(branch.worst, units[1])} rms, {share} % of the range."


def place_text(branch: BranchError, input_unit: str, *, temperature: bool) -> str:
    """The place of the largest error on a branch."""
    ends = f"from {number(branch.start)} to {measure(branch.end, input_unit)}"
    return f"{branch_name(branch, temperature=temperature)} {ends}"


def unpredicted_sentence(share: float, *, whole_record: bool) -> str:
    """What the model cannot predict, and what would change that."""
    about = "the data" if whole_record else "the held-out data"
    return (
        f"For {100 * share:.0f} % of {about} the model has no prediction: they depend on a history before the record "
        'begins. If you know the state at the start, write initial = "negative" or "positive" in mapping.toml.'
    )


def finding_sentence(
    d: CommandedDiagnosis | MeasuredDiagnosis,
    *,
    at_noise: bool,
    small: bool = False,
    differing: Sequence[str] = (),
) -> str:
    """What the diagnosis says of the errors that are left; they look like noise only if they are as small.

    ``small``: the model is good, whatever is left. ``differing``: conditions in which the runs differ.
    """
    shifted = _shift(d) if isinstance(d, MeasuredDiagnosis) else []
    if shifted and (d.verdict.depends_on == "run" or d.verdict.names == ("input_offset",)):
        return " ".join(shifted)  # that is what the run varies in
    finding = _finding(d, d.lines()[0], at_noise=at_noise, small=small, differing=differing)
    return " ".join([finding, *shifted])


def _shift(d: MeasuredDiagnosis) -> list[str]:
    """The sentence on the held-out run whose input is shifted most."""
    held_out = sorted((o for o in d.offsets if o.held_out), key=lambda o: -abs(o.offset))
    return [_as_shown(offset_sentence(offset, d.runs[0].input_unit, d.unit)) for offset in held_out[:1]]


def _as_shown(line: str) -> str:
    """A line of a diagnosis with true minus signs and the degree sign."""
    return re.sub(r"(?<!\w)-(?=\d)", "−", line).replace(" degC", " °C")


def _finding(
    d: CommandedDiagnosis | MeasuredDiagnosis,
    first_line: str,
    *,
    at_noise: bool,
    small: bool,
    differing: Sequence[str],
) -> str:
    word, variable = d.verdict.word, d.verdict.depends_on
    if word == "silent":
        if at_noise:
            return "The diagnosis finds no systematic error: what is left looks like noise."
        return "The diagnosis finds no cause for the errors that are left."
    if word == "unknown":
        named = " and ".join(map(variable_words, variable.split(" and "))) if variable else ""
        size = "are small and " if small else ""
        what = f"{size}vary with {named}" if named else "are more than noise"
        if d.verdict.names:  # an effect explains them, but the verdict has a doubt
            return f"The errors that are left {what}. {doubtful_causes(d.verdict, d.causes)}"
        if variable == "run" and differing:
            return f"The errors that are left {what}, and so does the {' and the '.join(differing)}."
        joined = "; " if named else ", but "
        return f"The errors that are left {what}{joined}no known effect explains them{_learned_instead(d)}."
    if (
        word == "named"
        and isinstance(d, MeasuredDiagnosis)
        and (d.best is not None or d.evidence.jump is not None)
    ):
        return " ".join(_effects(d))
    return first_line if first_line.endswith(".") else f"{first_line}."


def _learned_instead(d: CommandedDiagnosis | MeasuredDiagnosis) -> str:
    return "; a term learned from them describes a part, without a cause" if d.learned is not None else ""


def _effects(d: MeasuredDiagnosis) -> list[str]:
    """Each effect found: its name, what it is, and its strength with an interval."""
    summaries = {e.kind.name: e.kind.summary for e in (d.best.effects if d.best else d.evidence.effects)}
    return [_effect(e["name"], summaries.get(e["name"], ""), e["parameters"]) for e in d.effects()]


def _effect(name: str, summary: str, parameters: dict) -> str:
    """An effect as the cause, or as a possible one if the data do not exclude that its strength is 0."""
    searched = {k: p for k, p in parameters.items() if k != "reference"}
    strengths = ", ".join(_strength(k, p) for k, p in searched.items())
    if _may_be_none(searched):
        what = f"{summary[:1].lower()}{summary[1:].removesuffix('.')}"
        return f"A possible cause: {name} ({what}): {strengths}, which may be 0."
    size = f" {capitalised(strengths)}." if strengths else ""
    return f"A cause was found: {name}. {summary}{size}"


def _may_be_none(parameters: dict) -> bool:
    """Whether every interval of an effect contains 0: of a shift for each run, one may be sure."""
    ends = [p["ci95"] for p in parameters.values() if p["ci95"] and None not in p["ci95"]]
    return bool(ends) and all(low <= 0 <= high for low, high in ends)


def _strength(name: str, parameter: dict) -> str:
    unit = display_unit(parameter["unit"] or "")
    ends: Sequence[float | None] = parameter["ci95"] or (None, None)
    between = f" ({number(ends[0])} to {number(ends[1])})" if None not in ends else ""
    stored = parameter["unit"] or ""
    called = "" if stored.replace("/", "_per_") == name else f"{parameter_words(name, stored)} "
    return f"{called}{measure(parameter['value'], '' if stored == '1' else unit)}{between}"
