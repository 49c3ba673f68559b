"""Set-point regulation in the Preisach plane (§8.3): ψ with ψʳ of the set-point, and B_ℓ as target and as reached."""

from collections.abc import Sequence

import numpy as np

from smarig.control import BoundaryPlane
from smarig.record import Run
from smarig.report.closed_loop.loop_result import RegulationResult
from smarig.report.components.figure import Figure, Panel, axis, dots, line
from smarig.report.components.html import Html, joined
from smarig.report.components.numbers import number
from smarig.report.components.run_description import display_unit, run_caption, source_label
from smarig.report.components.style import FIRST, GREY, INK, MODEL, SECOND

B_ELL = Html("B<sub>ℓ</sub>")


def regulation_plane_figure(run: Run, found: RegulationResult) -> Figure:
    """ψ(ℓ) with the set-point, and the boundaries over the plane."""
    return Figure(
        [_psi_panel(run, found), _boundaries_panel(run, found)],
        "ψ(ℓ), and the state of the wire in the Preisach plane.",
        [_caption(run, found), run_caption(run)],
        source_label(run),
        440,
    )


def _caption(run: Run, found: RegulationResult) -> Html:
    setpoint_data, unit = found.setpoint_data, display_unit(run.unit)
    if setpoint_data.get("ell_K") is None:
        return joined(
            [
                f"The set-point {number(setpoint_data['setpoint'], 4)} {unit} was reached on the "
                f"{setpoint_data['start']} branch at an input of {number(setpoint_data['rest_K'], 4)} "
                f"{run.input_unit}. Second panel: blue, the boundary computed from the temperature predicted from the "
                "measured current. Relays above it are down, those below are up."
            ]
        )
    share = number(100 * setpoint_data["predicted_distance_K2"] / setpoint_data["area_K2"])
    reached = (
        ""
        if found.distance_K2 is None
        else f", reached {number(100 * found.distance_K2 / setpoint_data['area_K2'])} %"
    )
    return joined(
        [
            f"First panel: ψʳ({number(setpoint_data['setpoint'], 4)} {unit}) = "
            f"{number(setpoint_data['ell_K'], 4)} {run.input_unit}, "
            "where ψ is the output of ",
            B_ELL,
            " on the model's scale. Second panel: dashed black, the target ",
            B_ELL,
            "; orange, predicted for the planned currents; blue, computed from the measured current. "
            "Relays above a boundary are down, those below are up. Distance from ",
            B_ELL,
            f" (the area between, as a share of the plane): predicted {share} %{reached}, after "
            f"{setpoint_data['cycles']:.0f} cycles of {number(setpoint_data['wave_s'])} s.",
        ]
    )


def _psi_panel(run: Run, found: RegulationResult) -> Panel:
    setpoint_data = found.setpoint_data
    ell, psi = np.array(setpoint_data["psi_ell_K"], dtype=float), np.array(setpoint_data["psi"], dtype=float)
    y, at = float(setpoint_data["setpoint"]), setpoint_data.get("ell_K")
    data = [line(ell, psi, "ψ(ℓ)", MODEL, width=2)]
    if at is not None:
        thin = {"width": 1, "dash": "dot", "showlegend": False, "hoverinfo": "skip"}
        data.append(line([ell[0], at, at], [y, y, float(psi.min())], "", INK, **thin))
        data.append(dots([at], [y], "set-point and its ψʳ", INK, size=9))
    else:
        data.append(line([ell[0], ell[-1]], [y, y], "set-point", INK, width=1, dash="dot"))
    layout = {
        "xaxis": axis(f"ℓ ({run.input_unit})"),
        "yaxis": axis(f"Output ψ(ℓ), model's scale ({display_unit(run.unit)})"),
    }
    return Panel(data, layout, 460)


def _boundaries_panel(run: Run, found: RegulationResult) -> Panel:
    setpoint_data = found.setpoint_data
    low, high = float(setpoint_data["lower_K"]), float(setpoint_data["upper_K"])
    data = [
        line([low, high], [low, high], "α = β", GREY, width=1, hoverinfo="skip", showlegend=False),
        line(*boundary_curve(found.boundary), "reached", FIRST, width=5, opacity=0.45),
    ]
    if setpoint_data.get("predicted_boundary"):
        data.append(
            line(
                *boundary_curve(setpoint_data["predicted_boundary"]),
                "predicted",
                SECOND,
                width=1.6,
                dash="dot",
            )
        )
    if setpoint_data.get("ell_K") is not None:
        plane = BoundaryPlane(low, high)
        target_boundary = plane.points(plane.target_boundary(float(setpoint_data["ell_K"])))
        data.append(
            line(*boundary_curve(target_boundary), "target, α = 2ℓ − β", INK, width=2.2, dash="7px,5px")
        )
    ends = [low, high]
    layout = {
        "xaxis": axis(f"β ({run.input_unit})", constrain="domain", range=ends),
        "yaxis": axis(f"α ({run.input_unit})", scaleanchor="x", constrain="domain", range=ends),
    }
    return Panel(data, layout, 460)


def boundary_curve(points: Sequence[Sequence[float]]) -> tuple[np.ndarray, np.ndarray]:
    """β and α along a boundary, (k,) each."""
    beta, alpha = np.array([tuple(p) for p in points], dtype=float).T
    return beta, alpha
