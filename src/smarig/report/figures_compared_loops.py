"""Closed loops over each other: along one reference in time; at one set-point in time, in the plane, over the input.

Knows what loops did; refuses to know controllers and models.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.control.regulation.plane import Plane
from smarig.control.tracking.measures import WITHIN_COUNTS
from smarig.report.compared_loops import ComparedLoop, RegulatedLoop, TrackedLoop
from smarig.report.conditions import exact_unit, input_title, label_of, output_title
from smarig.report.decimate import POINTS, envelope, path
from smarig.report.figure import Figure, Panel, Trace, axis, line
from smarig.report.figures_comparison import places_of
from smarig.report.figures_loop import ROWS, band, cut_words, error_reach, shaded, stacked
from smarig.report.figures_regulation import B_ELL, boundary_curve
from smarig.report.figures_time import time_unit
from smarig.report.html import Html, joined
from smarig.report.style import COMPARED, DASHES, GREY, INK

Array = NDArray[np.float64]


def tracked_over_time(loops: Sequence[TrackedLoop]) -> Figure | None:
    """Wanted and measured positions, errors and currents over each other; None where nothing was measured."""
    loops = [each for each in loops if each.drawn]
    if not loops:
        return None
    run, counted = loops[0].run, all(each.count for each in loops)
    size, unit = time_unit(max(float(each.loop.t_s[-1]) for each in loops))
    data: list[Trace] = []
    if counted:
        data.append(band(_longest(loops) / size, -WITHIN_COUNTS, yaxis="y2"))
    for each in loops:
        loop = each.loop
        columns = (loop.position, _error(each, counted=counted), loop.current_A)
        data += [_timed(each, loop.t_s / size, values, row) for row, values in enumerate(columns)]
    data.append(_wanted(loops[0], size))
    titles = (output_title(run), f"Error ({'counts' if counted else exact_unit(run.unit)})", "Current (A)")
    layout = stacked(titles, (0.42, 0.34, 0.24), f"Time since the loop was closed ({unit})")
    words = "Error: measured less wanted."
    if counted:
        judged = [each.loop.error[each.loop.t_s >= each.found.skip_s] for each in loops]
        reach = error_reach(np.concatenate(judged))
        layout["yaxis2"]["range"] = [-reach, reach]
        words = f"Error: measured less wanted, in encoder counts; band: ± {WITHIN_COUNTS:g} counts."
        words += cut_words(np.concatenate([each.loop.error for each in loops]), reach)
    return Figure(
        [Panel(data, layout, 680)],
        f"Closed loops along {loops[0].found.reference.name} over each other.",
        [words, _places(loops)],
        label_of(*(each.run for each in loops)),
    )


def held_over_time(loops: Sequence[RegulatedLoop]) -> Figure | None:
    """|measured − set-point| since each loop was closed, and the control; None where none was closed."""
    loops = [each for each in loops if each.drawn]
    if not loops:
        return None
    run, counted = loops[0].run, all(each.count for each in loops)
    size, unit = time_unit(float(_longest(loops)[-1]))
    errors = [np.abs(_error(each, counted=counted)) for each in loops]
    everything = np.concatenate(errors)
    shown = [(each.found.transient or 0.0) / (each.count or 1.0) for each in loops]
    reach = error_reach(everything, max(shown)) if counted else 1.05 * float(np.nanmax(everything))
    data: list[Trace] = [band(_longest(loops) / size, 0.0)] if counted else []
    pushes = dict.fromkeys((round(on), round(off)) for on, off in _pulses(loops))
    data += [
        shaded(on / size, off / size, 0.0, reach, showlegend=k == 0) for k, (on, off) in enumerate(pushes)
    ]
    for each, error in zip(loops, errors):
        t, input_K = each.loop.t_s / size, each.loop.input_K
        data += [_timed(each, t, error, 0), _timed(each, t, input_K, 1)]
    what = f"|measured − set-point| ({'counts' if counted else exact_unit(run.unit)})"
    layout = stacked((what, input_title(run)), (0.62, 0.38), f"Time since the loop was closed ({unit})")
    layout["yaxis"]["range"] = [0.0, reach]
    return Figure(
        [Panel(data, layout, 560)],
        "Set-points held in closed loop, over each other.",
        [
            "Every clock begins where its loop was closed.",
            "Tinted: the disturbance, added to the control input." if pushes else "",
            cut_words(everything, reach).strip() if counted else "",
            _places(loops),
        ],
        label_of(*(each.run for each in loops)),
    )


def in_the_plane(loops: Sequence[RegulatedLoop]) -> Figure | None:
    """The states in which the loops were closed, and the way from there (Figs. 8.5 and 8.6)."""
    loops = [each for each in loops if each.drawn]
    if not loops:
        return None
    run = loops[0].run
    way = [_way(each) for each in loops]
    layout = {
        "xaxis": axis(input_title(run)),
        "yaxis": axis(f"Output, model's scale ({exact_unit(run.unit)})"),
    }
    return Figure(
        [_states(loops), Panel(way, layout, 460)],
        "Where the loops were closed in the Preisach plane, and the way through the hysteresis from there on.",
        [
            joined(
                [
                    "First panel: the memory when the loop was closed, along the temperature predicted from the "
                    "measured current; relays above a boundary are down, those below are up",
                    *(["; grey, ", B_ELL] if any(_ell(each) is not None for each in loops) else []),
                    ". Second: output against input in closed loop (thesis, Figs. 8.5 and 8.6).",
                ]
            ),
            _places(loops),
        ],
        label_of(*(each.run for each in loops)),
        440,
    )


def _states(loops: Sequence[RegulatedLoop]) -> Panel:
    low = min(float(each.found.facts["lower_K"]) for each in loops)
    high = max(float(each.found.facts["upper_K"]) for each in loops)
    data = [line([low, high], [low, high], "α = β", GREY, width=1, hoverinfo="skip", showlegend=False)]
    ell = next(filter(None, map(_ell, loops)), None)
    if ell is not None:
        plane = Plane(low, high)
        goal = boundary_curve(plane.points(plane.goal(ell)))
        data.append(line(*goal, "B_ℓ, α = 2ℓ − β", GREY, width=4, opacity=0.5))
    data += [_line(each, *boundary_curve(each.found.boundary), width=1.8) for each in loops]
    unit = loops[0].run.input_unit
    layout = {
        "xaxis": axis(f"β ({unit})", constrain="domain", range=[low, high]),
        "yaxis": axis(f"α ({unit})", scaleanchor="x", constrain="domain", range=[low, high]),
    }
    return Panel(data, layout, 460)


def _ell(each: RegulatedLoop) -> float | None:
    return each.found.facts.get("ell_K")


def _way(each: RegulatedLoop) -> Trace:
    """Output against input since the loop was closed, outputs with the model's zero: all begin at the set-point."""
    loop = each.loop
    kept = path(loop.input_K, loop.position)
    return _line(each, loop.input_K[kept], loop.position[kept] + each.found.zero)


