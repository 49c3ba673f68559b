"""Models beside each other: what each predicts of a run, what each misses, and the density of each."""

from collections.abc import Mapping

import numpy as np

from smarig.identification.density_report import density_report
from smarig.identification.verify import RunVerification
from smarig.record import Run
from smarig.replay import Model
from smarig.report.density_figures import map_panel, per_square
from smarig.report.figure import Figure, Panel, Trace, axis, dots, line
from smarig.report.identification_plot_data import density_of
from smarig.report.numbers import number
from smarig.report.representation_figure import noise_band
from smarig.report.run_description import display_unit, input_title, output_title, run_caption, source_label
from smarig.report.style import COMPARED, GREY, INK, SYMBOLS

_MOST_MARKS = 400


def residuals_figure(name: str, run: Run, verifications: Mapping[str, RunVerification]) -> Figure:
    """A run as measured and as each model says; then model minus measured in order and against the input."""
    one = next(iter(verifications.values()))
    order = np.arange(one.input.size, dtype=float) + 1
    thin = slice(None, None, -(-order.size // _MOST_MARKS))
    data: list[Trace] = [line(order[thin], one.measured[thin], "measured", INK, width=1.2)]
    for k, (model, each) in enumerate(verifications.items()):
        data.append(dots(order[thin], each.predicted[thin], model, COMPARED[k], symbol=SYMBOLS[k], size=7))
    x_title = "Settled point, in order of measurement"
    first = {"xaxis": axis(x_title), "yaxis": axis(output_title(run))}
    unit, floor = display_unit(run.unit), one.noise_floor
    sizes = "; ".join(
        f"{m}: rms {number(e.settled.rms)} {unit}, n = {e.settled.n}" for m, e in verifications.items()
    )
    fitted = {m: e.offset for m, e in verifications.items() if e.offset_kind == "fitted"}
    zero = ", ".join(f"{m} {number(offset)} {unit}" for m, offset in fitted.items())
    return Figure(
        [
            Panel(data, first, 380, wide=True),
            _residual_panel(verifications, order, x_title, unit, floor),
            _residual_panel(verifications, one.input, input_title(run), unit, floor),
        ],
        f"{name} as each model predicts it.",
        [
            f"Then model minus measured. {sizes}.",
            f"Band: ± 2 σ of the noise floor, σ = {number(floor)} {unit}."
            if floor
            else "The noise floor is unknown.",
            f"The encoder's zero is not known, so one additive offset each was fitted: {zero}."
            if fitted
            else "",
            f"One point in {thin.step} is drawn in the first panel." if thin.step > 1 else "",
            run_caption(run),
        ],
        source_label(run),
        460,
    )


def _residual_panel(
    verifications: Mapping[str, RunVerification], x: np.ndarray, title: str, unit: str, floor: float | None
) -> Panel:
    low, high = float(np.min(x)), float(np.max(x))
    data: list[Trace] = [noise_band(low, high, 2 * floor, "± 2 σ of the noise floor")] if floor else []
    data.append(line([low, high], [0, 0], "zero", GREY, width=1, showlegend=False))
    for k, (model, each) in enumerate(verifications.items()):
        error = np.where(each.counted, each.predicted - each.measured, np.nan)
        data.append(dots(x, error, model, COMPARED[k], symbol=SYMBOLS[k], size=6))
    return Panel(data, {"xaxis": axis(title), "yaxis": axis(f"Model − measured ({unit})")}, 360)


def densities_figure(models: Mapping[str, Model]) -> Figure:
    """μ of each model over the half plane, all on one scale of colours."""
    grids = {name: density_of(model.hysteresis) for name, model in models.items()}
    # Of all cells, not of the one that is largest: a table's noisy cell would leave the others white.
    sizes = [np.abs(mu[np.isfinite(mu)]) for _, _, mu in grids.values()]
    top = max(float(np.quantile(size, 0.995)) for size in sizes if size.size)
    panels, least = [], []
    for name, model in models.items():
        report, units = density_report(model.hysteresis), (model.unit, model.input.unit)
        panels.append(map_panel(name, grids[name], report, units, top or None))
        share = f", {report.negative_cells} of {report.cells} cells negative" if report.cells else ""
        least.append(f"{name}: min μ = {number(report.mu_min)} {per_square(*units)}{share}")
    twin = any(model.twin for model in models.values())
    return Figure(
        panels,
        "Weighting function μ(α, β) = ½ ∂²y/∂α∂β of each model, on one scale.",
        [
            "White is zero, red positive, blue negative; colours end at the 99.5 % quantile of the sizes of μ. "
            "Outlined and tinted: where μ < 0, however little; cross: the minimum.",
            "; ".join(least) + ".",
            "; ".join(
                f"{name}: identified from {len(m.provenance)} run(s) of rig {m.rig}"
                for name, m in models.items()
            )
            + ".",
        ],
        "TWIN" if twin else "",
        420,
    )
