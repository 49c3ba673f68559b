"""``smarig benchmark one_input``: how far one input, T₁ − T₂, describes two antagonist wires (thesis §9.2).

The wires are those of the thermomechanical two-wire rig, at given temperatures, without heating and encoder noise.
Three questions, each over loads of the shaft, pre-strains and amplitudes of the input, in encoder counts:

    warmth       both wires are warmer by some kelvin at the same T₁ − T₂: how far is the shaft from where it was?
    wiping-out   an input returns to an earlier extremum: how far is the shaft from where it was?
    congruency   the same small loop after two histories: how much do its heights differ?

The first asks whether the position is a function of T₁ − T₂ at all, the others whether it is a Preisach operator of it.
For comparison, ``one_wire`` asks the second of a single wire at constant stress: what the kinetics alone do.
"""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.plant import Actuator, Material, antagonist_path, isobaric_loop, shaft_strain

Array = NDArray[np.float64]
ACTUATOR, COUNTS_PER_REV, AMBIENT_DEGC = "thermomechanical_two_wire", 2000, 22.0
LOADS_MPA = (0.0, 25.0, 50.0, 100.0)  # σ₁ − σ₂ by a constant torque on the shaft, which wire 1 lifts
PRE_STRAINS = (0.01, 0.02, 0.03, 0.04)
AMPLITUDES_K = (80.0, 110.0, 150.0)
WARMTHS_K = (1.0, 5.0, 10.0, 20.0, 40.0)
STRESS_MPA = 242.0  # of the cold pair (thesis §5.5.1)
STEP_K = 1.0  # between two points of a path


def run(quick: bool = False) -> dict[str, Any]:
    """``{"actuator", "counts_per_rev", "rows": [{"load_MPa", "torque_Nmm", "pre_strain", "amplitude_K",
    "range_counts", "stress_MPa", "slack_share", "shift_K", "warmth_counts": {K: counts}, "wiping_out_counts",
    "congruency_counts"}], "one_wire": {"stress_MPa", "wiping_out_counts"}}``; counts are the largest. The stress is
    that of wire 1, ``slack_share`` the share of the points at which wire 2 is slack.

    ``shift_K``: how far the stress over the path moves the transformation temperatures (Clausius–Clapeyron).
    """
    actuator = Actuator.named(ACTUATOR)
    shaft = _Shaft(actuator)
    histories = 3 if quick else 20
    rows = [
        _row(shaft.under(load), pre, top, histories)
        for load in LOADS_MPA
        for pre in PRE_STRAINS
        for top in AMPLITUDES_K
    ]
    dice = np.random.default_rng(2)
    alone = [_returns(shaft.alone, top, dice) for top in AMPLITUDES_K for _ in range(histories)]
    one_wire = {"stress_MPa": STRESS_MPA, "wiping_out_counts": _rounded(max(alone))}
    return {"actuator": ACTUATOR, "counts_per_rev": COUNTS_PER_REV, "rows": rows, "one_wire": one_wire}


class _Shaft:
    """Counts of the encoder, and the stress, along the inputs of a path that starts with both wires cold."""

    def __init__(self, actuator: Actuator, load_MPa: float = 0.0) -> None:
        self.actuator, self.load_MPa, self.material = actuator, load_MPa, Material.of(actuator.file)
        radius_mm, length_mm = actuator.file.transmission.radius.value, actuator.file.wire.active_length.value
        self.torque_Nmm = load_MPa * math.pi / 4 * actuator.file.wire.diameter.value**2 * radius_mm
        self._counts = length_mm / (2 * radius_mm) * COUNTS_PER_REV / (2 * math.pi)

    def under(self, load_MPa: float) -> "_Shaft":
        """The same shaft with a torque."""
        return _Shaft(self.actuator, load_MPa)

    def along(
        self, pre_strain: float, corners: list[float], warmth_K: float = 0.0
    ) -> tuple[Array, Array, list[int]]:
        """Counts (n,), smaller stress (n,), and the indices of the corners of a path of T₁ − T₂ from 0."""
        path, at = _path(corners)
        wires_K = np.column_stack([np.maximum(path, 0.0), np.maximum(-path, 0.0)])
        cold = np.zeros((1, 2))  # the pair is assembled cold, and then warmed
        temperatures = AMBIENT_DEGC + np.concatenate([cold, wires_K + warmth_K])
        stress_MPa, strains = antagonist_path(self.material, pre_strain, temperatures, self.load_MPa)
        turned = shaft_strain(strains[1:, 0], strains[1:, 1], pre_strain, self.load_MPa)
        return self._counts * turned, stress_MPa[1:], at

    def alone(self, corners: list[float]) -> Array:
        """Counts (n,) at the corners of a single wire at constant stress, as the other would hold it."""
        path, at = _path(corners)
        strain = isobaric_loop(self.material, STRESS_MPA, AMBIENT_DEGC + np.maximum(path, 0.0))
        return 2 * self._counts * (strain[0] - strain)[at]  # the other wire takes what it gives


