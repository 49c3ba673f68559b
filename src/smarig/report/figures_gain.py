"""Gain where nothing was fitted: errors at held-out points, block by block, before and after the effects.

Knows nothing of the runs that were learned from.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.diagnose import Diagnosis
from smarig.diagnosis.gain import Gain
from smarig.report.conditions import exact_unit, label_of, sentence
from smarig.report.diagnosed import Array, rig_words, rms
from smarig.report.diagnosis_words import gain_words
from smarig.report.figure import BEYOND, Figure, Panel, Trace, axis, dots, line, log_axis
from smarig.report.figures_representation import band
from smarig.report.style import FAINT, GREY, INK, MODEL

_Models = Sequence[tuple[str, str, Array]]  # name, colour, errors
_BESIDE = 0.13  # blocks: distance of the two models' marks
_PALE = 0.35  # opacity
_FAR_APART = 20  # times: where an axis from 0 would hide the smaller ones


def gain_figure(gain: Gain, d: Diagnosis) -> Figure:
    """Errors at held-out points by block, and the rms of each block, of the base and the extended model."""
    models = [("base model", INK, gain.base_error)]
    if d.extended:
        models.append(("extended model", MODEL, gain.extended_error))
    x = axis("Held-out block", dtick=1 if gain.blocks <= 20 else 5, range=[0.4, gain.blocks + 0.6])
    unit = exact_unit(d.story.unit)
    return Figure(
        [_error_panel(gain, models, x, unit), _size_panel(gain, models, x, unit)],
        "Gain where nothing was fitted: held-out positions by block.",
        _caption(gain, d, unit),
        label_of(*d.story.runs),
        440,
    )


def _caption(gain: Gain, d: Diagnosis, unit: str) -> list[str]:
    return [
        f"n = {gain.block.size} points in {gain.blocks} blocks; a block is one excursion out and back. The zero is "
        "that of the training runs, and both densities are from those runs alone. First panel: every error; second: "
        f"rms of each block. Floor {gain.floor:.2g} {unit}: noise, and what training leaves open of the density.",
        ""
        if gain.weight is None
        else "Each reading counts by how well it can be foretold (1/σ²), in every rms and in the floor.",
        "Pale: readings of more than twice the least σ, such as positions on their way."
        if _pale(gain).any()
        else "",
        gain_words(gain, d),
        sentence("; ".join(rig_words(d)) + ".") if rig_words(d) else "",
    ]


def _blocks(gain: Gain) -> Array:
    """The number of each reading's block, from 1 (n,)."""
    return np.unique(gain.block, return_inverse=True)[1].astype(np.float64) + 1


def _error_panel(gain: Gain, models: _Models, x: dict[str, Any], unit: str) -> Panel:
    data: list[Trace] = [
        band(x["range"][0], x["range"][1], 2 * gain.floor, "± 2 × floor"),
        line(x["range"], [0, 0], "zero", GREY, width=1, showlegend=False),
    ]
    for (name, colour, error), shift in zip(models, (-_BESIDE, _BESIDE)):
        data += _errors(gain, _blocks(gain) + shift, error, name, colour)
    return Panel(data, {"xaxis": x, "yaxis": axis(f"Measured − model ({unit})")}, 360)


def _size_panel(gain: Gain, models: _Models, x: dict[str, Any], unit: str) -> Panel:
    blocks = np.arange(1.0, gain.blocks + 1)
    sizes = [_by_block(gain, error) for _, _, error in models]
    data: list[Trace] = [
        line(x["range"], [gain.floor] * 2, "floor", GREY, dash="dash", width=1.4),
        *_links(blocks, sizes),
        *(dots(blocks, size, name, colour, size=8) for (name, colour, _), size in zip(models, sizes)),
    ]
    y = _size_axis(f"rms in the block ({unit})", [*sizes, np.array([gain.floor])])
    return Panel(data, {"xaxis": x, "yaxis": y}, 360)


def _by_block(gain: Gain, error: Array) -> Array:
    """Rms of each block, as the whole's: every reading by its weight."""
    block = _blocks(gain)
    weight = np.ones(error.size) if gain.weight is None else gain.weight
    return np.array([rms(error[block == b], weight[block == b]) for b in np.unique(block)])


def _errors(gain: Gain, x: Array, error: Array, name: str, colour: str) -> Iterator[Trace]:
    """Every error; those of readings with more than twice the least σ pale."""
    pale = _pale(gain)
    if pale.any():
        yield dots(x[pale], error[pale], f"{name}, noisier", colour, size=5, opacity=_PALE, showlegend=False)
    yield dots(x[~pale], error[~pale], name, colour, size=5)


def _pale(gain: Gain) -> NDArray[np.bool_]:
    return np.zeros(gain.block.size, bool) if gain.weight is None else gain.weight < gain.weight.max() / 4


def _size_axis(title: str, sizes: Sequence[Array]) -> dict[str, Any]:
    """An axis from 0; logarithmic where sizes are many times apart."""
    every = np.concatenate(sizes)
    if every.min() > 0 and every.max() > _FAR_APART * every.min():
        return log_axis(title, every.min() / BEYOND**2, every.max() * BEYOND**2)
    return axis(title, range=[0, BEYOND * float(every.max())])


def _links(x: Array, sizes: Sequence[Array]) -> list[Trace]:
    """A line from before to after, block by block."""
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
