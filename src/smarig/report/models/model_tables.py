"""Tables of identified models: errors, parameters with intervals, classes of μ, calibrated constants."""

from collections.abc import Mapping

import numpy as np

from smarig.core import spaced
from smarig.identification import Calibration, Identification, PositiveFit, SurfaceChoice, Verification
from smarig.plant import constant_words
from smarig.preisach import surface_forms
from smarig.record import Run
from smarig.report.components.html import Html, joined, paragraph, table, tag, with_subscripts
from smarig.report.components.numbers import interval_text, number, thousands, to_interval
from smarig.report.models.identification_plot_data import density_report_of
from smarig.report.models.plane_figures import density_unit

M_P, M_PC = Html("M<sub>P</sub>"), Html("M<sub>PC</sub>")


def errors_table(
    found: Mapping[str, Identification],
    held_out: Mapping[str, Verification],
    chosen: str,
    choice: SurfaceChoice | None = None,
) -> Html:
    """Errors at the identification points (as Table 5.1) and on held-out data, and negative part of μ, by surface."""
    rows = []
    for name, one in found.items():
        fit = one.model.fit
        held_out_rms = pooled_rms(held_out.get(name))
        row = [f"{fit[key]:.4g}" for key in ("rms", "norm2", "weighted_norm2")]
        row += [f"{held_out_rms:.3g}" if held_out_rms is not None else "—", *_curve_error_cells(name, choice)]
        row.append(f"{fit['points']} on {fit['curves']} curves")
        rows.append((tag("b", f"{name} (chosen)") if name == chosen else name, *row))
    unit = next(iter(found.values())).model.unit
    return table(
        (
            "Surface",
            f"rms ({unit})",
            f"‖e‖₂ ({unit})",
            f"weighted ‖e‖₂ ({unit})",
            f"held-out run, rms ({unit})",
            f"held-out curves, rms ({unit})",
            "negative part of μ",
            "points",
        ),
        rows,
        "Errors of each surface at the identification points as in Table 5.1 (2-norms; major loop weighted twice), on "
        "the held-out run, and on curves held out of the fit"
        + (f" ({choice.curves} curves; 90 % intervals by resampling them). " if choice else ". ")
        + "A table interpolates its points, so only held-out data measure its error. Negative part: ∬μ⁻/∬|μ|.",
    )


def _curve_error_cells(name: str, choice: SurfaceChoice | None) -> tuple[str, str]:
    """rms on held-out curves with its interval, and the negative part of μ."""
    if choice is None or name not in choice.held_out_rms:
        return "—", "—"
    low, high = choice.held_out_interval[name]
    return (
        f"{choice.held_out_rms[name]:.3g} ({low:.3g}…{high:.3g})",
        f"{100 * choice.negative_share[name]:.2f} %",
    )


def pooled_rms(verification: Verification | None) -> float | None:
    """rms over all points of all runs of a verification, if it was made."""
    return verification.rms if verification else None


def parameters_table(found: Identification) -> Html:
    """Fitted parameters with 95 % intervals; key figures of a positive measure; a sentence for tables."""
    if found.positive is not None:
        return _measure_table(found.positive, found)
    if found.fit is None:
        return paragraph(
            f"The {found.surface} model has no fitted parameters: it interpolates the measured points."
        )
    units = _units(found)
    rows = []
    for name, value in zip(found.fit.names, found.fit.values):
        ends = found.fit.intervals[name]
        interval = interval_text(*ends) if np.isfinite(ends).all() else _NOT_DETERMINED
        rows.append((_display_name(name), to_interval(float(value), ends), interval, units.get(name, "")))
    converged = "" if found.fit.converged else " The fit did not converge."
    return table(
        ("Parameter", "Value", "95 % interval", "Unit"),
        rows,
        f"The {found.surface} surface (5.5), {found.fit.points} points on {found.fit.curves} curves. Intervals assume "
        "equal independent noise at every point (residual σ "
        f"{found.fit.sigma:.3g}{spaced(found.model.unit)}).{converged}",
    )