def _path(corners: list[float]) -> tuple[Array, list[int]]:
    """Inputs (n,) from 0 through all corners, and the indices of the corners."""
    u, at = [0.0], []
    for a, b in pairwise([0.0, *corners]):
        u += np.linspace(a, b, max(2, math.ceil(abs(b - a) / STEP_K) + 1))[1:].tolist()
        at.append(len(u) - 1)
    return np.array(u), at


def _row(shaft: _Shaft, pre_strain: float, top_K: float, histories: int) -> dict[str, Any]:
    dice = np.random.default_rng(1)
    walks = [_walk(dice, top_K) for _ in range(histories)]
    plain = [shaft.along(pre_strain, walk) for walk in walks]
    stress = np.concatenate([s for _, s, _ in plain])
    shift_K = float(np.ptp(stress)) / shaft.material.austenite_slope
    warmth = {
        f"{w:g}": max(
            float(np.abs(shaft.along(pre_strain, walk, w)[0] - counts).max())
            for walk, (counts, _, _) in zip(walks, plain)
        )
        for w in WARMTHS_K
    }
    return {
        "load_MPa": shaft.load_MPa,
        "torque_Nmm": _rounded(shaft.torque_Nmm),
        "pre_strain": pre_strain,
        "amplitude_K": top_K,
        "range_counts": _rounded(max(float(np.ptp(counts)) for counts, _, _ in plain)),
        "stress_MPa": [_rounded(shaft.load_MPa + float(end)) for end in (stress.min(), stress.max())],
        "slack_share": _rounded(float(np.mean(stress == 0.0))),
        "shift_K": _rounded(shift_K),
        "warmth_counts": {key: _rounded(value) for key, value in warmth.items()},
        "wiping_out_counts": _rounded(
            max(
                _returns(lambda c: _corners(shaft.along(pre_strain, c)), top_K, dice)
                for _ in range(histories)
            )
        ),
        "congruency_counts": _rounded(
            max(_heights(shaft, pre_strain, top_K, dice) for _ in range(histories))
        ),
    }


def _walk(dice: np.random.Generator, top_K: float) -> list[float]:
    """Corners of a path: both ends, then others at random."""
    return [top_K, -top_K, *dice.uniform(-top_K, top_K, 8).tolist(), top_K]


def _corners(found: tuple[Array, Array, list[int]]) -> Array:
    return found[0][found[2]]


def _returns(counts_at: Callable[[list[float]], Array], top_K: float, dice: np.random.Generator) -> float:
    """A path with nested loops: counts by which the shaft misses an earlier extremum when its input is back there."""
    low, high = sorted(dice.uniform(-top_K, top_K, 2).tolist())
    inner = sorted(dice.uniform(low, high, 2).tolist())
    places = counts_at([top_K, -top_K, high, low, inner[1], inner[0], inner[1], low, high])
    return max(
        abs(float(places[7] - places[3])),
        abs(float(places[8] - places[2])),
        abs(float(places[6] - places[4])),
    )


def _heights(shaft: _Shaft, pre_strain: float, top_K: float, dice: np.random.Generator) -> float:
    """One small loop after a history from above and one from below: counts by which its heights differ."""
    low, high = sorted(dice.uniform(-top_K, top_K, 2).tolist())
    heights = []
    for first, second in ((top_K, -top_K), (-top_K, top_K)):
        loop = [low, high, low] if second > 0 else [high, low, high, low]
        counts, _, at = shaft.along(pre_strain, [first, second, *loop])
        heights.append(abs(float(counts[at[-1]] - counts[at[-2]])))
    return abs(heights[0] - heights[1])


def _rounded(value: float) -> float:
    return float(f"{value:.3g}")
