"""What a closed-loop run did, read from its record alone: where the loop was closed, and how well it went.

Runs are recognised by their marks; what a controller wanted and what was foretold of B_ℓ stand in them. Positions are
the readings, encoder noise and quantum included. Refuses to know models.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.control.regulation.loop import CLOSED as REGULATED
from smarig.control.regulation.loop import DISTURBED, MARK, OPENED
from smarig.control.regulation.plane import Plane
from smarig.control.tracking.loop import CLOSED as TRACKED
from smarig.control.tracking.measures import Tracked, measured
from smarig.control.tracking.reference import Reference
from smarig.errors import SmarigError
from smarig.model.actuator import Actuator
from smarig.record import Event, Run
from smarig.report.conditions import count_size
from smarig.report.loop_end import LoopEnd, loop_end

Array = NDArray[np.float64]
SKIP_S = 20.0  # the way to the first point of a moving reference is no tracking


@dataclass(frozen=True, eq=False)
class Stretch:
    """The samples of the closed loop, (n,) each; time since it was closed, the predicted temperature as input."""

    t_s: Array
    wanted: Array
    position: Array
    current_A: Array
    input_K: Array
    count: float

    @property
    def error(self) -> Array:
        """Measured less wanted, in counts (in the unit where the run does not say what a count is)."""
        return (self.position - self.wanted) / (self.count or 1.0)


@dataclass(frozen=True, eq=False)
class TrackedRun:
    """A run along a reference; ``figures`` is None for one that ended before there were any."""

    controller: str
    reference: Reference
    skip_s: float
    loop: Stretch
    figures: Tracked | None

    def to_json(self) -> dict[str, Any]:
        """Figures in the rig's unit, and errors in counts besides."""
        plain: dict[str, Any] = {
            "controller": self.controller,
            "reference": self.reference.name,
            "skip_s": self.skip_s,
        }
        if self.figures is None:
            return plain
        count = self.loop.count
        plain |= asdict(self.figures)
        if count:
            plain |= {"rms_counts": self.figures.rms / count, "largest_counts": self.figures.largest / count}
        return plain


@dataclass(frozen=True, eq=False)
class Regulated:
    """A run that held a set-point. ``facts`` are those of its mark; areas in K², outputs in the rig's unit.

    ``distance_K2`` is d(B, B_ℓ) along the predicted temperature of the wire, ``output_error`` the measured output less
    the set-point after the approach, ``transient`` the largest |error| of the readings from the disturbance on (None
    without one), ``pulse_s`` when it began and ended, ``push_K`` how large it was, ``end`` the last stretch. ``zero``
    is what the model's scale has more than the encoder's.
    """

    facts: dict[str, Any]
    loop: Stretch | None
    pulse_s: tuple[float, float] | None
    zero: float
    boundary: tuple[tuple[float, float], ...]
    distance_K2: float | None
    output_error: float | None
    transient: float | None
    push_K: float
    end: LoopEnd | None

    def to_json(self) -> dict[str, Any]:
        """The figures; ψ's curve and the boundaries stay in the record."""
        drawn = ("psi_ell_K", "psi", "predicted_boundary")
        return {key: value for key, value in self.facts.items() if key not in drawn} | {
            "reached_distance_K2": self.distance_K2,
            "output_error": self.output_error,
            "transient": self.transient,
            "last_error": self.end and self.end.mean,
            "last_spread": self.end and self.end.spread,
            "last_s": self.end and self.end.seconds,
            "last_verdict": self.end and (self.end.verdict or None),
        }


def is_closed_loop(run: Run) -> bool:
    """Whether a run's loop was closed, or was going to be."""
    return _mark(run, TRACKED) is not None or _mark(run, MARK) is not None


def closed_loop(run: Run) -> TrackedRun | Regulated | None:
    """What the loop of a run did; None for runs without one, and for marks that are not ours."""
    try:
        if (mark := _mark(run, TRACKED)) is not None:
            return _tracked(run, mark)
        if (mark := _mark(run, MARK)) is not None:
            return _regulated(run, mark)
    except (KeyError, TypeError, ValueError, IndexError, SmarigError):
        return None
    return None


def _mark(run: Run, label: str) -> Event | None:
    return next((e for e in run.events if e.kind == "mark" and e.text == label), None)


