"""From relays to the pulley: the effects of transmission, creep and sensor on a trajectory.

Each effect applies its own equation to the whole record at once.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.boxes.box_effects import Hidden
from benchmarks.boxes.kinetic_hysteresis import BoxHysteresis
from benchmarks.boxes.relays import Array
from benchmarks.boxes.wire import BoxWire

_R_PHASE_HALF_K = 1.0


@dataclass(frozen=True, eq=False)
class PlantRecord:
    """The record of a plant (n,): times, hold numbers, shares on, temperature and hysteresis input, strokes
    made.

    ``wire_K`` includes the room and the ambient fluctuation; ``current_A``, ``resistance`` (over the mean)
    and ``ambient_shift_K`` are the true values.
    """

    t_s: Array
    hold: NDArray[np.intp]
    share: Array
    wire_K: Array
    hysteresis_input_K: Array
    travel: Array
    current_A: Array
    resistance: Array
    ambient_shift_K: Array


@dataclass(frozen=True, eq=False)
class _EffectContext:
    """The quantities that an effect on the position may use."""

    record: PlantRecord
    wire: BoxWire
    hysteresis: BoxHysteresis


def position(record: PlantRecord, wire: BoxWire, hysteresis: BoxHysteresis, hidden: Hidden) -> Array:
    """Position (n,) in the rig's unit: the operator's output, then its maps, then the additive effects by
    name."""
    y = hysteresis.y_lower + hysteresis.stroke * record.share
    context = _EffectContext(record, wire, hysteresis)
    for name, change in (*_MAPS.items(), *_ADDITIVE.items()):
        if name in hidden:
            y = change(y, hidden[name], context)
    return y


def sensor_output(y: Array, t_s: Array, hidden: Hidden) -> Array:
    """The output of a late sensor: dead time, then a first-order lag of a position that is linear between
    times."""
    p = hidden.get("sensor_lag")
    if p is None:
        return y
    late = np.interp(t_s - p["dead_time_s"], t_s, y)
    slope = np.diff(late) / np.diff(t_s)
    decay = np.exp(-np.diff(t_s) / p["lag_s"])
    ramp_lag = slope * p["lag_s"]  # of a ramp
    lagged = [float(late[0])]
    for x0, x1, r, d in zip(late[:-1].tolist(), late[1:].tolist(), ramp_lag.tolist(), decay.tolist()):
        lagged.append(x1 - r + (lagged[-1] - x0 + r) * d)
    return np.array(lagged)


def _play(x: Array, half: float) -> Array:
    held, out = float(x[0]), []
    for value in x.tolist():
        held = min(max(held, value - half), value + half)
        out.append(held)
    return np.array(out)


def _backlash(y: Array, p: dict[str, float], context: _EffectContext) -> Array:
    return _play(y, p["play_percent"] / 100 * context.hysteresis.stroke / 2)


def _eccentricity(y: Array, p: dict[str, float], context: _EffectContext) -> Array:
    r, begin = context.wire.per_radian, 2 * np.pi * p["phase"]
    return y + p["share_percent"] / 100 * r * (np.sin(y / r + begin) - np.sin(begin))


def _end_conduction(y: Array, p: dict[str, float], context: _EffectContext) -> Array:
    h, f = context.hysteresis, p["share_percent"] / 100
    ends = h.initial(two_wire=context.wire.two_wire)
    shares = np.array([ends.move(u) for u in (p["cooler"] * context.record.hysteresis_input_K).tolist()])
    return (1 - f) * y + f * (h.y_lower + h.stroke * shares)


def _noncongruency(y: Array, p: dict[str, float], context: _EffectContext) -> Array:
    m = context.record.share
    return y + context.hysteresis.stroke * 2 * p["bend_percent"] / 100 * m * (1 - m)


def _r_phase(y: Array, p: dict[str, float], context: _EffectContext) -> Array:
    h, w = context.hysteresis, p["share_percent"] / 100
    centre = h.lower + p["at"] * (h.upper - h.lower)
    z = (_play(context.record.hysteresis_input_K, _R_PHASE_HALF_K) - centre) / p["width_K"]
    second = 1 / (1 + np.exp(-np.clip(z, -700, 700)))
    return (1 - w) * y + w * (h.y_lower + h.stroke * second)


def _slack(y: Array, p: dict[str, float], context: _EffectContext) -> Array:
    h = context.hysteresis
    return np.maximum(y, h.y_lower + p["floor_percent"] / 100 * h.stroke)


def _creep(y: Array, p: dict[str, float], context: _EffectContext) -> Array:
    """c Σ log₁₀(1 + (t − s)) dy(s) hold by hold; moves of much earlier holds are merged at their mean times."""
    t, hold = context.record.t_s, context.record.hold
    dy = np.diff(y, prepend=y[0])
    edges = np.flatnonzero(np.diff(hold, prepend=-1, append=-1))
    late, old_s, old_dy = np.zeros_like(y), np.empty(0), np.empty(0)
    for k, (first, last) in enumerate(zip(edges[:-1], edges[1:])):
        recent = slice(edges[k - 1] if k else first, last)
        s, moved = t[recent], dy[recent]
        s, moved = s[moved != 0], moved[moved != 0]
        at = t[first:last, None]
        late[first:last] = np.log10(1 + np.maximum(at - s, 0.0)) @ moved
        late[first:last] += np.log10(1 + at - old_s) @ old_dy
        if k:
            s, moved = _merged_moves(t[edges[k - 1] : first], dy[edges[k - 1] : first])
            old_s, old_dy = np.concatenate([old_s, s]), np.concatenate([old_dy, moved])
    return y + p["percent_per_decade"] / 100 * late


def _merged_moves(s: Array, dy: Array) -> tuple[Array, Array]:
    """Moves up and moves down, each at its mean time."""
    signs = [dy > 0, dy < 0]
    kept = [sign for sign in signs if sign.any()]
    return np.array([np.average(s[k], weights=dy[k]) for k in kept]), np.array([dy[k].sum() for k in kept])


def _slip(y: Array, p: dict[str, float], context: _EffectContext) -> Array:
    return y + p["jump_percent"] / 100 * context.hysteresis.stroke * (context.record.t_s >= 3600 * p["at_h"])


def _expansion(y: Array, p: dict[str, float], context: _EffectContext) -> Array:
    return y - p["percent_per_100K"] / 100 * context.hysteresis.stroke * context.record.wire_K / 100


def _walking(y: Array, p: dict[str, float], context: _EffectContext) -> Array:
    return y + p["percent_per_cycle"] / 100 * context.hysteresis.stroke * context.record.travel / 2


_Change = Callable[[Array, dict[str, float], _EffectContext], Array]
_MAPS: dict[str, _Change] = {
    "backlash": _backlash,
    "eccentricity": _eccentricity,
    "end_conduction": _end_conduction,
    "noncongruency": _noncongruency,
    "r_phase": _r_phase,
    "slack": _slack,
}
_ADDITIVE: dict[str, _Change] = {
    "creep": _creep,
    "slip": _slip,
    "thermal_expansion": _expansion,
    "walking": _walking,
}
OUTPUT_EFFECTS = frozenset((*_MAPS, *_ADDITIVE, "sensor_lag"))  # these do not act back on the wire
