"""Records of random relays with a measured temperature and one hidden mechanism, or none; equations of their own.

ẋ: relays with drawn thresholds;  thermometer: small steps of its time constant;  every mechanism acts on the wire
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.record import SAMPLE_COLUMNS, Run

Array = NDArray[np.float64]
RELAYS = 2000
INNER_STEPS = 20
DRIFT_S = 500.0  # time constant of a drift, times its strength; a run lasts 500 to 1500 s
TRUTHS: dict[
    str, tuple[tuple[str, ...], tuple[str, ...]]
] = {  # right effects, right variables of an unknown verdict
    "nothing": ((), ()),
    "memoryless": ((), ()),
    "lag": (("input_lag",), ("rate", "speed")),
    "offset": (("input_offset",), ("run",)),
    "stress": (("stress_shift",), ("stress", "run")),
    "drift": (("output_drift",), ("time", "cycle")),
    "ratcheting": (("ratcheting",), ("cycle", "time")),
    "rate_gain": ((), ("rate", "speed")),
    "jump": (("output_jump",), ("time", "cycle")),
    "second_population": ((), ()),
    "input_drift": (("input_drift",), ("time", "cycle")),
    "training": ((), ("cycle", "time")),
    "creep": ((), ("time_since_reversal", "speed", "rate", "history")),
}


@dataclass(frozen=True, eq=False)
class RelayWorld:
    """Runs of one wire; ``names`` are the right effects, ``variables`` right answers of an unknown verdict."""

    name: str
    train: tuple[Run, ...]
    held_out: tuple[Run, ...]
    names: tuple[str, ...]
    variables: tuple[str, ...]


def relay_world(kind: str, seed: int) -> RelayWorld:
    """The world of a kind and seed: two or three training runs, or one, and one held-out run."""
    rng = np.random.default_rng([seed, list(TRUTHS).index(kind)])
    several = kind in ("offset", "stress") or rng.random() < 0.3
    wire = _Wire(rng, second=kind == "second_population")
    strength = float(rng.uniform(0.7, 1.6))
    runs = [
        _recorded(rng, wire, kind, strength, number, last=number == (3 if several else 1))
        for number in range(4 if several else 2)
    ]
    names, variables = TRUTHS[kind]
    return RelayWorld(f"{kind} {seed}", tuple(runs[:-1]), (runs[-1],), names, variables)


class _Wire:
    def __init__(self, rng: np.random.Generator, *, second: bool):
        self.down = rng.normal(rng.uniform(44, 50), rng.uniform(3, 6), RELAYS)
        self.up = self.down + rng.gamma(4.0, rng.uniform(2, 4), RELAYS)
        if second:
            other = RELAYS // 3
            self.down[:other] = rng.normal(60.0, 2.0, other)
            self.up[:other] = self.down[:other] + rng.gamma(3.0, 0.6, other)
        self.share = rng.dirichlet(np.full(RELAYS, 0.5))
        self.stroke = float(rng.uniform(2, 6))

    def follow(self, temperature: Array) -> Array:
        hot, out = np.zeros(RELAYS, dtype=bool), np.empty(temperature.size)
        for k, t in enumerate(temperature.tolist()):
            hot = (t > self.up) | (hot & (t >= self.down))
            out[k] = self.stroke * (1 - self.share @ hot)
        return out


def _drive(rng: np.random.Generator, cycles: int) -> tuple[Array, Array]:
    """(t, u): excursions from 25 °C to random peaks, back to random valleys, each branch at a rate of its own."""
    points, level = [25.0], 25.0
    for number in range(cycles):
        high = 88.0 if number == 0 else float(rng.uniform(58, 88))
        level = 25.0 if number == cycles - 1 or rng.random() < 0.4 else float(rng.uniform(26, 48))
        points += [high, level]
    rates = np.exp(rng.uniform(np.log(0.4), np.log(3.0), len(points) - 1))
    ends = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(points)) / rates)])
    t = np.arange(0.0, ends[-1], ends[-1] / (75 * cycles))
    return t, np.interp(t, ends, points)


def _recorded(
    rng: np.random.Generator, wire: _Wire, kind: str, strength: float, number: int, *, last: bool
) -> Run:
    t, u = _drive(
        rng, int(rng.integers(5, 8)) if last or kind in ("offset", "stress") else int(rng.integers(11, 15))
    )
    step, read, stress, acting = float(t[1] - t[0]), u, None, u
    if kind == "lag":
        read = _lagging(u, step, 4.0 * strength)
    if kind == "input_drift":
        read = u + 5.0 * strength * t / 1000.0
    if kind == "offset":
        acting = u + 3.0 * strength * number * (1 if number % 2 else -0.7)
    if kind == "stress":
        stress = 50.0 + 60.0 * number
        acting = u - stress / (7.0 * strength)
    y = wire.stroke * (1 - 1 / (1 + np.exp(-(u - 55) / 4))) if kind == "memoryless" else wire.follow(acting)
    y = _changed(y, kind, strength, t, u, number)
    return _run(f"run {number}", rng, t, read, y, stress)


def _lagging(u: Array, step: float, lag_s: float) -> Array:
    read, out = float(u[0]), [float(u[0])]
    for before, after in zip(u[:-1].tolist(), u[1:].tolist()):
        for k in range(INNER_STEPS):
            at = before + (after - before) * (k + 0.5) / INNER_STEPS
            read += (at - read) * step / INNER_STEPS / lag_s
        out.append(read)
    return np.array(out)


def _changed(y: Array, kind: str, strength: float, t: Array, u: Array, number: int) -> Array:
    """The output after mechanisms that act on it: 5 to 15 % of its range."""
    size = 0.09 * strength * float(np.ptp(y))
    if kind == "drift":
        return y + size * (1 - np.exp(-t / (DRIFT_S * strength)))
    if kind == "ratcheting":
        turned = np.cumsum(np.abs(np.diff(u, prepend=u[0]))) / (2 * 45.0)
        return y + size * (1 - np.exp(-(turned + 12 * number) / 4.0))
    if kind == "rate_gain":
        speed = np.abs(np.gradient(u, t))
        return y + (y.max() - y) * 0.12 * strength * np.log(speed + 0.05)
    if kind == "training":
        turned = np.cumsum(np.abs(np.diff(u, prepend=u[0]))) / (2 * 45.0) + 12 * number
        return y.max() - (y.max() - y) * (1 + 0.25 * strength * (1 - np.exp(-turned / 6.0)))
    if kind == "creep":
        return _relaxing(y, float(t[1] - t[0]) / (12.0 * strength))
    if kind == "jump":
        return y + 1.2 * size * (t > 0.55 * t[-1]) * (number == 0)
    return y


def _relaxing(y: Array, share: float) -> Array:
    """The output, of which a third follows with a time constant of its own."""
    late, out = float(y[0]), []
    for x in y.tolist():
        late += (x - late) * (1 - np.exp(-share))
        out.append(late)
    return (2 * y + np.array(out)) / 3


def _run(name: str, rng: np.random.Generator, t: Array, u: Array, y: Array, stress: float | None) -> Run:
    read = u + 0.05 * rng.standard_normal(t.size)
    return imported_run(name, read, y + 0.003 * float(np.ptp(y)) * rng.standard_normal(t.size), t, stress)


def imported_run(name: str, u: Array, y: Array, t: Array | None, stress: float | None) -> Run:
    """Temperatures (n,) and strains (n,) as somebody's file gives them; without times if ``t`` is None."""
    columns = {key: np.full(u.size, np.nan) for key in SAMPLE_COLUMNS}
    columns |= {"tick": np.arange(u.size, dtype=float), "input": u, "position": y}
    columns |= {} if t is None else {"t_s": t}
    meta: dict[str, Any] = {
        "source": "import",
        "input": {"quantity": "temperature", "unit": "degC"},
        "output": {"quantity": "strain", "unit": "%"},
        "end": {"cause": "done"},
    }
    if stress is not None:
        meta["conditions"] = {"stress": {"unit": "MPa", "mean": stress, "min": stress, "max": stress}}
    return Run(Path(f"{name}.run.sqlite"), meta, columns, (), ())
