"""Mechanisms that no catalogue of the diagnosis lists: what a bench does that nobody thought of.

Each acts at one place: on the current, on the loss of heat, on the room, on the hysteresis input or on the position. A
box with one of them has no right name; the right answer is "unknown", with one of ``variables``. The ``sealed`` half is
never used in development.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.boxes.input_effects import InputEffect, StepState
from benchmarks.boxes.output_effects import PlantRecord
from benchmarks.boxes.relays import Array

Values = Mapping[str, float]
Range = tuple[float, float]  # of a log-uniform distribution; of a uniform one if it begins at 0
CLOCK = frozenset({"time", "cycle", "reversals"})
HISTORY = frozenset({"history", "step", "hold", "rate"})
STATE = frozenset({"level"})
ROOM = frozenset({"ambient_drift"})
DUTY_S = 120.0  # a supply's memory of its load


@dataclass(frozen=True)
class UnlistedEffect:
    """A mechanism: ranges of its parameters, the variables that its errors depend on, and where it acts.

    ``current`` (i in A, duty, values, t in h) → A. ``loss`` and ``room`` of (t in h, values) are the factor of the heat
    loss, and K. ``at_input`` makes an input effect. ``at_output`` (y, record, stroke, values) → y. ``right_names`` are
    catalogue effects that say the same.
    """

    ranges: Mapping[str, Range]
    variables: frozenset[str]
    sealed: bool = False
    right_names: frozenset[str] = frozenset()
    current: Callable[[float, float, Values, float], float] | None = None
    loss: Callable[[float, Values], float] | None = None
    room: Callable[[float, Values], float] | None = None
    at_input: Callable[[Values], InputEffect] | None = None
    at_output: Callable[[Array, PlantRecord, float, Values], Array] | None = None

    def random_values(self, rng: np.random.Generator, session_h: float) -> dict[str, float]:
        """Random parameters; ``at_h`` and ``tau_h`` are shares of the session's length."""
        drawn = {name: _drawn(rng, r) for name, r in self.ranges.items()}
        return {name: v * session_h if name in ("at_h", "tau_h") else v for name, v in drawn.items()}


def _drawn(rng: np.random.Generator, r: Range) -> float:
    low, high = r
    return rng.uniform(low, high) if low <= 0 else math.exp(rng.uniform(math.log(low), math.log(high)))


def _sagging_supply(i: float, duty: float, p: Values, _t_h: float) -> float:
    return i * (1 - p["share"] * duty)


def _warming_amplifier(i: float, _duty: float, p: Values, t_h: float) -> float:
    return i * (1 + p["share"] * (1 - math.exp(-t_h / p["tau_h"])))


def _loose_connector(i: float, _duty: float, p: Values, t_h: float) -> float:
    """A contact that loses a share of the current for minutes at a time."""
    phase = (t_h / p["period_h"]) % 1.0
    return i * (1 - p["share"]) if phase < p["open"] else i


def _fan_turned_on(t_h: float, p: Values) -> float:
    return 1 + p["share"] if t_h >= p["at_h"] else 1.0


def _dust(t_h: float, p: Values) -> float:
    return 1 / (1 + p["share"] * t_h / p["tau_h"])


def _thermostat(t_h: float, p: Values) -> float:
    """A room that swings: a triangle between heater on and off."""
    phase = (t_h / p["period_h"] + p["phase"]) % 1.0
    start = p["phase"] % 1.0
    return p["swing_K"] * (abs(2 * phase - 1) - abs(2 * start - 1)) * 2


def _door(t_h: float, p: Values) -> float:
    return -p["swing_K"] if p["at_h"] <= t_h < p["at_h"] + p["open_h"] else 0.0


class _RestingFriction:
    """Friction that grows while nothing moves: the first kelvins after a long hold are lost."""

    def __init__(self, p: Values) -> None:
        self._p, self._held, self._last_u, self._rest_s = p, 0.0, 0.0, 0.0

    def hysteresis_input(self, u: Any, _share: Any, now: StepState) -> Any:
        half = self._p["half_K"] * (0.3 + math.log10(1 + (self._rest_s + now.dt_s) / 10))
        return np.minimum(np.maximum(self._held, u - half), u + half)

    def finish_step(self, u: float, share: float, now: StepState) -> None:
        self._held = float(self.hysteresis_input(u, share, now))
        moving = abs(u - self._last_u) > 0.02 * now.dt_s
        self._rest_s = 0.0 if moving else self._rest_s + now.dt_s
        self._last_u = u


