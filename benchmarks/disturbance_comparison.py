"""Figs 8.5 and 8.6 as numbers: what a disturbance costs at B_ℓ, and at other states of the same output.

The control input is pushed by ±d. Two things may then be meant by "corrected":

* the *output* is brought back, by the least monotone move. A rise undone by a fall takes another branch, but stops at
  y_d: the largest |y − y_d| is the push itself, and again when the pulse ends and pushes back;
* the *state* is brought back ("the area which must be swept to recover the initial boundary", Fig. 8.5; "to return to
  the original point", Fig. 8.6), so that the next disturbance finds it as the last one did. B_ℓ is recovered by an
  oscillation that decays from ±d, a state of an outer branch pushed forwards only by way of the saturation it left.

Both are computed; ``swing`` is the farthest the input goes from where it stood. B_o is the state of that output on an
outer branch: rising from negative saturation (ascending), or falling from positive saturation (descending).
Quasi-static: knows no time, no lag and no controller; ``loop.regulate`` is for those.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from smarig.control import Psi
from smarig.preisach import Everett, Preisach, State

StateKind = Literal["diagonal", "ascending", "descending"]
STATE_KINDS: tuple[StateKind, ...] = ("diagonal", "ascending", "descending")
FIGURES = ("push", "pulse", "swing", "recovery", "recovery_swing")
RECOVERY_CYCLES = 8
_SAMPLES_PER_MOVE = 16  # places along a move, should the output turn back on the way


@dataclass(frozen=True)
class DisturbanceCost:
    """What one push costs: largest |y − y_d| of the push, of the whole pulse and of recovering the state; swings.

    ``push`` and ``pulse`` belong to bringing the output back (``swing``), ``recovery`` to bringing the state back
    (``recovery_swing``). Outputs and inputs in the model's units.
    """

    push: float
    pulse: float
    swing: float
    recovery: float
    recovery_swing: float

    def worse(self, other: "DisturbanceCost") -> "DisturbanceCost":
        """The worse of two, figure by figure."""
        own_values, other_values = (tuple(vars(c).values()) for c in (self, other))
        return DisturbanceCost(*map(max, own_values, other_values))


@dataclass(frozen=True)
class DisturbanceComparison:
    """One set-point: where each kind of state rests, and its cost for −d, +d and the worse of both."""

    setpoint: float
    rests: dict[StateKind, float]
    falling: dict[StateKind, DisturbanceCost]
    rising: dict[StateKind, DisturbanceCost]

    @property
    def worst(self) -> dict[StateKind, DisturbanceCost]:
        """The worse of both signs."""
        return {kind: self.falling[kind].worse(self.rising[kind]) for kind in STATE_KINDS}

    def ratio(self, figure: str, kind: StateKind) -> float:
        """B_ℓ's figure over that of the same output's B_o."""
        return getattr(self.worst["diagonal"], figure) / getattr(self.worst[kind], figure)


def setpoints(hysteresis: Everett, n: int = 20) -> list[float]:
    """n outputs spread evenly over [y₋, y₊], the ends left out."""
    span = hysteresis.everett(hysteresis.upper, hysteresis.lower)
    return [hysteresis.y_lower + (k + 0.5) / n * span for k in range(n)]


def disturbance_comparison(
    hysteresis: Everett, setpoint: float, push: float, psi: Psi | None = None
) -> DisturbanceComparison:
    """All three states of an output, disturbed by ±``push`` (in units of the input)."""
    states: dict[StateKind, State] = {
        kind: state_of_output(hysteresis, setpoint, kind, psi) for kind in STATE_KINDS
    }

    def costs(signed: float) -> dict[StateKind, DisturbanceCost]:
        return {kind: disturbance_cost(hysteresis, state, kind, signed) for kind, state in states.items()}

    rests: dict[StateKind, float] = {kind: state.u for kind, state in states.items()}
    return DisturbanceComparison(setpoint, rests, costs(-push), costs(push))


def state_of_output(hysteresis: Everett, y: float, kind: StateKind, psi: Psi | None = None) -> State:
    """B_ℓ with ψ(ℓ) = y, or the state of output y on an outer branch."""
    operator = Preisach(hysteresis, "positive" if kind == "descending" else "negative")
    if kind == "diagonal":
        operator.go_to_diagonal(float((psi or Psi(hysteresis)).right_inverse(y)))
    else:
        operator.step(operator.inverse(y))
    return operator.state


def disturbance_cost(hysteresis: Everett, state: State, kind: StateKind, push: float) -> DisturbanceCost:
    """What a push of the input (signed) costs at a state of this kind."""
    operator, target = Preisach(hysteresis, state), state.y
    first = _largest_deviation(operator, state.u + push, target)
    pushed = operator.state
    corrected = operator.inverse(target)
    operator.step(corrected)
    second = _largest_deviation(
        operator, corrected - push, target
    )  # the pulse ends: the control input is pushed back
    restoring_input = operator.inverse(target)
    reached = [abs(u - state.u) for u in (pushed.u, corrected, corrected - push, restoring_input)]
    recovering = _recovery_inputs(hysteresis, state, kind, push)
    operator.reset(pushed)
    deviations = [_largest_deviation(operator, u, target) for u in recovering]
    return DisturbanceCost(
        first,
        max(first, second),
        max(reached),
        max(first, *deviations),
        max(abs(u - state.u) for u in (pushed.u, *recovering)),
    )


def _largest_deviation(operator: Preisach, u: float, target: float) -> float:
    """Move to u; the largest |y − y_d| on the way, the start left out."""
    return float(
        np.max(np.abs(operator.follow(np.linspace(operator.u, u, _SAMPLES_PER_MOVE + 1)[1:]) - target))
    )


def _recovery_inputs(hysteresis: Everett, state: State, kind: StateKind, push: float) -> list[float]:
    """Inputs that bring the boundary back to where it was before the push (B_ℓ: as near as the cycles allow)."""
    u = state.u
    if kind == "diagonal":
        sides = [(-1) ** (k + 1) for k in range(2 * RECOVERY_CYCLES)]
        return [u + side * push * (1 - k / (2 * RECOVERY_CYCLES)) for k, side in enumerate(sides)] + [u]
    forwards = (push > 0) == (kind == "ascending")
    saturation = hysteresis.lower if kind == "ascending" else hysteresis.upper
    return [saturation, u] if forwards else [u]
