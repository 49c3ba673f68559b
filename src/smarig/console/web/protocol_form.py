"""The fields of the form of a protocol, made from its signature: name, unit, kind of value, default.

What the settings of the protocols mean, one sentence each, for people who fill in a form.
"""

import inspect
from collections.abc import Iterator
from dataclasses import MISSING, dataclass, fields, is_dataclass
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from smarig.core import catalogue_entry
from smarig.protocols import PROTOCOLS

_SETTLE = {
    "settle.band_counts": "Settled: the position stays within this many encoder counts, peak to peak, over the window.",
    "settle.window_s": "For how long the position has to stay within the band.",
    "settle.timeout_s": "A step that has not settled by then is marked as timed out, and the run continues.",
    "settle.approach_K": "The window starts when the predicted temperature is this close to its final value.",
}
_INPUTS = {
    "partition_K": "Temperatures above ambient at which the curves begin and are measured.",
    "points": "More points resolve the loop more finely and take longer.",
    "points_per_branch": "Steps on each rising and each falling branch.",
    "temperatures_K": "Temperatures above ambient to hold one after the other, in place of the profile.",
    "currents_A": "Currents to hold one after the other, in place of the profile.",
    "file": "A CSV file with a column temperature_K or current_A, in place of the profile.",
    "temperature": "A formula in t, in K above ambient, such as 87+60*sin(2*pi*t/600), in place of the profile.",
    "profile": "Shape of the temperature over the range of the rig.",
    "duration_s": "How long the formula or the change of load lasts.",
    "input_K": "Temperature above ambient that is held; without a value, half of the rig's range.",
    "lower_K": "Lower end of the cycles above ambient; without a value, that of the rig's range.",
    "upper_K": "Upper end of the cycles above ambient; without a value, that of the rig's range.",
    "reversals_K": "Temperatures above ambient at which a rise ends, in place of evenly spaced ones.",
    "rates_K_per_s": "Rates of the wire's temperature, in turn. With one rate only, the time constant stays unknown.",
}
_OTHERS = {
    "seed": "Chooses the random inputs: the same number gives the same inputs.",
    "curves": "Number of evenly spaced temperatures at which a rise ends.",
    "cycles": "Number of heating and cooling cycles.",
    "method": "planned: the wire's temperature decays as prescribed. thesis: the published currents.",
    "low": "Lower end of the minor loops, as a share of the range (0 to 1).",
    "high": "Upper end of the minor loops, as a share of the range (0 to 1).",
    "peak": "Upper end of the outer loop, as a share of the range (0 to 1).",
    "low_A": "Lower current of the minor loops; without a value, half of the largest that the limits allow.",
    "high_A": "Upper current of the minor loops; without a value, three quarters of the largest that the limits allow.",
    "loops": "Number of minor loops.",
    "loop_s": "Period of one loop. If it is short, the temperature lags behind the current and the loops drift.",
    "lead_s": "Time at the first load, in which the wire reaches its temperature.",
    "longest_h": "The run ends after this much rig time at the latest.",
    "target_share": "The run ends when the predicted error is below this share of the output range.",
}
SETTING_HELP = {**_SETTLE, **_INPUTS, **_OTHERS}


FieldKind = Literal["number", "integer", "switch", "choice", "list", "text"]
_UNITS = {
    "K": "K",
    "s": "s",
    "h": "h",
    "A": "A",
    "N": "N",
    "MPa": "MPa",
    "degC": "°C",
    "counts": "counts",
    "mm": "mm",
    "percent": "%",
}
_RATE = "_K_per_s"
_KINDS: tuple[tuple[type, FieldKind], ...] = (
    (str, "text"),
    (bool, "switch"),
    (int, "integer"),
    (float, "number"),
)


@dataclass(frozen=True)
class FormField:
    """One setting: ``key`` as on the command line, words and unit for people, the text of its default.

    ``group``: the words of the settings that belong together; "" for those of the protocol itself. An empty default
    means that the protocol chooses the value. ``help``: a sentence for people.
    """

    key: str
    words: str
    unit: str
    kind: FieldKind
    default: str
    choices: tuple[str, ...] = ()
    group: str = ""
    help: str = ""


def protocol_form(name: str) -> tuple[FormField, ...]:
    """The fields of a protocol of the catalogue. Raises UsageError if there is none of this name.

    >>> [(f.key, f.words, f.unit, f.default) for f in protocol_form("validation")][:2]
    [('points', 'points', '', '40'), ('seed', 'seed', '', '1')]
    """
    function = catalogue_entry(PROTOCOLS, name)
    hints = get_type_hints(function)
    return tuple(
        field
        for p in inspect.signature(function).parameters.values()
        if p.kind is p.KEYWORD_ONLY
        for field in _fields(p.name, hints[p.name], p.default)
    )


def _fields(name: str, hint: Any, default: Any) -> Iterator[FormField]:
    group = next((t for t in _members(hint) if isinstance(t, type) and is_dataclass(t)), None)
    if group is None:
        yield _field(name, name, hint, default)
        return
    hints = get_type_hints(group)
    for part in fields(group):
        own = "" if part.default is MISSING else part.default
        value = own if default is None else getattr(default, part.name)
        yield _field(f"{name}.{part.name}", part.name, hints[part.name], value, _words(name)[0])


def _field(key: str, name: str, hint: Any, default: Any, group: str = "") -> FormField:
    words, unit = _words(name)
    members = _members(hint)
    choices = tuple(str(c) for m in members if get_origin(m) is Literal for c in get_args(m))
    kind: FieldKind = "text"
    if choices:
        kind = "choice"
    elif any("tuple" in str(m) for m in members):
        kind = "list"
    else:
        kind = dict(_KINDS).get(next((m for m in members if m in dict(_KINDS)), str), "text")
    return FormField(key, words, unit, kind, _text(default), choices, group, SETTING_HELP.get(key, ""))


def _members(hint: Any) -> tuple[Any, ...]:
    """The alternatives of a type, without None."""
    parts = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
    return tuple(part for part in parts if part is not type(None))


def _text(value: Any) -> str:
    """A value as it is typed on the command line."""
    if value is None:
        return ""
    if isinstance(value, tuple):
        return ", ".join(_text(v) for v in value)
    return f"{value:g}" if isinstance(value, float) else str(value)


def _words(name: str) -> tuple[str, str]:
    """The words and the unit of a name that ends in its unit."""
    if name.endswith(_RATE):
        return name.removesuffix(_RATE).replace("_", " "), "K/s"
    start, _, last = name.rpartition("_")
    if start and last in _UNITS:
        return start.replace("_", " "), _UNITS[last]
    return name.replace("_", " "), ""
