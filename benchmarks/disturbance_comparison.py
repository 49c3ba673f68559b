"""Figs 8.5 and 8.6 as numbers: the cost of a disturbance at B_ℓ and at other states with the same output.

The control input is disturbed by ±d. The correction is computed in two senses:

* the *output* is brought back by the least monotone move. A rise that is undone by a fall takes another branch, but
  stops at y_d. The largest |y − y_d| is that of the disturbance, and again that at the end of the pulse;
* the *state* is brought back ("the area which must be swept to recover the initial boundary", Fig. 8.5; "to return to
  the original point", Fig. 8.6), so that the next disturbance finds the same state. B_ℓ is recovered by an oscillation
  that decays from ±d. A state of an outer branch that was pushed forwards is recovered only through the saturation it
  left.

``swing`` is the largest distance of the input from its initial value. B_o is the state with that output on
an outer branch: rising from negative saturation (ascending), or falling from positive saturation
(descending). The computation is quasi-static, without time, lag and controller; ``regulation`` includes
these.
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
_SAMPLES_PER_MOVE = 16  # points along a move, in case the output turns on the way


@dataclass(frozen=True)
class DisturbanceCost:
    """The cost of one disturbance: largest |y − y_d| of the push, of the whole pulse and of the recovery;
    swings.

    ``push`` and ``pulse`` belong to the correction of the output (``swing``), ``recovery`` to that of the
    state (``recovery_swing``). Outputs and inputs in the model's units.
    """

    push: float
    pulse: float
    swing: float
    recovery: float
    recovery_swing: float

    def worse(self, other: "DisturbanceCost") -> "DisturbanceCost":
        """The worse of two costs in each figure."""
        own_values, other_values = (tuple(vars(c).values()) for c in (self, other))
        return DisturbanceCost(*map(max, own_values, other_values))


@dataclass(frozen=True)
class DisturbanceComparison:
    """One set-point: the rest input of each kind of state, and its costs for −d, +d and the worse of both."""

    setpoint: float
    rests: dict[StateKind, float]
    falling: dict[StateKind, DisturbanceCost]
    rising: dict[StateKind, DisturbanceCost]

    @property
    def worst(self) -> dict[StateKind, DisturbanceCost]:
        """The worse of both signs."""
        return {kind: self.falling[kind].worse(self.rising[kind]) for kind in STATE_KINDS}

    def ratio(self, figure: str, kind: StateKind) -> float:
        """The figure of B_ℓ divided by that of B_o with the same output."""
        return getattr(self.worst["diagonal"], figure) / getattr(self.worst[kind], figure)


def setpoints(hysteresis: Everett, n: int = 20) -> list[float]:
    """n outputs spread evenly over [y₋, y₊], without the ends."""
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
    """B_ℓ with ψ(ℓ) = y, or the state with output y on an outer branch."""
    operator = Preisach(hysteresis, "positive" if kind == "descending" else "negative")
    if kind == "diagonal":
        operator.go_to_diagonal(float((psi or Psi(hysteresis)).right_inverse(y)))
    else:
        operator.step(operator.inverse(y))
    return operator.state


def disturbance_cost(hysteresis: Everett, state: State, kind: StateKind, push: float) -> DisturbanceCost:
    """The cost of a signed disturbance of the input at a state of this kind."""
    operator, target = Preisach(hysteresis, state), state.y
    first = _largest_deviation(operator, state.u + push, target)
    pushed = operator.state
    corrected = operator.inverse(target)
    operator.step(corrected)
    second = _largest_deviation(
        operator, corrected - push, target
    )  # the end of the pulse disturbs the control input in the other direction
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
    """Move to u; returns the largest |y − y_d| on the way, without the start."""
    return float(
        np.max(np.abs(operator.follow(np.linspace(operator.u, u, _SAMPLES_PER_MOVE + 1)[1:]) - target))
    )


def _recovery_inputs(hysteresis: Everett, state: State, kind: StateKind, push: float) -> list[float]:
    """Inputs that restore the boundary before the disturbance (B_ℓ: as closely as the cycles allow)."""
    u = state.u
    if kind == "diagonal":
        sides = [(-1) ** (k + 1) for k in range(2 * RECOVERY_CYCLES)]
        return [u + side * push * (1 - k / (2 * RECOVERY_CYCLES)) for k, side in enumerate(sides)] + [u]
    forwards = (push > 0) == (kind == "ascending")
    saturation = hysteresis.lower if kind == "ascending" else hysteresis.upper
    return [saturation, u] if forwards else [u]
