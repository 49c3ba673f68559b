"""What stands between the wire's temperature and the one its relays feel; each effect by its own equation.

``felt(u, share, now)`` is what is felt if the relays end this step at a share (floats or arrays): the
feedback is within the step. ``done`` is told how the step ended. Knows neither currents nor positions.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from smarig.benchmark.boxes.relays import Hysteresis

_REVERSAL_K = 0.5  # smaller turns of the temperature are noise


@dataclass(slots=True)
class Now:
    """The step under way: its end and length, the steady temperature of its current, the relays at its start.

    ``share`` that is on, ``travel`` strokes made so far, there and back counting two.
    """

    t_s: float = 0.0
    dt_s: float = 0.0
    source_K: float = 0.0
    share: float = 0.0
    travel: float = 0.0


class Felt(Protocol):
    """An effect on the temperature that is felt."""

    def felt(self, u: Any, share: Any, now: Now, /) -> Any:
        """The temperature felt at a share that is on."""

    def done(self, u: float, share: float, now: Now, /) -> None:
        """The step ended so."""


class Accommodation:
    """The middle of the loops follows the state: dz = |dξ|/l (ξ − z), solved along the straight way of ξ."""

    def __init__(self, p: dict[str, float], start: float) -> None:
        self._shift, self._strokes, self._start, self._z = p["shift_K"], p["strokes"], start, start

    def _follower(self, share: Any, now: Now) -> Any:
        way = share - now.share
        lag = np.sign(way) * self._strokes
        return share - lag + (self._z - now.share + lag) * np.exp(-np.abs(way) / self._strokes)

    def felt(self, u: Any, share: Any, now: Now) -> Any:
        return u + self._shift * (self._follower(share, now) - self._start)

    def done(self, _u: float, share: float, now: Now) -> None:
        self._z = float(self._follower(share, now))


class Friction:
    """Play: what is felt stays until the temperature has moved by half its width."""

    def __init__(self, p: dict[str, float]) -> None:
        self._half, self._held = p["half_width_K"], 0.0

    def felt(self, u: Any, _share: Any, _now: Now) -> Any:
        return np.minimum(np.maximum(self._held, u - self._half), u + self._half)

    def done(self, u: float, share: float, now: Now) -> None:
        self._held = float(self.felt(u, share, now))


class _SlowMass:
    """A mass that follows the steady temperature: ds/dt = (u_∞ − s)/τ, by the trapezium rule."""

    def __init__(self, p: dict[str, float]) -> None:
        self._share, self._tau_s, self._mass_K = p["share_percent"] / 100, p["time_constant_s"], 0.0

    def _next(self, now: Now) -> float:
        half = now.dt_s / (2 * self._tau_s)
        return (self._mass_K * (1 - half) + 2 * half * now.source_K) / (1 + half)

    def done(self, _u: float, _share: float, now: Now) -> None:
        self._mass_K = self._next(now)


class Settling(_SlowMass):
    """A share of what is felt is the slow mass."""

    def felt(self, u: Any, _share: Any, now: Now) -> Any:
        return (1 - self._share) * u + self._share * self._next(now)


class CrossTalk(_SlowMass):
    """Each wire warms the other, late: the difference loses a share of the plumes' difference."""

    def felt(self, u: Any, _share: Any, now: Now) -> Any:
        return u - self._share * self._next(now)


class Fatigue:
    """Thresholds drift with full strokes there and back: T − B (1 − e^(−N/N₀))."""

    def __init__(self, p: dict[str, float]) -> None:
        self._shift, self._cycles = p["shift_K"], p["cycles"]

    def felt(self, u: Any, share: Any, now: Now) -> Any:
        cycles = (now.travel + np.abs(share - now.share)) / 2
        return u - self._shift * (1 - np.exp(-cycles / self._cycles))

    def done(self, _u: float, _share: float, _now: Now) -> None:
        """Nothing to remember: travel is counted elsewhere."""


class Stress:
    """A spring: T − S (ξ − ξ₀)."""

    def __init__(self, p: dict[str, float], middle: float) -> None:
        self._shift, self._middle = p["shift_K"], middle

    def felt(self, u: Any, share: Any, _now: Now) -> Any:
        return u - self._shift * (share - self._middle)

    def done(self, _u: float, _share: float, _now: Now) -> None:
        """A spring has no memory."""


class Arrests:
    """Where a heating was arrested, the next one halts: T − S e^(−((T − T_a)/w)²) until T_a is passed."""

    def __init__(self, p: dict[str, float], complete_K: float) -> None:
        self._width = p["width_K"]
        steepest = self._width * math.sqrt(math.e / 2)  # beyond, what is felt would fall as the wire warms
        self._retard = min(p["retard_K"], 0.8 * steepest)
        self._complete = complete_K - 3 * self._width
        self._heating, self._turn, self._held, self._arrest = True, -math.inf, 0.0, -math.inf

    def _warm(self, u: Any) -> Any:
        return u >= self._turn - _REVERSAL_K if self._heating else u > self._turn + _REVERSAL_K

    def felt(self, u: Any, _share: Any, _now: Now) -> Any:
        near = (u - self._arrest) / self._width
        halted = u - self._retard * np.where(near <= 3, np.exp(-np.minimum(near**2, 700.0)), 0.0)
        return np.where(self._warm(u), halted, np.minimum(self._held, u))

    def done(self, u: float, share: float, now: Now) -> None:
        felt, warm = float(self.felt(u, share, now)), bool(self._warm(u))
        if self._heating and not warm:  # a peak: complete, or an arrest
            self._arrest = self._turn if self._turn < self._complete else -math.inf
        if warm != self._heating:
            self._heating, self._turn = warm, u
        self._turn = max(self._turn, u) if warm else min(self._turn, u)
        if warm and u > self._arrest + 3 * self._width:
            self._arrest = -math.inf
        self._held = felt


_COUPLED = ("accommodation", "fatigue", "stress_coupling")


def chain(
    hidden: dict[str, dict[str, float]], hysteresis: Hysteresis, start: float, *, two_wire: bool
) -> tuple[list[Felt], bool]:
    """The effects in the order of their names, and whether what is felt depends on the relays."""
    makers: dict[str, Callable[[dict[str, float]], Felt]] = {
        "accommodation": lambda p: Accommodation(p, start),
        "coulomb_friction": Friction,
        "cross_talk": CrossTalk,
        "fatigue": Fatigue,
        "settling": Settling,
        "stress_coupling": lambda p: Stress(p, 0.5 if two_wire else 0.0),
        "temperature_memory": lambda p: Arrests(p, hysteresis.upper),
    }
    found = [make(hidden[name]) for name, make in makers.items() if name in hidden]
    return found, any(name in hidden for name in _COUPLED)
