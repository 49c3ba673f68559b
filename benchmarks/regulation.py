"""``smarig benchmark regulation``: §8.3 as numbers for both rigs, on the operator and on the twin.

Set-points cover the output range. A disturbance of ±d is corrected from B_ℓ and from both states of the
outer branches. On the operator this follows ``disturbance_comparison``. On the twin the protocol
``regulate`` runs through runner and guard, with lag, noise, quantisation and a PI controller with a small
gain; deviations there are those of the wire, not of the encoder. ``approach`` compares predicted and reached
distances from B_ℓ, with the right τ and with a wrong one.
"""

from collections.abc import Sequence
from dataclasses import replace
from statistics import median
from typing import Any

import numpy as np

from benchmarks.disturbance_comparison import (
    FIGURES,
    STATE_KINDS,
    DisturbanceComparison,
    StateKind,
    disturbance_comparison,
    disturbance_cost,
    setpoints,
)
from smarig.config import load_rig
from smarig.control import BoundaryPlane, Psi, plan_approach, regulate
from smarig.core import Sample
from smarig.plant import Actuator, Plant
from smarig.preisach import THESIS_SURFACES, Everett, Preisach, thesis_surface
from smarig.protocols import Setup
from smarig.rig import Guard, Twin, TwinSettings
from smarig.runner import CallbackListener, Runner

RIGS = {"one_wire_twin": "one_e", "two_wire_twin": "two_e"}
PUSH = 0.03  # d, as a share of the input range
PUSHES = (0.02, PUSH, 0.05)
SETPOINTS, QUICK_SETPOINTS = 20, 4
QUIET_S, HOLD_S = 60.0, 420.0
STATES = 25  # with random histories, for each set-point
WRONG_TAU = 1.1


def run(quick: bool = False) -> dict[str, Any]:
    """Compare the states on both rigs.

    Returns ``{"push_share", RIG: {"operator", "any_state", "twin", "approach"}, "operator_other_pushes"}``.
    Ratios are the figure of B_ℓ divided by that of B_o, each the worse of both signs.
    """
    n = QUICK_SETPOINTS if quick else SETPOINTS
    found: dict[str, Any] = {"setpoints": n, "push_share": PUSH}
    for rig, name in RIGS.items():
        h = thesis_surface(name)
        found[rig] = {
            "operator": _operator(h, n, PUSH),
            "any_state": _any_state(h, n),
            "twin": _twin(rig, h, n),
            "approach": _approaches(rig, h, 2 if quick else 6),
        }
    found["operator_other_pushes"] = {
        name: {f"{share:g}": _operator(thesis_surface(name), n, share) for share in PUSHES}
        for name in (THESIS_SURFACES[::3] if quick else THESIS_SURFACES)
    }
    return found


def _operator(h: Everett, n: int, share: float) -> dict[str, Any]:
    psi = Psi(h)
    rows = [disturbance_comparison(h, y, share * (h.upper - h.lower), psi) for y in setpoints(h, n)]
    return {
        figure: {kind: _summary([row.ratio(figure, kind) for row in rows]) for kind in STATE_KINDS[1:]}
        | {"lost": _lost(rows, figure), "lost_to_one_sign": _one_sign(rows, figure)}
        for figure in FIGURES
    }


def _summary(ratios: Sequence[float]) -> dict[str, float]:
    return {
        "smaller_from_B_ell": sum(ratio < 1 for ratio in ratios),
        "of": len(ratios),
        "median_ratio": round(median(ratios), 4),
        "worst_ratio": round(max(ratios), 4),
    }


def _lost(rows: Sequence[DisturbanceComparison], figure: str) -> list[dict[str, Any]]:
    """Set-points at which an outer branch is better in the worse of both signs."""
    return [
        {"setpoint": row.setpoint, "kind": kind, "rests": row.rests, "ratio": row.ratio(figure, kind)}
        for row in rows
        for kind in STATE_KINDS[1:]
        if row.ratio(figure, kind) >= 1
    ]


def _one_sign(rows: Sequence[DisturbanceComparison], figure: str) -> dict[str, int]:
    """How often B_o is better for one sign alone: −d after a rise, +d after a fall. Ties do not count."""
    found = {}
    for kind, sign, name in (("ascending", "falling", "-d"), ("descending", "rising", "+d")):
        pairs = [
            (getattr(costs[kind], figure), getattr(costs["diagonal"], figure))
            for costs in (getattr(row, sign) for row in rows)
        ]
        found[f"{kind}, {name}"] = sum(other < (1 - 1e-9) * ours for other, ours in pairs)
    return found


def _any_state(h: Everett, n: int) -> dict[str, Any]:
    """Comparison with states of random histories and the same output: the thesis's 'any', which is not
    proved."""
    rng, push, psi = np.random.default_rng(8), PUSH * (h.upper - h.lower), Psi(h)
    ratios, lost = [], []
    for y in setpoints(h, n):
        here = disturbance_comparison(h, y, push, psi).worst["diagonal"].push
        for _ in range(STATES):
            operator = Preisach(h)
            operator.follow(rng.uniform(h.lower, h.upper, rng.integers(1, 9)))
            operator.step(operator.inverse(y))
            costs = [disturbance_cost(h, operator.state, "ascending", sign * push) for sign in (-1, 1)]
            ratios.append(here / max(c.push for c in costs))
            if ratios[-1] >= 1:
                lost.append({"setpoint": round(y, 4), "rests": round(operator.u, 1), "ratio": ratios[-1]})
    return {**_summary(ratios), "lost": lost}