def _pulses(loops: Sequence[RegulatedLoop]) -> list[tuple[float, float]]:
    return [each.found.pulse_s for each in loops if each.found.pulse_s is not None]


def _longest(loops: Sequence[ComparedLoop]) -> Array:
    """The times of the loop that was closed longest."""
    return max((each.loop.t_s for each in loops), key=lambda t: float(t[-1]))


def _error(each: ComparedLoop, *, counted: bool) -> Array:
    loop = each.loop
    return loop.error if counted else loop.position - loop.wanted


def _wanted(each: TrackedLoop, size: float) -> Trace:
    """The reference itself; the last point of steps is their end, and none of them."""
    follow = each.found.reference
    t, y = np.array(follow.t_s) / size, np.array(follow.position)
    if follow.held:
        t, y = np.repeat(t, 2)[1:-1], np.repeat(y[:-1], 2)
    return line(t, y, "wanted", INK, width=1.4, dash="dot", yaxis="y")


def _timed(each: ComparedLoop, t: Array, values: Array, row: int) -> Trace:
    kept = envelope(values, POINTS)
    where = {"yaxis": ROWS[row], "showlegend": row == 0, "legendgroup": each.name}
    return _line(each, t[kept], values[kept], **where)


def _line(each: ComparedLoop, x: Any, y: Any, **more: Any) -> Trace:
    return line(x, y, each.name, COMPARED[each.k], dash=DASHES[each.k], **({"width": 1.3} | more))


def _places(loops: Sequence[ComparedLoop]) -> Html:
    return places_of([(each.k, each.name, each.run) for each in loops])
