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

from smarig.control.regulation.psi import Psi
from smarig.preisach.everett import Everett
from smarig.preisach.operator import Preisach, State

Kind = Literal["diagonal", "ascending", "descending"]
KINDS: tuple[Kind, ...] = ("diagonal", "ascending", "descending")
FIGURES = ("push", "pulse", "swing", "recovery", "recovery_swing")
RECOVERY_CYCLES = 8
_ALONG = 16  # places along a move, should the output turn back on the way


@dataclass(frozen=True)
class Cost:
    """What one push costs: largest |y − y_d| of the push, of the whole pulse and of recovering the state; swings.

    ``push`` and ``pulse`` belong to bringing the output back (``swing``), ``recovery`` to bringing the state back
    (``recovery_swing``). Outputs and inputs in the model's units.
    """

    push: float
    pulse: float
    swing: float
    recovery: float
    recovery_swing: float

    def worse(self, other: "Cost") -> "Cost":
        """The worse of two, figure by figure."""
        mine, others = (tuple(vars(c).values()) for c in (self, other))
        return Cost(*map(max, mine, others))


@dataclass(frozen=True)
class Compared:
    """One set-point: where each kind of state rests, and its cost for −d, +d and the worse of both."""

    setpoint: float
    rests: dict[Kind, float]
    falling: dict[Kind, Cost]
    rising: dict[Kind, Cost]

    @property
    def worst(self) -> dict[Kind, Cost]:
        """The worse of both signs."""
        return {kind: self.falling[kind].worse(self.rising[kind]) for kind in KINDS}

    def ratio(self, figure: str, kind: Kind) -> float:
        """B_ℓ's figure over that of the same output's B_o."""
        return getattr(self.worst["diagonal"], figure) / getattr(self.worst[kind], figure)


def setpoints(hysteresis: Everett, n: int = 20) -> list[float]:
    """n outputs spread evenly over [y₋, y₊], the ends left out."""
    span = hysteresis.everett(hysteresis.upper, hysteresis.lower)
    return [hysteresis.y_lower + (k + 0.5) / n * span for k in range(n)]


def compared(hysteresis: Everett, setpoint: float, push: float, psi: Psi | None = None) -> Compared:
    """All three states of an output, disturbed by ±``push`` (in units of the input)."""
    states: dict[Kind, State] = {kind: state_of_output(hysteresis, setpoint, kind, psi) for kind in KINDS}

    def costs(signed: float) -> dict[Kind, Cost]:
        return {kind: cost(hysteresis, state, kind, signed) for kind, state in states.items()}

    rests: dict[Kind, float] = {kind: state.u for kind, state in states.items()}
    return Compared(setpoint, rests, costs(-push), costs(push))


def state_of_output(hysteresis: Everett, y: float, kind: Kind, psi: Psi | None = None) -> State:
    """B_ℓ with ψ(ℓ) = y, or the state of output y on an outer branch."""
    operator = Preisach(hysteresis, "positive" if kind == "descending" else "negative")
    if kind == "diagonal":
        operator.go_to_diagonal(float((psi or Psi(hysteresis)).least(y)))
    else:
        operator.step(operator.inverse(y))
    return operator.state


def cost(hysteresis: Everett, state: State, kind: Kind, push: float) -> Cost:
    """What a push of the input (signed) costs at a state of this kind."""
    operator, wanted = Preisach(hysteresis, state), state.y
    first = _moved(operator, state.u + push, wanted)
    pushed = operator.state
    corrected = operator.inverse(wanted)
    operator.step(corrected)
    second = _moved(operator, corrected - push, wanted)  # the pulse ends: the control input is pushed back
    back = operator.inverse(wanted)
    reached = [abs(u - state.u) for u in (pushed.u, corrected, corrected - push, back)]
    recovering = _recovery(hysteresis, state, kind, push)
    operator.reset(pushed)
    deviations = [_moved(operator, u, wanted) for u in recovering]
    return Cost(
        first,
        max(first, second),
        max(reached),
        max(first, *deviations),
        max(abs(u - state.u) for u in (pushed.u, *recovering)),
    )


def _moved(operator: Preisach, u: float, wanted: float) -> float:
    """Move to u; the largest |y − y_d| on the way, the start left out."""
    return float(np.max(np.abs(operator.follow(np.linspace(operator.u, u, _ALONG + 1)[1:]) - wanted)))


def _recovery(hysteresis: Everett, state: State, kind: Kind, push: float) -> list[float]:
    """Inputs that bring the boundary back to where it was before the push (B_ℓ: as near as the cycles allow)."""
    u = state.u
    if kind == "diagonal":
        sides = [(-1) ** (k + 1) for k in range(2 * RECOVERY_CYCLES)]
        return [u + side * push * (1 - k / (2 * RECOVERY_CYCLES)) for k, side in enumerate(sides)] + [u]
    forwards = (push > 0) == (kind == "ascending")
    saturation = hysteresis.lower if kind == "ascending" else hysteresis.upper
    return [saturation, u] if forwards else [u]