class _Damage:
    """Heat above a limit moves the transformation up for good."""

    def __init__(self, p: Values) -> None:
        self._p, self._shift_K, self._peak = p, 0.0, 0.0

    def hysteresis_input(self, u: Any, _share: Any, _now: StepState) -> Any:
        return u - self._shift_K

    def finish_step(self, _u: float, share: float, now: StepState) -> None:
        self._shift_K += self._p["per_h_K"] * max(share - 0.7, 0.0) * now.dt_s / 3600


class _LoadChange:
    """Somebody hangs another weight on the wire."""

    def __init__(self, p: Values) -> None:
        self._p = p

    def hysteresis_input(self, u: Any, _share: Any, now: StepState) -> Any:
        return u - (self._p["shift_K"] if now.t_s >= 3600 * self._p["at_h"] else 0.0)

    def finish_step(self, u: float, share: float, now: StepState) -> None:
        """Nothing to store."""


def _followed(x: Array, t_s: Array, tau_s: float) -> Array:
    """x after a first-order lag."""
    late, out = float(x[0]), []
    for value, decay in zip(x.tolist(), np.exp(-np.diff(t_s, prepend=t_s[0]) / tau_s).tolist()):
        late = value + (late - value) * decay
        out.append(late)
    return np.array(out)


def _warm_frame(y: Array, record: PlantRecord, stroke: float, p: Values) -> Array:
    heat = _followed(np.square(record.current_A), record.t_s, 60 * p["tau_min"])
    return y + p["share"] * stroke * heat / float(np.square(record.current_A).max() or 1.0)


def _lost_counts(y: Array, record: PlantRecord, stroke: float, p: Values) -> Array:
    """An encoder that loses a share of every fast downward move."""
    dy = np.diff(y, prepend=y[0])
    speed = np.abs(dy) / np.maximum(np.diff(record.t_s, prepend=record.t_s[0] - 0.1), 1e-3)
    fast = (dy < 0) & (speed > p["speed"] * stroke)
    return y + p["share"] * np.cumsum(np.where(fast, -dy, 0.0))


def _shaking(y: Array, record: PlantRecord, stroke: float, p: Values) -> Array:
    return y + p["share"] * stroke * np.sin(2 * np.pi * record.t_s / (60 * p["period_min"]))


def _stretching_cord(y: Array, record: PlantRecord, _stroke: float, p: Values) -> Array:
    """A cord that stretches under a move and recovers."""
    return y - p["share"] * (y - _followed(y, record.t_s, 60 * p["tau_min"]))


def _drifting_scale(y: Array, record: PlantRecord, _stroke: float, p: Values) -> Array:
    return y[0] + (y - y[0]) * (1 + p["share"] * record.t_s / record.t_s[-1])


def _stick_slip(y: Array, _record: PlantRecord, stroke: float, p: Values) -> Array:
    """A slider that moves in jumps only."""
    jump, held, out = p["share"] * stroke, float(y[0]), []
    for value in y.tolist():
        if abs(value - held) > jump:
            held = value
        out.append(held)
    return np.array(out)


def _magnetic_sensor(y: Array, record: PlantRecord, stroke: float, p: Values) -> Array:
    """A sensor with a memory that fades."""
    return y + p["share"] * stroke * np.tanh(
        (_followed(y, record.t_s, 60 * p["tau_min"]) - y) / (0.2 * stroke)
    )


def _wandering_zero(y: Array, _record: PlantRecord, stroke: float, p: Values) -> Array:
    """A zero that hops between two places at every other visit of the hot end."""
    hot = y > y.min() + 0.8 * float(np.ptp(y))
    visits = np.cumsum(np.diff(hot.astype(int), prepend=0) > 0)
    return y + p["share"] * stroke * (visits % 2)


