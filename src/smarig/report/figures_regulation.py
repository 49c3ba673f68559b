"""Set-point regulation in the Preisach plane: ψ with ψʳ of the set-point, B_ℓ wanted, foretold and reached (§8.3)."""

from collections.abc import Sequence

import numpy as np

from smarig.control.regulation.plane import Plane
from smarig.record import Run
from smarig.report.closed_loop import Regulated
from smarig.report.conditions import exact_unit, label_of, place
from smarig.report.figure import Figure, Panel, axis, dots, line
from smarig.report.html import Html, joined
from smarig.report.numbers import number
from smarig.report.style import FIRST, GREY, INK, MODEL, SECOND

B_ELL = Html("B<sub>ℓ</sub>")


def plane_figure(run: Run, found: Regulated) -> Figure:
    """ψ(ℓ) with the set-point, and the boundaries over the plane."""
    return Figure(
        [_psi_panel(run, found), _boundaries(run, found)],
        "ψ(ℓ), and the memory of the wire in the Preisach plane.",
        [_words(run, found), place(run)],
        label_of(run),
        440,
    )


def _words(run: Run, found: Regulated) -> Html:
    facts, unit = found.facts, exact_unit(run.unit)
    if facts.get("ell_K") is None:
        return joined(
            [
                f"The set-point {number(facts['setpoint'], 4)} {unit} was reached on the {facts['start']} branch, at "
                f"rest at {number(facts['rest_K'], 4)} {run.input_unit}. Second panel: blue, the memory along the "
                "temperature predicted from the measured current; relays above it are down, those below are up."
            ]
        )
    share = number(100 * facts["predicted_distance_K2"] / facts["area_K2"])
    reached = (
        ""
        if found.distance_K2 is None
        else f", reached {number(100 * found.distance_K2 / facts['area_K2'])} %"
    )
    return joined(
        [
            f"First panel: ψʳ({number(facts['setpoint'], 4)} {unit}) = {number(facts['ell_K'], 4)} {run.input_unit}, "
            "ψ being the output of ",
            B_ELL,
            " on the model's scale. Second: black, ",
            B_ELL,
            ", dashed; orange, as foretold for the planned currents; blue, along the temperature predicted from the "
            "measured current. Relays above a boundary are down, those below are up. Distance from ",
            B_ELL,
            f", the area between: foretold {share} %{reached} of the plane, after {facts['cycles']:.0f} cycles of "
            f"{number(facts['wave_s'])} s.",
        ]
    )


def _psi_panel(run: Run, found: Regulated) -> Panel:
    facts = found.facts
    ell, psi = np.array(facts["psi_ell_K"], dtype=float), np.array(facts["psi"], dtype=float)
    y, at = float(facts["setpoint"]), facts.get("ell_K")
    data = [line(ell, psi, "ψ(ℓ)", MODEL, width=2)]
    if at is not None:
        thin = {"width": 1, "dash": "dot", "showlegend": False, "hoverinfo": "skip"}
        data.append(line([ell[0], at, at], [y, y, float(psi.min())], "", INK, **thin))
        data.append(dots([at], [y], "set-point and its ψʳ", INK, size=9))
    else:
        data.append(line([ell[0], ell[-1]], [y, y], "set-point", INK, width=1, dash="dot"))
    layout = {
        "xaxis": axis(f"ℓ ({run.input_unit})"),
        "yaxis": axis(f"Output ψ(ℓ), model's scale ({exact_unit(run.unit)})"),
    }
    return Panel(data, layout, 460)


def _boundaries(run: Run, found: Regulated) -> Panel:
    facts = found.facts
    low, high = float(facts["lower_K"]), float(facts["upper_K"])
    data = [
        line([low, high], [low, high], "α = β", GREY, width=1, hoverinfo="skip", showlegend=False),
        line(*boundary_curve(found.boundary), "reached", FIRST, width=5, opacity=0.45),
    ]
    if facts.get("predicted_boundary"):
        data.append(
            line(*boundary_curve(facts["predicted_boundary"]), "foretold", SECOND, width=1.6, dash="dot")
        )
    if facts.get("ell_K") is not None:
        plane = Plane(low, high)
        goal = plane.points(plane.goal(float(facts["ell_K"])))
        data.append(line(*boundary_curve(goal), "wanted, α = 2ℓ − β", INK, width=2.2, dash="7px,5px"))
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
