"""The result of a closed-loop run, computed from its record: the samples in closed loop and the errors.

Marks identify closed-loop runs and contain the reference and the predicted distance from B_ℓ. Positions are readings
and include encoder noise and quantisation.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.control import (
    REGULATION_PLANNED,
    SETPOINT_DISTURBED,
    SETPOINT_LOOP_OPENED,
    TRACKING_LOOP_CLOSED,
    VELOCITY_LOOP_MEASURED,
    VELOCITY_LOOP_STARTED,
    BoundaryPlane,
    Reference,
    TrackingPerformance,
    tracking_performance,
)
from smarig.control import SETPOINT_LOOP_CLOSED as REGULATED
from smarig.core import Array, DataError, SmarigError
from smarig.record import Event, Run
from smarig.replay import recorded_actuator
from smarig.report.closed_loop.hold_end import HoldEnd, hold_end
from smarig.report.closed_loop.observed_position import ObservedPosition, observed_position
from smarig.report.closed_loop.velocity_result import VelocityResult
from smarig.report.components.run_description import count_size

SKIP_S = 20.0  # the approach to the first point of a moving reference is not tracking


@dataclass(frozen=True, eq=False)
class LoopSegment:
    """The samples in closed loop, (n,) each; time since it was closed, predicted temperature as input."""

    t_s: Array
    wanted: Array
    position: Array
    current_A: Array
    input_K: Array
    count: float

    @property
    def error(self) -> Array:
        """Measured − reference, in counts (in the run's unit if the count size is unknown)."""
        return (self.position - self.wanted) / (self.count or 1.0)


@dataclass(frozen=True, eq=False)
class TrackingResult:
    """A tracking run; ``measures`` is None if the run ended before any error was measured.

    ``velocity`` is the result in terms of Thm 8.2 for velocity feedback, None for position feedback.
    """

    controller: str
    reference: Reference
    skip_s: float
    loop: LoopSegment
    measures: TrackingPerformance | None
    velocity: VelocityResult | None = None

    def to_json(self) -> dict[str, Any]:
        """Results in the rig's unit, and errors also in counts."""
        plain: dict[str, Any] = {
            "controller": self.controller,
            "reference": self.reference.name,
            "skip_s": self.skip_s,
        }
        if self.velocity is not None:
            plain["velocity"] = self.velocity.to_json()
        if self.measures is None:
            return plain
        count = self.loop.count
        plain |= asdict(self.measures)
        if count:
            plain |= {
                "rms_counts": self.measures.rms / count,
                "largest_counts": self.measures.largest / count,
            }
        return plain


@dataclass(frozen=True, eq=False)
class RegulationResult:
    """A regulation run. ``setpoint_data`` is the data of its mark; areas in K², outputs in the rig's unit.

    ``distance_K2`` is d(B, B_ℓ), computed from the predicted temperature of the wire. ``output_error`` is the measured
    output minus the set-point after the approach. ``transient`` is the largest |error| of the readings after the
    disturbance starts (None without a disturbance). ``disturbance_s`` gives its start and end, ``disturbance_K`` its
    size. ``end`` describes the last segment. ``zero`` is added to the encoder's scale to obtain the model's scale.
    ``observed`` is the position that closed the loop if that was not the encoder's.
    """

    setpoint_data: dict[str, Any]
    boundary: tuple[tuple[float, float], ...]
    distance_K2: float | None
    loop: LoopSegment | None = None
    disturbance_s: tuple[float, float] | None = None
    zero: float = 0.0
    output_error: float | None = None
    transient: float | None = None
    disturbance_K: float = 0.0
    end: HoldEnd | None = None
    observed: ObservedPosition | None = None

    def to_json(self) -> dict[str, Any]:
        """The results without the curve of ψ and the boundaries, which the record contains."""
        drawn = ("psi_ell_K", "psi", "predicted_boundary")
        return {key: value for key, value in self.setpoint_data.items() if key not in drawn} | {
            "reached_distance_K2": self.distance_K2,
            "output_error": self.output_error,
            "transient": self.transient,
            "last_error": self.end and self.end.mean,
            "last_spread": self.end and self.end.std,
            "last_s": self.end and self.end.seconds,
            "last_verdict": self.end and (self.end.verdict or None),
            **({"self_sensing": self.observed.to_json()} if self.observed else {}),
        }


def is_closed_loop(run: Run) -> bool:
    """Whether a run has a closed loop, or was to have one."""
    return _mark(run, TRACKING_LOOP_CLOSED) is not None or _mark(run, REGULATION_PLANNED) is not None


def closed_loop_result(run: Run) -> TrackingResult | RegulationResult | None:
    """The result of a run's closed loop; None for runs without one and for marks of other programs."""
    try:
        if (mark := _mark(run, TRACKING_LOOP_CLOSED)) is not None:
            return _tracking_result(run, mark)
        if (mark := _mark(run, REGULATION_PLANNED)) is not None:
            return _regulation_result(run, mark)
    except (KeyError, TypeError, ValueError, IndexError, SmarigError):
        return None
    return None


def _mark(run: Run, label: str) -> Event | None:
    return next((e for e in run.events if e.kind == "mark" and e.text == label), None)


def _tracking_result(run: Run, mark: Event) -> TrackingResult:
    reference, start_s = Reference.of(mark.data["reference"]), float(mark.data["start_s"])
    rows = _closed_rows(run, mark, start_s)
    t = run["t_s"][rows] - start_s
    if reference.held:  # the last point of a sequence of steps is its end, not a step
        rows = rows[t < reference.duration_s - 1e-6]
        t = run["t_s"][rows] - start_s
    loop = _segment(run, rows, t, np.array([reference.at(v) for v in t.tolist()]))
    skip_s = SKIP_S if not reference.held and reference.duration_s > 2 * SKIP_S else 0.0
    measures = None
    if t.size >= 2 and loop.count:
        columns = (loop.position, loop.current_A, loop.input_K)
        actuator = recorded_actuator(run)
        if actuator is None:
            raise DataError(
                f"{run.path.name} does not name its actuator, which the figures of this loop need."
            )
        ahead_s = _lead_time_s(run.info.settings.get("lead_s"))
        measures = tracking_performance(
            reference, t, *columns, actuator, loop.count, skip_s=skip_s, ahead_s=ahead_s
        )
    name = str(mark.data.get("controller") or "unnamed")
    measured = _mark(run, VELOCITY_LOOP_MEASURED) or _mark(run, VELOCITY_LOOP_STARTED)
    velocity = VelocityResult.of(measured.data) if measured else None
    return TrackingResult(name, reference, skip_s, loop, measures, velocity)


def _lead_time_s(setting: Any) -> float:
    """The preview time of the controller of a record; 0 if it is not recorded."""
    try:
        return max(0.0, float(setting))
    except (TypeError, ValueError):
        return 0.0


def _regulation_result(run: Run, mark: Event) -> RegulationResult:
    setpoint_data = _setpoint_data(mark.data)
    closed = _mark(run, REGULATED)
    closed_s = closed.t_s if closed else np.inf
    before = (run["t_s"] > mark.t_s) & (run["t_s"] <= closed_s)
    plane = BoundaryPlane(float(setpoint_data["lower_K"]), float(setpoint_data["upper_K"]))
    boundary = (
        plane.boundary_after(run["input"][before]) if before.any() else plane.boundary_after([plane.lower])
    )
    ell = setpoint_data.get("ell_K") if closed else None
    distance = plane.distance(boundary, float(ell)) if ell is not None else None
    points = plane.points(boundary)
    if closed is None:
        return RegulationResult(setpoint_data, points, distance)
    wanted, rows = float(closed.data["wanted_position"]), _closed_rows(run, closed, closed.t_s)
    loop = _segment(run, rows, run["t_s"][rows] - closed.t_s, np.full(rows.size, wanted))
    arrived = next((s.position for s in run.steps if s.branch == "arrive" and s.position is not None), None)
    disturbance_s, disturbance_K = _disturbance(run, closed.t_s)
    off = loop.position - wanted
    return RegulationResult(
        setpoint_data=setpoint_data,
        loop=loop,
        disturbance_s=disturbance_s,
        zero=float(setpoint_data["setpoint"]) - wanted,
        boundary=points,
        distance_K2=distance,
        output_error=None if arrived is None else arrived - wanted,
        transient=float(np.abs(off[loop.t_s > disturbance_s[0]]).max())
        if disturbance_s and np.any(loop.t_s > disturbance_s[0])
        else None,
        disturbance_K=disturbance_K,
        end=hold_end(loop.t_s, off, loop.current_A, loop.count, disturbance_s[1] if disturbance_s else 0.0),
        observed=observed_position(run, closed.t_s, closed.data),
    )


def _setpoint_data(data: Mapping[str, Any]) -> dict[str, Any]:
    """The data of a set-point's mark as numbers; KeyError or ValueError if they are incomplete."""
    plain = {key: float(data[key]) for key in ("setpoint", "rest_K", "lower_K", "upper_K")}
    ell, psi = ([float(v) for v in data[key]] for key in ("psi_ell_K", "psi"))
    if len(ell) != len(psi) or not len(psi) or not plain["lower_K"] < plain["upper_K"]:
        raise ValueError("lengths of ψ and ℓ differ, or the range of inputs is empty")
    found: dict[str, Any] = {**plain, "start": str(data["start"]), "psi_ell_K": ell, "psi": psi}
    if "ell_K" in data:
        found |= {key: float(data[key]) for key in _PLAN_KEYS}
        found["predicted_boundary"] = [
            (float(beta), float(alpha)) for beta, alpha in data["predicted_boundary"]
        ]
    return found


_PLAN_KEYS = (
    *("ell_K", "output", "predicted_distance_K2", "area_K2", "predicted_output_error_share"),
    *("cycles", "wave_s", "approach_s"),
)


def _disturbance(run: Run, closed_s: float) -> tuple[tuple[float, float] | None, float]:
    """Start and end of the disturbance, and its size in K of the source; None and 0 without one."""
    marks = [e for e in run.events if e.kind == "mark" and e.text == SETPOINT_DISTURBED]
    if not marks:
        return None, 0.0
    times = [e.t_s - closed_s for e in marks]
    end = times[1] if len(times) > 1 else float(run["t_s"][-1]) - closed_s
    return (times[0], end), float(marks[0].data["source_K"])


def _closed_rows(run: Run, mark: Event, start_s: float) -> NDArray[np.intp]:
    """Rows of the samples from a mark to the opening of the loop, or to the end of the run."""
    opened = next(
        (
            e.t_s
            for e in run.events
            if e.kind == "mark" and e.text == SETPOINT_LOOP_OPENED and e.t_s >= mark.t_s
        ),
        np.inf,
    )
    return np.flatnonzero((run["t_s"] > start_s) & (run["t_s"] <= opened))


def _segment(run: Run, rows: NDArray[np.intp], t: Array, wanted: Array) -> LoopSegment:
    position, current_A, input_K = (run[name][rows] for name in ("position", "current_A", "input"))
    return LoopSegment(t, wanted, position, current_A, input_K, count_size(run))