def _tracked(run: Run, mark: Event) -> TrackedRun:
    follow, start_s = Reference.of(mark.data["reference"]), float(mark.data["start_s"])
    rows = _between(run, mark, start_s)
    t = run["t_s"][rows] - start_s
    if follow.held:  # the last point of steps is their end, and none of them
        rows = rows[t < follow.duration_s - 1e-6]
        t = run["t_s"][rows] - start_s
    loop = _stretch(run, rows, t, np.array([follow.at(v) for v in t.tolist()]))
    skip_s = SKIP_S if not follow.held and follow.duration_s > 2 * SKIP_S else 0.0
    figures = None
    if t.size >= 2 and loop.count:
        columns = (loop.position, loop.current_A, loop.input_K)
        actuator = Actuator.named(run.meta["actuator"])
        ahead_s = _seconds(run.meta.get("settings", {}).get("lead_s"))
        figures = measured(follow, t, *columns, actuator, loop.count, skip_s=skip_s, ahead_s=ahead_s)
    return TrackedRun(str(mark.data.get("controller") or "unnamed"), follow, skip_s, loop, figures)


def _seconds(setting: Any) -> float:
    """How far the controller of a record looked ahead; 0 where that is not said."""
    try:
        return max(0.0, float(setting))
    except (TypeError, ValueError):
        return 0.0


def _regulated(run: Run, mark: Event) -> Regulated:
    facts = _facts(mark.data)
    closed = _mark(run, REGULATED)
    upto = closed.t_s if closed else np.inf
    before = (run["t_s"] > mark.t_s) & (run["t_s"] <= upto)
    plane = Plane(float(facts["lower_K"]), float(facts["upper_K"]))
    boundary = plane.after(run["input"][before]) if before.any() else plane.after([plane.lower])
    ell = facts.get("ell_K") if closed else None
    distance = plane.distance(boundary, float(ell)) if ell is not None else None
    points = plane.points(boundary)
    if closed is None:
        return Regulated(facts, None, None, 0.0, points, distance, None, None, 0.0, None)
    wanted, rows = float(closed.data["wanted_position"]), _between(run, closed, closed.t_s)
    loop = _stretch(run, rows, run["t_s"][rows] - closed.t_s, np.full(rows.size, wanted))
    arrived = next((s.position for s in run.steps if s.branch == "arrive" and s.position is not None), None)
    pulse, push_K = _pulse(run, closed.t_s)
    off = loop.position - wanted
    return Regulated(
        facts,
        loop,
        pulse,
        float(facts["setpoint"]) - wanted,
        points,
        distance,
        None if arrived is None else arrived - wanted,
        float(np.abs(off[loop.t_s > pulse[0]]).max()) if pulse and np.any(loop.t_s > pulse[0]) else None,
        push_K,
        loop_end(loop.t_s, off, loop.current_A, loop.count, pulse[1] if pulse else 0.0),
    )


def _facts(data: Mapping[str, Any]) -> dict[str, Any]:
    """What the mark of a set-point says, as numbers; KeyError or ValueError where it says too little."""
    plain = {key: float(data[key]) for key in ("setpoint", "rest_K", "lower_K", "upper_K")}
    ell, psi = ([float(v) for v in data[key]] for key in ("psi_ell_K", "psi"))
    if len(ell) != len(psi) or not len(psi) or not plain["lower_K"] < plain["upper_K"]:
        raise ValueError("ψ is drawn over the range of the inputs")
    found = {**plain, "start": str(data["start"]), "psi_ell_K": ell, "psi": psi}
    if "ell_K" in data:
        found |= {key: float(data[key]) for key in _PLANNED}
        found["predicted_boundary"] = [
            (float(beta), float(alpha)) for beta, alpha in data["predicted_boundary"]
        ]
    return found


_PLANNED = (
    *("ell_K", "output", "predicted_distance_K2", "area_K2", "predicted_output_error_share"),
    *("cycles", "wave_s", "approach_s"),
)


def _pulse(run: Run, closed_s: float) -> tuple[tuple[float, float] | None, float]:
    """When the disturbance began and ended, and its kelvin of source; None and 0 without one."""
    marks = [e for e in run.events if e.kind == "mark" and e.text == DISTURBED]
    if not marks:
        return None, 0.0
    times = [e.t_s - closed_s for e in marks]
    end = times[1] if len(times) > 1 else float(run["t_s"][-1]) - closed_s
    return (times[0], end), float(marks[0].data["source_K"])


def _between(run: Run, mark: Event, start_s: float) -> NDArray[np.intp]:
    """Rows of the samples from a mark to the opening of the loop, or to the end."""
    opened = next(
        (e.t_s for e in run.events if e.kind == "mark" and e.text == OPENED and e.t_s >= mark.t_s), np.inf
    )
    return np.flatnonzero((run["t_s"] > start_s) & (run["t_s"] <= opened))


def _stretch(run: Run, rows: NDArray[np.intp], t: Array, wanted: Array) -> Stretch:
    position, current_A, input_K = (run[name][rows] for name in ("position", "current_A", "input"))
    return Stretch(t, wanted, position, current_A, input_K, count_size(run))