# --- the twin ------------------------------------------------------------------------------------------


class _TruePosition:
    """The true position of the wire while the loop is closed, separated by the disturbance."""

    def __init__(self, twin: Twin) -> None:
        self.twin, self.quiet, self.disturbed = twin, [], []
        self.current_part: list[float] | None = None

    def sample(self, _s: Sample, step: int | None, _input_K: float) -> None:
        if step is None and self.current_part is not None:
            self.current_part.append(self.twin.specimen.plant.position)

    def event(self, kind: str, _t_s: float) -> None:
        """Store the marks, which come in this order: closed, disturbance on, disturbance off, opened."""
        if kind == "mark":
            self.current_part = self.quiet if self.current_part is None else self.disturbed


def regulate_on_twin(
    rig: str, h: Everett, y: float, start: StateKind, push_K: float, seed: int
) -> dict[str, float]:
    """One run on the twin: the largest deviations from y before and after the disturbance."""
    twin = Twin.named(rig, seed=seed, hysteresis=h)
    truth = _TruePosition(twin)
    marks = iter(range(1000))

    def event(kind: str, t_s: float) -> None:
        if kind == "mark" and next(marks) > 0:  # the first mark announces the loop
            truth.event(kind, t_s)

    runner = Runner(
        Guard(twin, twin.file.limits, twin.actuator),
        twin.position_per_count,
        [CallbackListener(on_sample=truth.sample, on_event=event)],
    )
    runner.run(
        regulate(
            Setup.of(rig),
            hysteresis=h,
            setpoint=y,
            start=start,
            disturbance_K=push_K,
            quiet_s=QUIET_S,
            hold_s=HOLD_S,
        )
    )
    before, after = (np.abs(np.array(part) - y) for part in (truth.quiet, truth.disturbed))
    hold = round((HOLD_S - QUIET_S) / twin.period_s)
    return {
        "at_rest": float(before.max()),
        "transient": float(after[:hold].max()),
        "end": float(after[hold - 100 : hold].mean()),
    }


def _twin(rig: str, h: Everett, n: int) -> dict[str, Any]:
    push_K = PUSH * (h.upper - h.lower)
    rows = []
    for k, y in enumerate(setpoints(h, n)):
        row: dict[str, Any] = {"setpoint": round(y, 4)}
        for kind in STATE_KINDS:
            both = [regulate_on_twin(rig, h, y, kind, sign * push_K, seed=k) for sign in (-1, 1)]
            row[kind] = {name: round(max(one[name] for one in both), 4) for name in both[0]}
        rows.append(row)
    count = Actuator.named(load_rig(rig).actuator).resolution(load_rig(rig).encoder)
    ratios = {
        kind: [row["diagonal"]["transient"] / row[kind]["transient"] for row in rows]
        for kind in STATE_KINDS[1:]
    }
    return {
        **{kind: _summary(values) for kind, values in ratios.items()},
        "smaller_than_both": sum(max(pair) < 1 for pair in zip(*ratios.values())),
        "count": count,
        "rows": rows,
    }


def _approaches(rig: str, h: Everett, n: int) -> list[dict[str, float]]:
    """Predicted and reached distance from B_ℓ, as shares of 2û²; the last with a lag that the plan does not
    include."""
    setup, plane = Setup.of(rig), BoundaryPlane.of(h)
    rows = []
    for share in (np.arange(n) + 0.5) / n:
        ell = h.lower + float(share) * (h.upper - h.lower)
        for within in (0.01, 0.003):
            planned = plan_approach(setup, h, ell, within)
            reached = [_reached(rig, planned.currents_A, plane, ell, f) for f in (1.0, WRONG_TAU)]
            rows.append(
                {
                    "ell_K": round(ell, 2),
                    "within": within,
                    "minutes": round(planned.duration_s / 60, 1),
                    "cycles": planned.cycles,
                    "predicted": planned.share,
                    "closed_form": planned.closed_form / plane.area,
                    "reached": reached[0],
                    "reached_with_wrong_tau": reached[1],
                }
            )
    return rows


def _reached(rig: str, currents_A: Sequence[float], plane: BoundaryPlane, ell: float, tau: float) -> float:
    """The twin's distance from B_ℓ after the currents, with a time constant ``tau`` times that of its file."""
    file = load_rig(rig)
    actuator = Actuator.named(file.actuator)
    wire = actuator.file.wire
    heat = wire.specific_heat.model_copy(update={"value": wire.specific_heat.value * tau})
    slower = actuator.file.model_copy(update={"wire": wire.model_copy(update={"specific_heat": heat})})
    twin = Twin(file, replace(actuator, file=slower), TwinSettings(seed=1))
    for current_A in currents_A:
        twin.step(current_A)
    plant = twin.specimen.plant
    assert isinstance(plant, Plant)  # noqa: S101 - this rig is a twin with an operator
    return plane.distance(plane.state(plant.operator.state), ell) / plane.area
