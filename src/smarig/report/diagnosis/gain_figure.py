"""The figure of the gain on held-out runs: errors by block, with the base and the extended model."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, root_mean_square
from smarig.diagnosis import AT_FLOOR, PREDICTION_LIMIT, CommandedDiagnosis, HeldOutGain, share_text
from smarig.report.components.figure import (
    AXIS_MARGIN,
    Figure,
    Panel,
    Trace,
    axis,
    dots,
    line,
    log_axis,
    noise_band,
    zero_line,
)
from smarig.report.components.run_description import display_unit, source_label
from smarig.report.components.style import FAINT, GREY, INK, MODEL

_ModelErrors = Sequence[tuple[str, str, Array]]  # name, colour, errors
_MARKER_SHIFT = 0.13  # blocks: distance of the two models' marks
_PALE_OPACITY = 0.35  # opacity
_LOG_AXIS_RATIO = 20  # ratio of sizes from which a linear axis would hide the smaller ones


def gain_figure(gain: HeldOutGain, d: CommandedDiagnosis) -> Figure:
    """Errors at held-out points by block, and the rms of each block, of the base and the extended model."""
    models = [("base model", INK, gain.base_error)]
    if d.extended:
        models.append(("extended model", MODEL, gain.extended_error))
    x = axis("Held-out block", dtick=1 if gain.blocks <= 20 else 5, range=[0.4, gain.blocks + 0.6])
    unit = display_unit(d.timeline.unit)
    return Figure(
        [_error_panel(gain, models, x, unit), _rms_panel(gain, models, x, unit)],
        "Gain on held-out runs: errors of positions by block.",
        _caption(gain, d, unit),
        source_label(*d.timeline.runs),
        440,
    )


def _caption(gain: HeldOutGain, d: CommandedDiagnosis, unit: str) -> list[str]:
    return [
        f"n = {gain.block.size} points in {gain.blocks} blocks; a block is one excursion out and back. The zero and "
        "both densities come from the training runs. First panel: all errors. Second panel: rms of each block. "
        f"Dashed: the {PREDICTION_LIMIT}, {gain.floor:.2g} {unit}: noise and the uncertain density.",
        ""
        if gain.weight is None
        else f"In all rms values and in the {PREDICTION_LIMIT}, a reading has the weight 1/σ² of its prediction.",
        "Pale: readings with more than twice the smallest σ, such as positions during motion."
        if _pale_readings(gain).any()
        else "",
        _gain_text(gain, unit, extended=d.extended),
    ]


def _gain_text(gain: HeldOutGain, unit: str, *, extended: bool) -> str:
    """The gain on held-out data and R in a sentence."""
    if not extended:
        return f"Base model: rms error {gain.base:.3g} {unit}. No effect was added to the model, so there is no gain."
    share, ends = gain.removable_share, gain.interval()
    if share is None:
        return f"Rms error {gain.base:.3g} → {gain.extended:.3g} {unit}. {AT_FLOOR}"
    between = f" (95 %, by resampling blocks: {share_text(ends[0])} to {share_text(ends[1])})" if ends else ""
    return (
        f"Rms error {gain.base:.3g} → {gain.extended:.3g} {unit}. R = {share_text(share)}{between}: the extension "
        f"removes this share of the squared error above the {PREDICTION_LIMIT}."
    )


def _blocks(gain: HeldOutGain) -> Array:
    """The number of each reading's block, from 1 (n,)."""
    return np.unique(gain.block, return_inverse=True)[1].astype(np.float64) + 1


def _error_panel(gain: HeldOutGain, models: _ModelErrors, x: dict[str, Any], unit: str) -> Panel:
    low, high = x["range"]
    data: list[Trace] = [
        noise_band(low, high, 2 * gain.floor, f"± 2 × {PREDICTION_LIMIT}"),
        zero_line(low, high),
    ]
    for (name, colour, error), shift in zip(models, (-_MARKER_SHIFT, _MARKER_SHIFT)):
        data += _error_trace(gain, _blocks(gain) + shift, error, name, colour)
    return Panel(data, {"xaxis": x, "yaxis": axis(f"Measured − model ({unit})")}, 360)


def _rms_panel(gain: HeldOutGain, models: _ModelErrors, x: dict[str, Any], unit: str) -> Panel:
    blocks = np.arange(1.0, gain.blocks + 1)
    sizes = [_block_rms(gain, error) for _, _, error in models]
    data: list[Trace] = [
        line(x["range"], [gain.floor] * 2, PREDICTION_LIMIT, GREY, dash="dash", width=1.4),
        *_block_links(blocks, sizes),
        *(dots(blocks, size, name, colour, size=8) for (name, colour, _), size in zip(models, sizes)),
    ]
    y = _rms_axis(f"rms in the block ({unit})", [*sizes, np.array([gain.floor])])
    return Panel(data, {"xaxis": x, "yaxis": y}, 360)


def _block_rms(gain: HeldOutGain, error: Array) -> Array:
    """Rms of each block, with the weights of the readings."""
    block = _blocks(gain)
    weight = np.ones(error.size) if gain.weight is None else gain.weight
    return np.array([root_mean_square(error[block == b], weight[block == b]) for b in np.unique(block)])


def _error_trace(gain: HeldOutGain, x: Array, error: Array, name: str, colour: str) -> Iterator[Trace]:
    """All errors; those of readings with more than twice the smallest σ are pale."""
    pale = _pale_readings(gain)
    if pale.any():
        yield dots(
            x[pale], error[pale], f"{name}, noisier", colour, size=5, opacity=_PALE_OPACITY, showlegend=False
        )
    yield dots(x[~pale], error[~pale], name, colour, size=5)


def _pale_readings(gain: HeldOutGain) -> NDArray[np.bool_]:
    return np.zeros(gain.block.size, bool) if gain.weight is None else gain.weight < gain.weight.max() / 4


def _rms_axis(title: str, sizes: Sequence[Array]) -> dict[str, Any]:
    """An axis from 0, or a logarithmic axis if the sizes differ by a large factor."""
    every = np.concatenate(sizes)
    if every.min() > 0 and every.max() > _LOG_AXIS_RATIO * every.min():
        return log_axis(title, every.min() / AXIS_MARGIN**2, every.max() * AXIS_MARGIN**2)
    return axis(title, range=[0, AXIS_MARGIN * float(every.max())])


def _block_links(x: Array, sizes: Sequence[Array]) -> list[Trace]:
    """A line from the base to the extended model's rms for each block."""
    gaps = np.full(x.size, np.nan)
    return [
        line(
            np.column_stack([x, x, gaps]).ravel(),
            np.column_stack([a, b, gaps]).ravel(),
            "",
            FAINT,
            showlegend=False,
        )
        for a, b in pairwise(sizes)
    ]
