"""What a model misses, as the offset of its input that would make it (K), where the wire is steep enough to tell.

Knows nothing of other channels and of why the model misses it.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.diagnose import Diagnosis
from smarig.report.conditions import exact_unit, label_of
from smarig.report.diagnosed import Array, Replay, models_words, noise_of, place_of, rms, slopes
from smarig.report.figure import Figure, Panel, Trace, dots, line, packed
from smarig.report.numbers import number
from smarig.report.residual_variables import against, laid_out, plainest_position, reaches, upright
from smarig.report.style import GREY

_STEEP = 0.25  # of a steep place's slope: where a residual is worth telling as a temperature


def temperature_figure(replay: Replay) -> Figure | None:
    """Residuals as the offset of the input that would make them, where the wire is steep enough to tell."""
    d = replay.d
    slope = slopes(d)
    steep = slope > _STEEP * float(np.quantile(slope, 0.9))
    if not steep.any() or slope.max() <= 0:
        return None
    u, unit = exact_unit(d.story.runs[0].input_unit), exact_unit(d.story.unit)
    offsets = [replay.missed(told, "settled")[steep] / slope[steep] for told, _, _ in replay.told]
    doubt = 2 * noise_of(d, "settled")[0] / slope[steep]
    reach = reaches([np.abs(offset) + doubt for offset in offsets], 0.0)
    names = dict.fromkeys((plainest_position(d), "time"))
    panels = [
        _offset_panel(
            d,
            name,
            steep,
            (offset, doubt),
            (label, colour),
            upright(f"Equivalent offset ({u})", own_reach, reach),
        )
        for name in names
        if name != "rate"
        for offset, own_reach, (_, label, colour) in zip(offsets, reach, replay.told)
    ]
    sizes = " → ".join(number(rms(offset)) for offset in offsets)
    return Figure(
        panels,
        f"The same as an offset of the input: how many {u} more at the input would make each residual.",
        [
            f"Residual of a settled position over the base model's slope ∂y/∂u to its input, where that is more than "
            f"{100 * _STEEP:.0f} % of its 90 % quantile: {int(steep.sum())} of {steep.size} points, slopes "
            f"{slope[steep].min():.2g} to {slope[steep].max():.2g} {unit}/{u}; "
            f"rms {sizes} {u}{models_words(replay, reach)}.",
            f"Bars: ± 2 σ of a reading over that slope. Noise of the temperature ({_draught(d)} {u}) is not in the "
            "bars. A disturbance of the input would lie on one curve here, but for what the density has taken up.",
            *place_of(d, dotted=True),
        ],
        label_of(*d.story.runs),
        440,
    )


def _draught(d: Diagnosis) -> str:
    critic = d.levels[-1].critique if d.levels else d.first
    return number(critic.refitted.noise.temperature_K, 2)


def _offset_panel(
    d: Diagnosis,
    name: str,
    steep: NDArray[np.bool_],
    offset: tuple[Array, Array],
    style: tuple[str, str],
    y_layout: dict[str, Any],
) -> Panel:
    x, x_axis = against(d, name, "settled")
    ends = [float(x.min()), float(x.max())]
    bars = {"type": "data", "array": packed(offset[1]), "color": GREY, "thickness": 1, "width": 0}
    data: list[Trace] = [
        line(ends, [0, 0], "zero", GREY, width=1, showlegend=False),
        dots(x[steep], offset[0], style[0], style[1], size=5, error_y=bars),
    ]
    return Panel(data, laid_out(d, name, x_axis, y_layout), 340)