UNLISTED: dict[str, UnlistedEffect] = {
    "dust": UnlistedEffect({"share": (0.02, 0.2), "tau_h": (1.0, 1.0)}, CLOCK, loss=_dust),
    "fan_turned_on": UnlistedEffect({"share": (0.01, 0.15), "at_h": (0.2, 0.8)}, CLOCK, loss=_fan_turned_on),
    "lost_counts": UnlistedEffect(
        {"share": (0.002, 0.02), "speed": (0.001, 0.004)}, CLOCK, at_output=_lost_counts
    ),
    "resting_friction": UnlistedEffect(
        {"half_K": (0.2, 1.5)}, HISTORY | STATE | CLOCK, at_input=_RestingFriction
    ),
    "sagging_supply": UnlistedEffect(
        {"share": (0.005, 0.05)}, HISTORY | STATE | CLOCK, current=_sagging_supply
    ),
    "shaking": UnlistedEffect({"share": (0.003, 0.03), "period_min": (8, 60)}, CLOCK, at_output=_shaking),
    "thermostat": UnlistedEffect(
        {"swing_K": (0.5, 1.5), "period_h": (0.2, 0.8), "phase": (0, 1)},
        CLOCK,
        right_names=ROOM,
        room=_thermostat,
    ),
    "warm_frame": UnlistedEffect(
        {"share": (0.005, 0.05), "tau_min": (3, 30)}, HISTORY | STATE | CLOCK, at_output=_warm_frame
    ),
    "warming_amplifier": UnlistedEffect(
        {"share": (0.003, 0.03), "tau_h": (0.1, 0.4)}, CLOCK, current=_warming_amplifier
    ),
    "damage": UnlistedEffect({"per_h_K": (1, 10)}, CLOCK | STATE, sealed=True, at_input=_Damage),
    "door": UnlistedEffect(
        {"swing_K": (0.7, 4), "at_h": (0.2, 0.6), "open_h": (0.2, 0.8)},
        CLOCK,
        sealed=True,
        right_names=ROOM,
        room=_door,
    ),
    "drifting_scale": UnlistedEffect(
        {"share": (0.005, 0.06)}, CLOCK | STATE, sealed=True, at_output=_drifting_scale
    ),
    "load_change": UnlistedEffect(
        {"shift_K": (0.5, 5), "at_h": (0.2, 0.8)}, CLOCK, sealed=True, at_input=_LoadChange
    ),
    "loose_connector": UnlistedEffect(
        {"share": (0.003, 0.03), "period_h": (0.3, 1.5), "open": (0.2, 0.5)},
        CLOCK,
        sealed=True,
        current=_loose_connector,
    ),
    "magnetic_sensor": UnlistedEffect(
        {"share": (0.005, 0.05), "tau_min": (2, 20)}, HISTORY | STATE, sealed=True, at_output=_magnetic_sensor
    ),
    "stick_slip": UnlistedEffect(
        {"share": (0.01, 0.06)}, HISTORY | STATE, sealed=True, at_output=_stick_slip
    ),
    "stretching_cord": UnlistedEffect(
        {"share": (0.01, 0.08), "tau_min": (3, 40)}, HISTORY | STATE, sealed=True, at_output=_stretching_cord
    ),
    "wandering_zero": UnlistedEffect(
        {"share": (0.004, 0.03)}, CLOCK | HISTORY | STATE, sealed=True, at_output=_wandering_zero
    ),
}


class BenchFaults:
    """The unlisted mechanisms of a box that act on current, heat loss and room."""

    def __init__(self, hidden: Mapping[str, Values], full_A: float) -> None:
        self._present = [(UNLISTED[name], p) for name, p in hidden.items() if name in UNLISTED]
        self._full_A, self._duty = full_A, 0.0

    def current(self, i: float, t_s: float, dt_s: float) -> float:
        """The current that flows for a time ``dt_s`` from ``t_s`` on."""
        for effect, p in self._present:
            if effect.current:
                i = effect.current(i, self._duty, p, t_s / 3600)
        target = (i / self._full_A) ** 2
        self._duty = target + (self._duty - target) * math.exp(-dt_s / DUTY_S)
        return i

    def loss(self, t_s: float) -> float:
        """Heat loss divided by that of the undisturbed wire."""
        return math.prod(e.loss(t_s / 3600, p) for e, p in self._present if e.loss)

    def room_K(self, t_s: float) -> float:
        """Change of the room's temperature."""
        return sum(e.room(t_s / 3600, p) for e, p in self._present if e.room)

    def input_effects(self) -> list[InputEffect]:
        """Effects on the hysteresis input."""
        return [e.at_input(p) for e, p in self._present if e.at_input]


def unlisted_output(y: Array, record: PlantRecord, stroke: float, hidden: Mapping[str, Values]) -> Array:
    """The position with the unlisted mechanisms that act on it."""
    for name, p in hidden.items():
        effect = UNLISTED.get(name)
        if effect and effect.at_output:
            y = effect.at_output(y, record, stroke, p)
    return y


UNLISTED_OUTPUT = frozenset(name for name, e in UNLISTED.items() if e.at_output)
