"""What a live view needs to know of a rig or of a recorded run: names, units and ranges."""

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal, get_args

from smarig.config import RigFile
from smarig.core import Settled, SmarigError
from smarig.live.plot_axes import Axis, rounded
from smarig.plant import Actuator
from smarig.preisach import Everett
from smarig.protocols import Setup
from smarig.record import AnyRun
from smarig.replay import recorded_actuator

Start = Literal["negative", "positive", "anhysteretic"]
_UNKNOWN = (0.0, 1.0)  # the range of a channel without values


@dataclass(frozen=True)
class DisplayInfo:
    """What is drawn, in which units, and what is known of the wire beforehand.

    ``twin_hysteresis`` is the hysteresis that a twin's actuator file names. ``initial`` is None if the
    wire's memory is unknown. ``actuator`` is None for data of an unknown rig. ``settling_rule`` is None if
    no step waits for settling.
    """

    title: str
    source: str
    input: Axis
    output: Axis
    unit: str
    input_unit: str
    period_s: float | None
    per_count: float | None
    initial: Start | None
    actuator: Actuator | None = None
    twin_hysteresis: Everett | None = None
    settling_rule: Settled | None = None

    @property
    def label(self) -> str:
        """The label that all drawings of the data carry."""
        return {"twin": "TWIN", "simulation": "SIMULATION"}.get(self.source, "")

    @property
    def two_wire(self) -> bool:
        """Whether it is a differential rig."""
        return self.actuator is not None and self.actuator.two_wire


def rig_display_info(
    file: RigFile,
    actuator: Actuator,
    source: str,
    settings: Mapping[str, Any],
    title: str,
    *,
    known: bool = True,
) -> DisplayInfo:
    """The display information of a rig before a run. The position range is that of the actuator file's
    surface at first.

    ``known``: the wire is in the state that its actuator file names.
    """
    setup = Setup(actuator, file.limits, file.period_s)
    span = actuator.stroke
    low, high = (-span / 2, span / 2) if actuator.two_wire else (0.0, span)
    return DisplayInfo(
        title=title,
        source=source,
        input=_input(setup.lower_K if actuator.two_wire else 0.0, setup.upper_K, "K", actuator),
        output=_output(low, high, actuator.unit),
        unit=actuator.unit,
        input_unit="K",
        period_s=file.period_s,
        per_count=actuator.resolution(file.encoder),
        initial=actuator.file.hysteresis.initial if known else None,
        actuator=actuator,
        twin_hysteresis=actuator.hysteresis if source == "twin" and _is_preisach(actuator) else None,
        settling_rule=settled(settings),
    )


def run_display_info(run: AnyRun) -> DisplayInfo:
    """The display information of a recorded or imported run."""
    actuator = _actuator_of(run)
    period_s, per_count = run.info.period_s, run.info.output.per_count
    low, high = run.extremes("input") or _UNKNOWN
    if actuator is not None and not actuator.two_wire:
        low = min(low, 0.0)
    twin_hysteresis = (
        actuator.hysteresis if actuator is not None and run.twin and _is_preisach(actuator) else None
    )
    return DisplayInfo(
        title=f"{run.info.text_of('protocol', 'run')} on {run.info.text_of('rig', 'an unnamed rig')}",
        source=run.info.text_of("source", ""),
        input=_input(low, high, run.input_unit, actuator),
        output=_output(*(run.extremes("position") or _UNKNOWN), run.unit),
        unit=run.unit,
        input_unit=run.input_unit,
        period_s=float(period_s) if period_s else None,
        per_count=float(per_count) if per_count else None,
        initial=next((start for start in get_args(Start) if start == run.info.initial), None),
        actuator=actuator,
        twin_hysteresis=twin_hysteresis,
        settling_rule=settled(run.info.settings) if actuator and period_s else None,
    )


def settled(settings: Mapping[str, Any]) -> Settled:
    """The settling rule in a protocol's settings."""
    rule_values: dict[str, float] = {}
    for f in fields(Settled):
        with contextlib.suppress(KeyError, TypeError, ValueError):
            rule_values[f.name] = float(settings[f"settle.{f.name}"])
    try:
        return Settled(**rule_values)
    except SmarigError:
        return Settled()


def _actuator_of(run: AnyRun) -> Actuator | None:
    """The actuator of the run, if it is recorded or known by its name."""
    with contextlib.suppress(SmarigError, OSError):
        actuator = recorded_actuator(run)
        if actuator is not None and actuator.unit == run.unit:
            return actuator
    return None


def _input(low: float, high: float, unit: str, actuator: Actuator | None) -> Axis:
    if actuator is None:
        return rounded(f"input ({unit})" if unit else "input", low, high)
    what = "T₁ − T₂" if actuator.two_wire else "temperature above ambient"
    return rounded(f"estimated {what} ({unit})", low, high)


def _output(low: float, high: float, unit: str) -> Axis:
    return rounded(
        f"{'shaft angle' if unit == 'deg' else 'position'} ({unit})" if unit else "output", low, high
    )


def widened_axis(axis: Axis, low: float, high: float) -> Axis:
    """The axis itself if it holds low…high; otherwise a wider one with some margin."""
    if axis.low <= low and high <= axis.high:
        return axis
    room = 0.1 * (axis.high - axis.low)
    low = low - room if low < axis.low else axis.low
    high = high + room if high > axis.high else axis.high
    return rounded(axis.label, low, high)


def description_markdown(display_info: DisplayInfo, models: Sequence[str], mapped: bool) -> str:
    """Origin of the data, names of the models, and meaning of the colours."""
    source = {
        "twin": "## TWIN\n**Nothing here was measured on hardware:** a software twin replaces the rig.\n",
        "simulation": "## SIMULATION\n**Nothing here was measured:** a model was simulated.\n",
    }.get(display_info.source, "")
    lines = [source, f"**{_plain(display_info.title)}**", ""]
    lines.append(
        f"Predicted by: {', '.join(_plain(m) for m in models)}."
        if models
        else "No model is shown. Give one with `--model`."
    )
    if display_info.actuator is not None:
        lines.append(
            "Temperatures come from the heating model along the measured current; they are above ambient."
        )
    lines.append("Amber: present state. White dots: settled means.")
    if mapped:
        lines.append("μ: red positive, blue negative, black zero. Relays below the white boundary are up.")
    return "\n".join(lines)


def _plain(text: str) -> str:
    """The name with its Markdown escaped, since users choose names."""
    return "".join(c if c.isalnum() or c in " -_.,:" else "·" for c in text)


def _is_preisach(actuator: Actuator) -> bool:
    """Whether the twin's wire is the operator that its actuator file names."""
    return actuator.file.thermomechanical is None
