"""Maps of the FORC density: over half width and centre, over α and β, its standard error, and other smoothings."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RegularGridInterpolator
from scipy.ndimage import label

from smarig.core import Array, number_from_text
from smarig.identification import SIGNIFICANT, ForcDiagram
from smarig.report.components.figure import Figure, Panel, Trace, axis, cross, heat_map, line, packed
from smarig.report.components.numbers import number
from smarig.report.components.run_description import display_unit, source_label
from smarig.report.components.style import INK, SEQUENCE
from smarig.report.forc.forc_evidence import ForcEvidence
from smarig.report.models.plane_figures import per_square, readable_scale

Mask = NDArray[np.bool_]
_SHARES = (-0.5, -0.2, 0.1, 0.2, 0.4, 0.6, 0.8)  # of the largest density, at the contours
_PLANE_PLACES = 120
_SIZE_PX = 440
_MARGIN = 0.15  # of the extent of the significant area


def diagram_panel(e: ForcEvidence, *, explore: bool = True) -> Panel:
    """The density over half width and centre, with contours, the 95 % boundary, and the peak."""
    return _panel(e, e.diagram, explore=explore)


def planes_figure(e: ForcEvidence) -> Figure:
    """The density over α and β, and its standard error over half width and centre."""
    return Figure(
        [_plane_panel(e), _error_panel(e)],
        "The density in the Preisach plane, and its standard error.",
        [
            "First panel: the same density over the switching inputs α and β, with the same lines inside the "
            "significant area. Second panel: one standard error of the density by the scatter of the readings; drift "
            "and the bias of smoothing are not in it."
        ],
        source_label(e.run),
        460,
    )


def smoothings_figure(e: ForcEvidence) -> Figure | None:
    """The diagram with narrower and wider smoothing; None if the data allow no other."""
    if not e.others:
        return None
    top = _top(e.diagram)
    panels = [
        _panel(e, other, f"smoothing factor {other.smoothing_factor:.1f}", top=top) for other in e.others
    ]
    return Figure(
        panels,
        "The diagram with narrower and wider smoothing.",
        [
            "Same colours and contours as in the diagram. What appears only with the narrower smoothing is noise "
            "unless it lies within its 95 % boundary; what the wider smoothing broadens was narrower than it. Choose a "
            "factor with --smoothing."
        ],
        source_label(e.run),
        460,
    )


def diagram_caption(e: ForcEvidence) -> str:
    """What the diagram shows."""
    peak = "; cross: the peak" if e.diagram.peak else ""
    shares = ", ".join(f"{100 * share:.0f}" for share in _SHARES if share > 0)
    return (
        "Red is positive, blue negative, white zero. Thick line: boundary of the area in which the density differs "
        f"from zero at 95 %; thin lines inside it: {shares} % of the largest density, blue where it is negative{peak}."
    )


def density_words(e: ForcEvidence, value: float, digits: int = 3) -> str:
    """A density with its unit, in the units of the axes."""
    scale = e.scale
    return f"{number(value / scale.factor**2, digits)} {per_square(display_unit(e.run.unit), scale.unit)}"


def _top(diagram: ForcDiagram) -> float:
    """The density at the ends of the colours: nearly the largest significant one, at least that of the peak."""
    shown = np.abs(diagram.mu[_significant(diagram)])
    if not shown.size:
        return float(np.nanmax(np.abs(diagram.mu)))
    return max(float(np.quantile(shown, 0.99)), diagram.peak.mu if diagram.peak else 0.0)


def _panel(
    e: ForcEvidence, d: ForcDiagram, title: str = "", *, top: float | None = None, explore: bool = False
) -> Panel:
    scale, top = e.scale, top or _top(d)
    x, y, kept = d.half_width * scale.factor, d.centre * scale.factor, _significant(d)
    data = [
        _map(x, y, d.mu, top, e),
        *_contours(x, y, np.where(kept, d.mu, np.nan), top),
        _lines(x, y, kept.astype(float), [0.5], INK, 1.6),
    ]
    if d.peak:
        at = d.peak.half_width * scale.factor, d.peak.centre * scale.factor
        data.append(cross(*at, "peak", INK, size=10))
    layout = _diagram_axes(e, d, kept) | {"showlegend": False}
    if title:
        layout["title"] = {"text": title, "font": {"size": 14}, "x": 0.02, "y": 0.97}
    return Panel(data, layout, _SIZE_PX, explore=explore)


def _diagram_axes(e: ForcEvidence, d: ForcDiagram, kept: Mask) -> dict[str, Any]:
    """Axes of equal scale: over the window that the instrument was set to if the peak lies in it.

    Otherwise over the significant area ``kept`` with a margin, or the whole diagram if there is none.
    """
    right, bottom, top = _instrument_window(e, d) or _significant_window(d, kept)
    scale = e.scale
    return {
        "xaxis": axis(
            scale.labelled(scale.half_width),
            range=[0.0, right * scale.factor],
            constrain="domain",
            showgrid=False,
        ),
        "yaxis": axis(
            scale.labelled(scale.centre),
            range=[bottom * scale.factor, top * scale.factor],
            scaleanchor="x",
            constrain="domain",
            showgrid=False,
        ),
    }


def _instrument_window(e: ForcEvidence, d: ForcDiagram) -> tuple[float, float, float] | None:
    """Largest H_c, least and largest H_u of a magnetometer's settings (Hc2, Hb1, Hb2), if the peak lies well inside."""
    try:
        right, bottom, top = (number_from_text(str(e.run.info.forc[key])) for key in ("Hc2", "Hb1", "Hb2"))
    except (KeyError, ValueError):
        return None
    peak, margin = d.peak, 0.1 * (top - bottom)
    if peak is None or not (peak.half_width < right and bottom + margin < peak.centre < top - margin):
        return None
    return right, bottom, top


