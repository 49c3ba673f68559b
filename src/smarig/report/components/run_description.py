"""Descriptions of a run for captions: rig, wire, n, seed, units, origin of the input, and quality counts."""

import math
import re
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np

from smarig.core import Quality, capitalised
from smarig.record import AnyRun
from smarig.report.components.figure import axis
from smarig.report.components.numbers import thousands

_FEWEST_SETTLED = 2
_SOURCE_LABELS = {"twin": "TWIN", "simulation": "SIMULATION"}

_MICRO = re.compile(r"(?<![A-Za-z])u(?=(?:m|s|g|A|V|W|T|C|N|J|ohm)(?![A-Za-z]))")


def source_label(*runs: AnyRun) -> str:
    """ "TWIN" or "SIMULATION" if any of the runs was not measured, "" for hardware and imports."""
    found = [_SOURCE_LABELS[run.info.source] for run in runs if run.info.source in _SOURCE_LABELS]
    return found[0] if found else ""


def protocol_name(run: AnyRun) -> str:
    """The displayed name of the protocol."""
    return (run.info.protocol or "unnamed").replace("_", " ").replace("sma ", "SMA ")


def run_caption(run: AnyRun) -> str:
    """The last sentence of a caption: the number of steps and samples. The page states the conditions once."""
    settled = len(run.settled)
    samples = f"{thousands(len(run))} samples"
    return f"n = {settled} steps, {samples}." if settled else f"n = {samples}."


def conditions_text(run: AnyRun, *others: AnyRun) -> str:
    """Rig, wire, seed, ambient temperature and origin of the input; unknown items are omitted.

    The ambient temperature is that of all runs, also of ``others``.
    """
    rig = run.info.rig
    where = [f"wire {run.info.wire}" if run.info.wire else "", f"rig {rig}" if rig else ""]
    where += [f"imported from {run.info.imported.file}" if run.info.imported else ""]
    where += [
        f"seed {run.info.seed}" if source_label(run) and run.info.has("seed") else "",
        _ambient(run, *others),
    ]
    source = run.info.input.from_
    where += [f"input from the {source}" if source else ""]
    return ", ".join(part for part in where if part)


def _ambient(*runs: AnyRun) -> str:
    known = [ends for run in runs if (ends := run.extremes("ambient_degC"))]
    if not known:
        return ""
    low, high = min(ends[0] for ends in known), max(ends[1] for ends in known)
    stated = next(
        (f" by the {run.info.ambient_from} (not measured)" for run in runs if run.info.ambient_from), ""
    )
    return (
        f"ambient {low:.1f} °C{stated}"
        if high - low < 0.05
        else f"ambient {low:.1f} to {high:.1f} °C{stated}"
    )


def extent(run: AnyRun, column: str) -> float:
    """The range of "input" or "position": over the settled points, else over the samples, which noise makes larger.

    NaN without readings.
    """
    if len(run.settled) >= _FEWEST_SETTLED:
        return float(np.ptp(run.points()[1 if column == "position" else 0]))
    low, high = run.extremes(column) or (math.nan, math.nan)
    return high - low


def duration_s(run: AnyRun) -> float:
    """The time from first to last sample; NaN for a run without times."""
    return run.span_s if run.has("t_s") else float("nan")


def display_unit(unit: str) -> str:
    """A unit as displayed: kg/m³ for kg/m^3, °C for degC, µm for um, and nothing for 1.

    >>> display_unit("uC/cm^2"), display_unit("um"), display_unit("1")
    ('µC/cm²', 'µm', '')
    """
    shown = unit.replace("^2", "²").replace("^3", "³").replace("degC", "°C").replace("100K", "100 K")
    return "" if unit == "1" else _MICRO.sub("µ", shown)


def input_title(run: AnyRun) -> str:
    """The axis title of the hysteresis input with its unit: "Wire temperature above ambient (K)"."""
    return _axis_title(run.info.input.quantity or "input", run.input_unit)


def output_title(run: AnyRun) -> str:
    """The axis title of the output with its unit."""
    return _axis_title(run.info.output.quantity or "output", run.unit)


def loop_axes(run: AnyRun) -> dict[str, Any]:
    """The layout of a panel of output against input."""
    return {"xaxis": axis(input_title(run)), "yaxis": axis(output_title(run))}


def _axis_title(quantity: str, unit: str) -> str:
    return with_unit(capitalised(quantity).replace("T1 - T2", "T₁ − T₂"), unit)


def with_unit(words: str, unit: str) -> str:
    """A quantity with its unit as displayed, as for an axis.

    >>> with_unit("Length", "um"), with_unit("Share", "1")
    ('Length (µm)', 'Share')
    """
    shown = display_unit(unit)
    return f"{words} ({shown})" if shown else words


def started(run: AnyRun, form: str = "%Y-%m-%d %H:%M") -> str:
    """The start of a run's session in UTC; "" if it is unknown."""
    epoch = run.info.start_epoch
    return datetime.fromtimestamp(epoch, UTC).strftime(form) if epoch else ""


def count_size(run: AnyRun) -> float:
    """One encoder count in the run's unit, 0 without an encoder."""
    return run.info.output.resolution


@dataclass(frozen=True)
class QualityCounts:
    """Counts of a run: steps that count by verdict, void steps, samples by quality mark, gaps with lost samples."""

    steps: int
    settled: int
    timed_out: int
    interrupted: int
    suspect_steps: int
    void: int
    samples: int
    retried: int
    stale: int
    saturated: int
    tripped: int
    suspect: int
    gaps: int

    @property
    def clean(self) -> bool:
        """Whether no step and no sample is marked or missing, but for steps that were repeated."""
        return not (self.gaps or any(getattr(self, name) for name in FLAG_NAMES if name != "void"))


def lost_samples(run: AnyRun) -> int:
    """How many ticks have no sample, in a run that says so. Where a device was restarted, ticks begin again."""
    if not any(event.kind == "lost" for event in run.events):
        return 0
    steps = np.diff(run["tick"])
    return int((steps[steps > 1] - 1).sum())


FLAG_NAMES = (
    *("timed_out", "interrupted", "void"),
    *("retried", "stale", "saturated", "tripped", "suspect", "suspect_steps"),
)


def quality_counts(run: AnyRun) -> QualityCounts:
    """The quality counts of a run."""
    marks = {flag.name.lower(): int(flag) for flag in Quality if flag.name and flag}
    verdicts = [step.verdict for step in run.steps if not step.void]
    return QualityCounts(
        steps=len(verdicts),
        settled=verdicts.count("settled"),
        timed_out=verdicts.count("timed_out"),
        interrupted=verdicts.count("interrupted"),
        suspect_steps=verdicts.count("suspect"),
        void=sum(step.void for step in run.steps),
        samples=len(run),
        gaps=sum(event.kind == "lost" for event in run.events),
        **dict(zip(marks, run.marked(*marks.values()), strict=True)),
    )
