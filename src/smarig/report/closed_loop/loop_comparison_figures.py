"""Overlays of comparable closed loops: those of one reference over time; of one set-point also in the plane."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from smarig.control import SETTLING_BAND_COUNTS, BoundaryPlane
from smarig.core import Array
from smarig.record import Run
from smarig.report.closed_loop.closed_loop_figures import (
    clipped_text,
    disturbance_shading,
    error_half_range,
    tolerance_band,
)
from smarig.report.closed_loop.loop_result import LoopSegment, RegulationResult, TrackingResult
from smarig.report.closed_loop.regulation_plane_figure import B_ELL, boundary_curve
from smarig.report.components.decimate import POINTS, envelope, path
from smarig.report.components.figure import Figure, Panel, Trace, axis, line
from smarig.report.components.html import Html, joined
from smarig.report.components.run_description import display_unit, input_title, output_title, source_label
from smarig.report.components.style import COMPARED, DASHES, GREY, INK
from smarig.report.runs.run_comparison_figures import runs_caption
from smarig.report.runs.time_figures import ROWS, stacked_layout, time_unit

Found = TypeVar("Found", TrackingResult, RegulationResult)
_EMPTY_SEGMENT = LoopSegment(*(np.empty(0) for _ in range(5)), count=0.0)


@dataclass(frozen=True, eq=False)
class ComparedLoop(Generic[Found]):
    """A closed loop in a comparison; ``k`` is the colour index of its run on the page."""

    k: int
    name: str
    run: Run
    result: Found

    @property
    def loop(self) -> LoopSegment:
        """The samples of the loop; none if it was never closed."""
        return self.result.loop or _EMPTY_SEGMENT

    @property
    def count(self) -> float:
        """One count in the run's unit; 0 if the loop was never closed or the count size is unknown."""
        return self.loop.count

    @property
    def drawn(self) -> bool:
        """Whether the loop has enough samples to draw."""
        return self.loop.t_s.size >= 2

    @property
    def lead_s(self) -> float | None:
        """The preview time of its controller, None if the record does not contain it."""
        try:
            return float(self.run.info.settings["lead_s"])
        except (KeyError, TypeError, ValueError):
            return None


ComparedTracking = ComparedLoop[TrackingResult]
ComparedRegulation = ComparedLoop[RegulationResult]


def group_by_reference(loops: Sequence[ComparedTracking]) -> list[list[ComparedTracking]]:
    """Group loops with the same positions at the same times, independent of the reference's name."""
    return _grouped(loops, [(r.t_s, r.position, r.held) for r in (each.result.reference for each in loops)])


def group_by_setpoint(loops: Sequence[ComparedRegulation]) -> list[list[ComparedRegulation]]:
    """Group loops with the same set-point and the same disturbance."""
    return _grouped(
        loops, [(each.result.setpoint_data["setpoint"], each.result.disturbance_K) for each in loops]
    )


def _grouped(
    loops: Sequence[ComparedLoop[Found]], keys: Sequence[Hashable]
) -> list[list[ComparedLoop[Found]]]:
    groups: dict[Hashable, list[ComparedLoop[Found]]] = {}
    for each, key in zip(loops, keys):
        groups.setdefault(key, []).append(each)
    return list(groups.values())


def tracking_overlay_figure(loops: Sequence[ComparedTracking]) -> Figure | None:
    """Overlaid reference, positions, errors and currents; None if nothing was measured."""
    loops = [each for each in loops if each.drawn]
    if not loops:
        return None
    run, counted = loops[0].run, all(each.count for each in loops)
    size, unit = time_unit(max(float(each.loop.t_s[-1]) for each in loops))
    data: list[Trace] = []
    if counted:
        data.append(tolerance_band(_longest_time(loops) / size, -SETTLING_BAND_COUNTS, yaxis="y2"))
    for each in loops:
        loop = each.loop
        columns = (loop.position, _error_trace(each, counted=counted), loop.current_A)
        data += [_time_trace(each, loop.t_s / size, values, row) for row, values in enumerate(columns)]
    data.append(_reference_line(loops[0], size))
    titles = (output_title(run), f"Error ({'counts' if counted else display_unit(run.unit)})", "Current (A)")
    layout = stacked_layout(titles, f"Time since the loop was closed ({unit})", (0.42, 0.34, 0.24))
    words = "Second row: error (measured − reference)."
    if counted:
        settled_errors = [each.loop.error[each.loop.t_s >= each.result.skip_s] for each in loops]
        half_range = error_half_range(np.concatenate(settled_errors))
        layout["yaxis2"]["range"] = [-half_range, half_range]
        words = f"Second row: error (measured − reference) in counts, with a band of ± {SETTLING_BAND_COUNTS:g} counts."
        words += clipped_text(np.concatenate([each.loop.error for each in loops]), half_range)
    return Figure(
        [Panel(data, layout, 680)],
        f"Closed loops along reference {loops[0].result.reference.name}, overlaid.",
        [words, _runs_text(loops)],
        source_label(*(each.run for each in loops)),
    )


