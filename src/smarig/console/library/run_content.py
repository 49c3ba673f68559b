"""What the library keeps of a run file, finished, interrupted, or being recorded.

The identity of a run: the same for its copies, under any name, while it is recorded and after it was resumed.

It is made of what the file has held since the first sample and never changes. A run whose start is not recorded (an
import, a simulation) is written at once, so the hashes of its samples identify it.

The heating cycles of a run, counted as the history of its wire counts them (``record.Wear``).
"""

import hashlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from smarig.config import ActuatorFile, LimitsFile
from smarig.console.library.library_entry import RECORDING, RUN, Content, FigureRow
from smarig.core import Array, InUse
from smarig.plant import Actuator
from smarig.protocols import Setup
from smarig.record import COLD, HOT, AnyRun, StoredRun, check_not_recording, load_run, stored_run
from smarig.report import RunSummary, run_assessment, source_label, summary_of
from smarig.transformation import headline

_CONSTANT_KEYS = (
    *("start_epoch", "source", "protocol", "settings", "seed", "effects"),
    *("rig", "wire", "actuator", "period_s", "model", "along"),
)
_LENGTH = 20  # hexadecimal digits: 80 bits


def run_identity(run: StoredRun) -> str:
    """The identity of a run."""
    facts: list[Any] = [run.meta.get(key) for key in _CONSTANT_KEYS]
    facts.append(run.first_sample)
    if run.info.start_epoch is None:
        hashes = run.meta.get("hashes")
        facts += [
            run.info.imported and run.info.imported.sha256,
            hashes.get("sample") if isinstance(hashes, dict) else None,
        ]
    return content_identity(json.dumps(facts, sort_keys=True, default=str).encode())


def content_identity(content: bytes) -> str:
    """The identity of a content."""
    return hashlib.sha256(content).hexdigest()[:_LENGTH]


def input_range_K(run: AnyRun) -> float | None:
    """The largest input that the limits of the recorded rig allow; None if the run does not hold its rig."""
    try:
        actuator = Actuator(ActuatorFile.model_validate(run.info.actuator_values))
        limits = LimitsFile.model_validate(run.info.rig_values["limits"])
        setup = Setup(actuator, limits, run.info.period_s or 0.1)
        return max(setup.upper_K, -setup.lower_K)
    except Exception:  # values of any origin: pydantic, the actuator and the setup each refuse them their way
        return None


def heating_cycles(u: Array, range_K: float) -> int:
    """How often the input (n,) rose above half of the range after it was below a quarter.

    >>> heating_cycles(np.array([0.0, 90.0, 40.0, 90.0, 10.0, 90.0]), 100.0)
    2
    """
    size = np.abs(u[np.isfinite(u)])
    hot, cold = size > HOT * range_K, size < COLD * range_K
    marks = np.where(hot, 1, np.where(cold, -1, 0))
    marks = marks[marks != 0]
    return int(np.count_nonzero(np.diff(marks) == 2))


MOST_ANALYSED = 2_000_000  # samples that are read into memory for the figures: two days at 10 Hz
_FIGURES = ("stroke", "A_s", "A_f", "M_s", "M_f", "width")


def run_content(file: Path) -> Content | None:
    """The content of a run; None until its first sample, from which on its identity stays the same.

    Raises DataError for any other file, and for one that was changed.
    """
    recording = is_recording(file)
    with stored_run(file, verify=False) as run:
        if recording:
            return None if run.first_sample is None else _being_recorded(run)
        few = len(run) <= MOST_ANALYSED
        if not few:
            run.verify()
        summary, assessed = summary_of(run), run_assessment(run)
        described = _described(run)
        return replace(
            described,
            duration_s=_finite(summary.duration_s),
            verdict=assessed.level,
            sentence=assessed.quality,
            details=described.details | _details(run, summary),
            figures=_cycles(run) | (_figures(file) if few else {}),
            u=tuple(summary.u.tolist()),
            y=tuple(summary.y.tolist()),
        )


def is_recording(file: Path) -> bool:
    """Whether a process of this computer records the run now."""
    try:
        check_not_recording(file)
    except InUse:
        return True
    return False


def _being_recorded(run: StoredRun) -> Content:
    """Only what costs the recorder and the disk nothing: no column is read."""
    described = _described(run)
    size = {"samples": len(run), "steps": len(run.steps), "complete": False}
    return replace(
        described,
        verdict=RECORDING,
        sentence="The run is being recorded.",
        details=described.details | size,
    )


def _described(run: StoredRun) -> Content:
    """What the description says."""
    info, first = run.info, run.first_sample
    start_s = first[1] if first and first[1] is not None else 0.0
    return Content(
        identity=run_identity(run),
        kind=RUN,
        name=run.name,
        began=_began(run, start_s),
        wire=info.wire or "",
        rig=info.rig or "",
        protocol=info.protocol or "",
        label=source_label(run),
        details={
            "settings": {key: str(value) for key, value in info.settings.items()},
            "seed": info.seed,
            "notes": info.notes or "",
            "effects": [str(effect) for effect in info.effects],
            "source": info.source or "",
            "unit": run.unit,
            "input_unit": run.input_unit,
        },
    )


def _began(run: StoredRun, start_s: float) -> float | None:
    """When the run began, by the clock of the computer: a fast twin's own clock would place it in the future."""
    if run.info.start_epoch is None:
        return None
    began, end = float(run.info.start_epoch) + start_s, run.info.end
    return began if end is None or end.epoch is None else min(began, end.epoch)


def _details(run: StoredRun, summary: RunSummary) -> dict[str, Any]:
    end = run.info.end
    return {
        "cause": summary.cause,
        "complete": summary.complete,
        "samples": summary.samples,
        "steps": summary.steps,
        "settled": summary.settled,
        "flagged": summary.flagged,
        "travel": _finite(summary.travel),
        "axes": list(summary.axes),
        "severity": str(run.severity),
        "ended": end.epoch if end else None,
    }


def _cycles(run: StoredRun) -> dict[str, FigureRow]:
    range_K = input_range_K(run)
    if range_K is None or not run.has("input"):
        return {}
    return {"cycles": (float(heating_cycles(run["input"], range_K)), None, None, "")}


def _figures(file: Path) -> dict[str, FigureRow]:
    """Transformation temperatures, stroke and width of a run with a full loop. Raises DataError for a damaged one."""
    run = load_run(file)
    try:
        found = headline(run)
    except Exception:  # measured data of any kind: without figures, the run is still an entry
        return {}
    return {
        name: (each.value, *_ends(each.ci95), each.unit)
        for name in _FIGURES
        if (each := found.get(name)) is not None and np.isfinite(each.value)
    }


def _ends(interval: tuple[float, float]) -> tuple[float | None, float | None]:
    low, high = map(_finite, interval)
    return (low, high) if low is not None and high is not None else (None, None)


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