def _significant_window(d: ForcDiagram, kept: Mask) -> tuple[float, float, float]:
    shown = kept if kept.any() else np.isfinite(d.mu)
    rows, columns = np.flatnonzero(shown.any(axis=1)), np.flatnonzero(shown.any(axis=0))
    margin = _MARGIN * max(rows[-1] - rows[0], columns[-1] - columns[0])
    bottom, top = (float(d.centre[k]) for k in _widened(rows, margin, d.centre.size))
    return float(d.half_width[_widened(columns, margin, d.half_width.size)[1]]), bottom, top


def _widened(places: NDArray[np.intp], margin: float, size: int) -> tuple[int, int]:
    return max(0, int(places[0] - margin)), min(size - 1, int(places[-1] + margin))


def _map(x: Array, y: Array, mu: Array, top: float, e: ForcEvidence) -> Trace:
    scale = e.scale
    unit = per_square(display_unit(e.run.unit), scale.unit)
    size, words = readable_scale(top / scale.factor**2, unit)
    shown = mu / scale.factor**2 / size
    limit = top / scale.factor**2 / size
    hover = f"%{{x:.4g}}, %{{y:.4g}}<br>{scale.density} %{{z:.3g}}"
    return heat_map(x, y, shown, (-limit, limit), f"{scale.density} ({words})", hover)


def _contours(x: Array, y: Array, mu: Array, top: float) -> list[Trace]:
    """Lines of constant share of the largest density, the negative ones paler."""
    lines = []
    for positive, colour in ((True, INK), (False, "#2166ac")):
        levels = [share for share in _SHARES if (share > 0) is positive]
        lines.append(_lines(x, y, mu / top, levels, colour, 0.6))
    return lines


def _lines(x: Array, y: Array, z: Array, levels: list[float], colour: str, width: float) -> Trace:
    step = levels[1] - levels[0] if len(levels) > 1 else 1.0
    return {
        "type": "contour",
        "x": packed(x),
        "y": packed(y),
        "z": packed(z, single=True),
        "contours": {
            "levels": levels,
            "start": levels[0],
            "end": levels[-1],
            "size": step,
            "coloring": "none",
        },
        "line": {"color": colour, "width": width},
        "showscale": False,
        "hoverinfo": "skip",
    }


def _significant(d: ForcDiagram) -> Mask:
    """The significant area (m, n) without islands smaller than the regression's neighbourhood."""
    known = np.isfinite(d.significance)
    mask = known & (d.significance > SIGNIFICANT)
    areas = np.zeros(mask.shape, dtype=np.int64)
    label(mask, output=areas)
    least = known.sum() * (d.estimate.nearest or 1) / max(d.points, 1)
    return mask & (np.bincount(areas.ravel())[areas] >= least)


def _plane_panel(e: ForcEvidence) -> Panel:
    """The diagram turned into the (α, β) plane, with linear interpolation."""
    d, scale = e.diagram, e.scale
    inputs = np.linspace(
        float(d.centre[0] - d.half_width[-1]), float(d.centre[-1] + d.half_width[-1]), 2 * _PLANE_PLACES
    )
    beta, alpha = np.meshgrid(inputs, inputs)
    at = np.stack([(alpha + beta) / 2, (alpha - beta) / 2], axis=-1)
    mu = RegularGridInterpolator((d.centre, d.half_width), d.mu, bounds_error=False)(at)
    nearest = RegularGridInterpolator(
        (d.centre, d.half_width),
        _significant(d).astype(float),
        method="nearest",
        bounds_error=False,
        fill_value=0,
    )
    significant, known = nearest(at) > 0, np.isfinite(mu)
    rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    cut = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    mu, significant = mu[cut], significant[cut]
    x, y = (inputs[ends[0] : ends[-1] + 1] * scale.factor for ends in (columns, rows))
    top = _top(d)
    low, high = max(x[0], y[0]), min(x[-1], y[-1])
    data = [
        _map(x, y, mu, top, e),
        *_contours(x, y, np.where(significant, mu, np.nan), top),
        line([low, high], [low, high], "α = β", INK, width=1, hoverinfo="skip"),
    ]
    layout = {
        "xaxis": axis(
            scale.labelled("Reversal field β" if e.magnetic else "β"), constrain="domain", showgrid=False
        ),
        "yaxis": axis(
            scale.labelled("Field α" if e.magnetic else "α"),
            scaleanchor="x",
            constrain="domain",
            showgrid=False,
        ),
        "showlegend": False,
    }
    return Panel(data, layout, _SIZE_PX)


def _error_panel(e: ForcEvidence) -> Panel:
    d, scale = e.diagram, e.scale
    se = d.se / scale.factor**2
    top = float(np.nanquantile(se, 0.98))
    size, unit = readable_scale(top, per_square(display_unit(e.run.unit), scale.unit))
    x, y, words = (
        d.half_width * scale.factor,
        d.centre * scale.factor,
        f"standard error of {scale.density} ({unit})",
    )
    data = [heat_map(x, y, se / size, (0.0, top / size), words, "%{x:.4g}, %{y:.4g}<br>%{z:.3g}", SEQUENCE)]
    layout = _diagram_axes(e, d, np.isfinite(d.mu)) | {"showlegend": False}
    return Panel(data, layout, _SIZE_PX)
