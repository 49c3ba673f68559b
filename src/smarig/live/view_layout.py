"""Arrangement of the views of a rig as plain data: rows, columns, tabs and views."""

from dataclasses import dataclass
from typing import Literal

from smarig.live.display_info import DisplayInfo
from smarig.live.mechanism import camera_of
from smarig.live.plot_axes import Plot

ViewType = Literal["plane", "space", "time", "lanes", "log", "page"]


@dataclass(frozen=True)
class View:
    """One view: its content (``origin`` and everything below) and its kind. ``trails`` remain visible for a
    while."""

    kind: ViewType
    name: str
    origin: str
    bounds: tuple[tuple[float, float], tuple[float, float]] | None = None
    trails: tuple[str, ...] = ()
    legend: bool = False
    range: tuple[float, float] | None = None
    camera: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None


@dataclass(frozen=True)
class Split:
    """Adjacent parts with their shares of the space."""

    arrangement: Literal["rows", "columns", "tabs"]
    parts: tuple["View | Split", ...]
    shares: tuple[float, ...] = ()


def layout(display_info: DisplayInfo, graph: Plot, plane: Plot, models: int) -> Split:
    """The arrangement: the two planes on the left, time series in the middle, the rig and its states on the
    right."""
    label_prefix = f"{display_info.label} · " if display_info.label else ""
    trails = ("measured", "settled", *(f"model_{k}" for k in range(models)))
    hysteresis = View(
        "plane",
        f"{label_prefix}{'Angle' if display_info.unit == 'deg' else 'Position'} against estimated temperature"
        if display_info.actuator
        else f"{label_prefix}Output against input",
        graph.path,
        graph.bounds,
        trails=tuple(f"{graph.inside}/{name}" for name in trails),
    )
    memory = View("plane", f"{label_prefix}Preisach plane: boundary over μ", plane.path, plane.bounds)
    left = Split("rows", (hysteresis, memory), (1, 1))
    return Split(
        "columns",
        (left, _middle(display_info, models, label_prefix), _right(display_info, label_prefix)),
        (10, 10, 8),
    )


def _middle(display_info: DisplayInfo, models: int, label_prefix: str) -> Split:
    unit = display_info.unit or "1"
    views = [
        View(
            "time",
            f"{label_prefix}{'Angle' if unit == 'deg' else 'Position'} ({unit})",
            "position",
            legend=True,
        )
    ]
    if models:
        views.append(View("time", f"Measured − model ({unit})", "residual", legend=models > 1))
    what = (
        f"Estimated temperature ({display_info.input_unit})"
        if display_info.actuator
        else f"Input ({display_info.input_unit})"
    )
    views.append(View("time", what, "temperature"))
    views.append(View("time", "Current (A)", "current", legend=True))
    electric = Split(
        "tabs", (View("time", "Voltage (V)", "voltage"), View("time", "Resistance (Ω)", "resistance"))
    )
    shares = (1.6, *([1.0] if models else []), 1.0, 1.0, 1.0)
    return Split("rows", (*views, electric), shares)


def _right(display_info: DisplayInfo, label_prefix: str) -> Split:
    parts: list[tuple[View | Split, float]] = []
    if display_info.actuator is not None:
        what = "Wires and shaft" if display_info.two_wire else "Wire, pulley and load"
        parts.append(
            (View("space", f"{label_prefix}{what}", "rig", camera=camera_of(display_info.actuator)), 3.2)
        )
    if display_info.settling_rule is not None:
        band = 2.0 * display_info.settling_rule.band_counts
        off = "Settling: difference from the window's mean (counts)"
        parts.append((View("time", off, "settling", legend=True, range=(-band, band)), 1.5))
        parts.append((View("time", "Least time until settled (s)", "countdown"), 1.2))
    parts.append((View("lanes", "Steps and states", "lanes"), 2.3))
    log, about = View("log", "Events and trips", "log"), View("page", f"{label_prefix}About", "about")
    parts.append((Split("tabs", (log, about)), 1.6))
    return Split("rows", tuple(p for p, _ in parts), tuple(s for _, s in parts))
