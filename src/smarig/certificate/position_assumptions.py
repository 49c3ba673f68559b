"""The assumptions of §9.2 about the plant, for a Preisach model: the matched supply rate, zero-state detectability.

Thm 6.4 covers the third assumption, reachability, approximately (``preisach.state_space.reach``).
"""

from dataclasses import dataclass
from typing import Any

from smarig.control import finite, not_negative
from smarig.core import UsageError
from smarig.preisach import Everett, Initial, Preisach, State, bracketed_root
from smarig.theory import boundary_of, distance, work


def supply_while_held(
    hysteresis: Everett, u: float, hold_s: float, b: float, initial: Initial = "anhysteretic"
) -> float:
    """∫(u ẏ − b² y²) dt of a quick move to u that is then held for ``hold_s``; unbounded below for b > 0 and y ≠ 0.

    A hysteresis keeps its output without supply, so it can be dissipative to ⟨u, ẏ⟩ − b²⟨y, y⟩ only for b = 0
    (``certify`` decides that case). Raises UsageError for a negative time and for values that are not finite.

    >>> from smarig.preisach import thesis_surface
    >>> leaky, pure = (supply_while_held(thesis_surface("two_c"), 60.0, 1e6, b=b) for b in (0.1, 0.0))
    >>> leaky < -1e5 < 0 < pure
    True
    """
    finite("u", u)
    finite("b", b)
    not_negative("hold_s", hold_s)
    operator = Preisach(hysteresis, initial)
    supplied = work(hysteresis, operator.state, u)
    return finite("The supply", supplied - b * b * operator.step(u) ** 2 * hold_s)


@dataclass(frozen=True)
class IndistinguishableStates:
    """Two states at u = 0 with equal output, which zero input never distinguishes.

    ``distance`` is the area between their boundaries, input units squared; ``most`` is its maximum, 2û².
    """

    first: State
    second: State
    distance: float
    most: float

    @property
    def text(self) -> str:
        """The consequence, in a sentence."""
        path = " → ".join(f"{u:.4g}" for u in (*self.second.extrema[1:], 0.0))
        return (
            f"Zero-state detectability (§9.2) fails: after saturation, the path {path} gives the output of B*, and "
            "zero "
            f"input keeps both states (distance {100 * self.distance / self.most:.1f} % of 2û²)."
        )

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "turning_points": list(self.second.extrema),
            "output": self.first.y,
            "distance_share": self.distance / self.most,
            "text": self.text,
        }


def indistinguishable_states(hysteresis: Everett) -> IndistinguishableStates:
    """B* and a state reached by +u₊ → −x → 0 with the output of B*: a counterexample to zero-state detectability.

    Raises UsageError for a hysteresis on one side of zero, whose only state at u = 0 is saturation.

    >>> from smarig.preisach import thesis_surface
    >>> indistinguishable_states(thesis_surface("two_c")).distance > 1000.0
    True
    """
    if not hysteresis.lower < 0.0 < hysteresis.upper:
        raise UsageError(
            "The input range is on one side of u = 0, so only one state is possible at zero input."
        )
    operator = Preisach(hysteresis, "anhysteretic")
    first, target = operator.state, operator.y

    def output_difference(x: float) -> float:
        operator.simulate([hysteresis.upper, -x, 0.0])
        return target - operator.y

    output_difference(bracketed_root(output_difference, 0.0, -hysteresis.lower))
    second, bound = operator.state, max(-hysteresis.lower, hysteresis.upper)
    separation = distance(boundary_of(first, hysteresis), boundary_of(second, hysteresis))
    return IndistinguishableStates(first, second, separation, 2 * bound**2)