def regulation_overlay_figure(loops: Sequence[ComparedRegulation]) -> Figure | None:
    """|measured − set-point| since each loop was closed, and the control input; None if none was closed."""
    loops = [each for each in loops if each.drawn]
    if not loops:
        return None
    run, counted = loops[0].run, all(each.count for each in loops)
    size, unit = time_unit(float(_longest_time(loops)[-1]))
    errors = [np.abs(_error_trace(each, counted=counted)) for each in loops]
    all_errors = np.concatenate(errors)
    shown = [(each.result.transient or 0.0) / (each.count or 1.0) for each in loops]
    half_range = error_half_range(all_errors, max(shown)) if counted else 1.05 * float(np.nanmax(all_errors))
    data: list[Trace] = [tolerance_band(_longest_time(loops) / size, 0.0)] if counted else []
    known = [each.result.disturbance_s for each in loops if each.result.disturbance_s is not None]
    disturbances = dict.fromkeys((round(on), round(off)) for on, off in known)
    data += [
        disturbance_shading(on / size, off / size, 0.0, half_range, showlegend=k == 0)
        for k, (on, off) in enumerate(disturbances)
    ]
    for each, error in zip(loops, errors):
        t, input_K = each.loop.t_s / size, each.loop.input_K
        data += [_time_trace(each, t, error, 0), _time_trace(each, t, input_K, 1)]
    what = f"|measured − set-point| ({'counts' if counted else display_unit(run.unit)})"
    titles = (what, input_title(run))
    layout = stacked_layout(titles, f"Time since the loop was closed ({unit})", (0.62, 0.38))
    layout["yaxis"]["range"] = [0.0, half_range]
    return Figure(
        [Panel(data, layout, 560)],
        "Set-point regulation in closed loop, overlaid.",
        [
            "Each time axis starts when the loop is closed.",
            "Shaded: the disturbance, added to the control input." if disturbances else "",
            clipped_text(all_errors, half_range).strip() if counted else "",
            _runs_text(loops),
        ],
        source_label(*(each.run for each in loops)),
    )


def preisach_plane_figure(loops: Sequence[ComparedRegulation]) -> Figure | None:
    """The states in which the loops were closed, and the output paths from there (Figs. 8.5 and 8.6)."""
    loops = [each for each in loops if each.drawn]
    if not loops:
        return None
    run = loops[0].run
    output_paths = [_output_path(each) for each in loops]
    layout = {
        "xaxis": axis(input_title(run)),
        "yaxis": axis(f"Output, model's scale ({display_unit(run.unit)})"),
    }
    return Figure(
        [_boundary_panel(loops), Panel(output_paths, layout, 460)],
        "The states in which the loops were closed, and the paths of output against input from there.",
        [
            joined(
                [
                    "First panel: the boundary when the loop was closed, computed from the temperature predicted from "
                    "the measured current. Relays above a boundary are down, those below are up",
                    *(["; grey: ", B_ELL] if any(_goal_boundary(each) is not None for each in loops) else []),
                    ". Second panel: output against input in closed loop (thesis, Figs. 8.5 and 8.6).",
                ]
            ),
            _runs_text(loops),
        ],
        source_label(*(each.run for each in loops)),
        440,
    )


def _boundary_panel(loops: Sequence[ComparedRegulation]) -> Panel:
    low = min(float(each.result.setpoint_data["lower_K"]) for each in loops)
    high = max(float(each.result.setpoint_data["upper_K"]) for each in loops)
    data = [line([low, high], [low, high], "α = β", GREY, width=1, hoverinfo="skip", showlegend=False)]
    ell = next(filter(None, map(_goal_boundary, loops)), None)
    if ell is not None:
        plane = BoundaryPlane(low, high)
        target_boundary = boundary_curve(plane.points(plane.target_boundary(ell)))
        data.append(line(*target_boundary, "B_ℓ, α = 2ℓ − β", GREY, width=4, opacity=0.5))
    data += [_line(each, *boundary_curve(each.result.boundary), width=1.8) for each in loops]
    unit = loops[0].run.input_unit
    layout = {
        "xaxis": axis(f"β ({unit})", constrain="domain", range=[low, high]),
        "yaxis": axis(f"α ({unit})", scaleanchor="x", constrain="domain", range=[low, high]),
    }
    return Panel(data, layout, 460)


def _goal_boundary(each: ComparedRegulation) -> float | None:
    return each.result.setpoint_data.get("ell_K")


def _output_path(each: ComparedRegulation) -> Trace:
    """Output against input since the loop was closed, on the model's zero, so that all paths start at the set-point."""
    loop = each.loop
    kept = path(loop.input_K, loop.position)
    return _line(each, loop.input_K[kept], loop.position[kept] + each.result.zero)


def _longest_time(loops: Sequence[ComparedLoop]) -> Array:
    """The times of the longest closed loop."""
    return max((each.loop.t_s for each in loops), key=lambda t: float(t[-1]))


def _error_trace(each: ComparedLoop, *, counted: bool) -> Array:
    loop = each.loop
    return loop.error if counted else loop.position - loop.wanted


def _reference_line(each: ComparedTracking, size: float) -> Trace:
    """The reference; the last point of a sequence of steps is its end, not a step."""
    reference = each.result.reference
    t, y = np.array(reference.t_s) / size, np.array(reference.position)
    if reference.held:
        t, y = np.repeat(t, 2)[1:-1], np.repeat(y[:-1], 2)
    return line(t, y, "reference", INK, width=1.4, dash="dot", yaxis="y")


def _time_trace(each: ComparedLoop, t: Array, values: Array, row: int) -> Trace:
    kept = envelope(values, POINTS)
    where = {"yaxis": ROWS[row], "showlegend": row == 0, "legendgroup": each.name}
    return _line(each, t[kept], values[kept], **where)


def _line(each: ComparedLoop, x: Any, y: Any, **more: Any) -> Trace:
    return line(x, y, each.name, COMPARED[each.k], dash=DASHES[each.k], **({"width": 1.3} | more))


def _runs_text(loops: Sequence[ComparedLoop]) -> Html:
    return runs_caption([(COMPARED[each.k], each.name, each.run) for each in loops])