def _measure_table(fit: PositiveFit, found: Identification) -> Html:
    """Key figures of a positive measure: smoothness, degrees of freedom, cost of non-negativity."""
    unit, determined_text = found.model.unit, fit.held_out
    by = "chosen by held-out curves" if fit.by_smoothing else "default: too few curves to choose it by data"
    rows = [
        ("Smoothing λ", number(fit.smoothing), by),
        ("Effective parameters", f"{fit.freedom:.0f}", f"residual σ {fit.sigma:.3g}{spaced(unit)}"),
        ("Cells", str(fit.cells), f"{fit.at_zero} at the bound μ = 0"),
        (
            "Combinations of masses determined by data",
            str(fit.rank),
            f"by smoothness alone: {fit.null_space}",
        ),
        ("Reversible share", f"{100 * fit.reversible_share:.1f} %", "of the output range, on α = β"),
        (
            f"Held-out rms ({unit})",
            number(determined_text.rms),
            f"{number(determined_text.signed_rms)} with masses of any sign",
        ),
        (
            "Scale factor of intervals",
            number(determined_text.spread_factor),
            "so that 90 % of held-out points are in the 90 % intervals",
        ),
    ]
    mirror = " Mirror symmetry was imposed." if fit.symmetric else ""
    return table(
        ("Positive measure", "Value", "Meaning"),
        rows,
        f"The positive measure (§5.6): {fit.points} points, {fit.curves} curves.{mirror}",
    )


def _units(found: Identification) -> dict[str, str]:
    form, y = surface_forms().get(found.surface), found.model.unit
    units = form.units(found.model.input.unit) if form else {}
    return units | {"y_upper": y, "y_lower": y}


def _display_name(name: str) -> str:
    return {"y_upper": "y(u₊, u₊)", "y_lower": "y(u₊, u₋)"}.get(
        name, name.translate(str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉"))
    )


def classes_table(found: Mapping[str, Identification], run: Run) -> Html:
    """Classes of μ as in Table 5.2, with its extremes and the reversible part."""
    rows = []
    for name, one in found.items():
        d = density_report_of(one)
        part = one.positive.reversible_share if one.positive else d.reversible_share
        share = f"{100 * part:.1f} %" if np.isfinite(part) else "—"
        cells = f"; {d.negative_cells} of {d.cells} cells negative" if d.cells else ""
        at = f"({number(d.mu_min_at[0])}, {number(d.mu_min_at[1])})"
        rows.append(
            (
                name,
                "yes" if d.M_PC else "no",
                ("yes" if d.M_P else "no") + cells,
                number(d.mu_min),
                at,
                number(d.mu_max),
                share,
            )
        )
    unit = density_unit(run)
    header = (
        "Surface",
        M_PC,
        M_P,
        f"min μ ({unit})",
        f"at (α, β) ({run.input_unit})",
        f"max μ ({unit})",
        "reversible share",
    )
    narrower = ": in addition μ ≥ 0 everywhere, as passivity and the stability theorems require."
    classes = [M_PC, ": bounded, piecewise continuous. ", M_P, narrower]
    return table(header, rows, joined(["Class of the weighting function (Table 5.2). ", *classes]))


_NOT_DETERMINED = "not determined by these data"


def calibration_table(found: Calibration) -> Html:
    """The calibrated constants of the wire with intervals, and the constants that the data do not determine."""
    rows = [
        (
            with_subscripts(constant_words(name)),
            to_interval(e.value, e.ci95),
            interval_text(*e.ci95, missing="–"),
            e.unit,
            e.source,
            thousands(e.n),
        )
        for name, e in found.parameters.items()
    ]
    rows += [
        (with_subscripts(constant_words(name)), "—", "—", "", why, "")
        for name, why in found.not_available.items()
    ]
    return table(
        ("Constant", "Value", "95 % interval", "Unit", "Source", "n"),
        rows,
        "Calibrated constants of the wire.",
    )
