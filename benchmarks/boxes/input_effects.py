"""Effects between the wire's temperature and the hysteresis input, each with its own equation.

``hysteresis_input(u, share, now)`` is the input if the relays end this step at a share (floats or arrays),
since the feedback acts within the step. ``finish_step`` receives the end of the step.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from benchmarks.boxes.kinetic_hysteresis import BoxHysteresis

_REVERSAL_K = 0.5  # smaller turns of the temperature are noise


@dataclass(slots=True)
class StepState:
    """The present step: its end and length, the steady temperature of its current, the relays at its start.

    ``share`` of relays on, ``travel`` in strokes so far; a full cycle counts two.
    """

    t_s: float = 0.0
    dt_s: float = 0.0
    source_K: float = 0.0
    share: float = 0.0
    travel: float = 0.0


class InputEffect(Protocol):
    """An effect on the hysteresis input."""

    def hysteresis_input(self, u: Any, share: Any, now: StepState, /) -> Any:
        """The hysteresis input at a share of relays that are on."""

    def finish_step(self, u: float, share: float, now: StepState, /) -> None:
        """Store the end of the step."""


class AccommodationEffect:
    """The centre of the loops follows the state: dz = |dξ|/l (ξ − z), solved along the straight path of ξ."""

    def __init__(self, p: dict[str, float], start: float) -> None:
        self._shift, self._strokes, self._start, self._z = p["shift_K"], p["strokes"], start, start

    def _follower(self, share: Any, now: StepState) -> Any:
        change = share - now.share
        lag = np.sign(change) * self._strokes
        return share - lag + (self._z - now.share + lag) * np.exp(-np.abs(change) / self._strokes)

    def hysteresis_input(self, u: Any, share: Any, now: StepState) -> Any:
        return u + self._shift * (self._follower(share, now) - self._start)

    def finish_step(self, _u: float, share: float, now: StepState) -> None:
        self._z = float(self._follower(share, now))


class FrictionEffect:
    """Play: the hysteresis input stays constant until the temperature has moved by half its width."""

    def __init__(self, p: dict[str, float]) -> None:
        self._half, self._held = p["half_width_K"], 0.0

    def hysteresis_input(self, u: Any, _share: Any, _now: StepState) -> Any:
        return np.minimum(np.maximum(self._held, u - self._half), u + self._half)

    def finish_step(self, u: float, share: float, now: StepState) -> None:
        self._held = float(self.hysteresis_input(u, share, now))


class _SlowMass:
    """A mass that follows the steady temperature: ds/dt = (u_∞ − s)/τ, by the trapezium rule."""

    def __init__(self, p: dict[str, float]) -> None:
        self._share, self._tau_s, self._mass_K = p["share_percent"] / 100, p["time_constant_s"], 0.0

    def _next(self, now: StepState) -> float:
        half = now.dt_s / (2 * self._tau_s)
        return (self._mass_K * (1 - half) + 2 * half * now.source_K) / (1 + half)

    def finish_step(self, _u: float, _share: float, now: StepState) -> None:
        self._mass_K = self._next(now)


class SettlingEffect(_SlowMass):
    """A share of the hysteresis input comes from the slow mass."""

    def hysteresis_input(self, u: Any, _share: Any, now: StepState) -> Any:
        return (1 - self._share) * u + self._share * self._next(now)


class CrossTalkEffect(_SlowMass):
    """Each wire heats the other with a delay: the difference loses a share of the plumes' difference."""

    def hysteresis_input(self, u: Any, _share: Any, now: StepState) -> Any:
        return u - self._share * self._next(now)


class FatigueEffect:
    """Thresholds drift with the number of full cycles: T − B (1 − e^(−N/N₀))."""

    def __init__(self, p: dict[str, float]) -> None:
        self._shift, self._cycles = p["shift_K"], p["cycles"]

    def hysteresis_input(self, u: Any, share: Any, now: StepState) -> Any:
        cycles = (now.travel + np.abs(share - now.share)) / 2
        return u - self._shift * (1 - np.exp(-cycles / self._cycles))

    def finish_step(self, _u: float, _share: float, _now: StepState) -> None:
        """Nothing to store: travel is counted elsewhere."""


class StressEffect:
    """A spring: T − S (ξ − ξ₀)."""

    def __init__(self, p: dict[str, float], middle: float) -> None:
        self._shift, self._middle = p["shift_K"], middle

    def hysteresis_input(self, u: Any, share: Any, _now: StepState) -> Any:
        return u - self._shift * (share - self._middle)

    def finish_step(self, _u: float, _share: float, _now: StepState) -> None:
        """Nothing to store: a spring has no memory."""


class ArrestMemoryEffect:
    """A heating halts where an earlier one was arrested: T − S e^(−((T − T_a)/w)²) until T_a is passed."""

    def __init__(self, p: dict[str, float], complete_K: float) -> None:
        self._width = p["width_K"]
        steepest = self._width * math.sqrt(math.e / 2)  # with more, the input would fall as the wire warms
        self._retard = min(p["retard_K"], 0.8 * steepest)
        self._complete = complete_K - 3 * self._width
        self._heating, self._turn, self._held, self._arrest = True, -math.inf, 0.0, -math.inf

    def _is_heating(self, u: Any) -> Any:
        return u >= self._turn - _REVERSAL_K if self._heating else u > self._turn + _REVERSAL_K

    def hysteresis_input(self, u: Any, _share: Any, _now: StepState) -> Any:
        near = (u - self._arrest) / self._width
        halted = u - self._retard * np.where(near <= 3, np.exp(-np.minimum(near**2, 700.0)), 0.0)
        return np.where(self._is_heating(u), halted, np.minimum(self._held, u))

    def finish_step(self, u: float, share: float, now: StepState) -> None:
        hysteresis_input, heating = float(self.hysteresis_input(u, share, now)), bool(self._is_heating(u))
        if self._heating and not heating:  # a peak: complete, or an arrest
            self._arrest = self._turn if self._turn < self._complete else -math.inf
        if heating != self._heating:
            self._heating, self._turn = heating, u
        self._turn = max(self._turn, u) if heating else min(self._turn, u)
        if heating and u > self._arrest + 3 * self._width:
            self._arrest = -math.inf
        self._held = hysteresis_input


_COUPLED = ("accommodation", "fatigue", "stress_coupling")


def build_input_effects(
    hidden: dict[str, dict[str, float]], hysteresis: BoxHysteresis, start: float, *, two_wire: bool
) -> tuple[list[InputEffect], bool]:
    """The effects in the order of their names, and whether the hysteresis input depends on the relays."""
    makers: dict[str, Callable[[dict[str, float]], InputEffect]] = {
        "accommodation": lambda p: AccommodationEffect(p, start),
        "coulomb_friction": FrictionEffect,
        "cross_talk": CrossTalkEffect,
        "fatigue": FatigueEffect,
        "settling": SettlingEffect,
        "stress_coupling": lambda p: StressEffect(p, 0.5 if two_wire else 0.0),
        "temperature_memory": lambda p: ArrestMemoryEffect(p, hysteresis.upper),
    }
    found = [make(hidden[name]) for name, make in makers.items() if name in hidden]
    return found, any(name in hidden for name in _COUPLED)
