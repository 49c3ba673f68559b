"""Boxes out of seeds: wire, hysteresis, noise, channels, protocol and what is hidden, each from its own dice.

So a box with something forced into it is otherwise the box of its number.
"""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from smarig.benchmark.boxes.catalogue import EFFECTS, INVISIBLE_WITHOUT, checked, possible
from smarig.benchmark.boxes.density import drawn_hysteresis
from smarig.benchmark.boxes.label import EMPTY, HARD_NULL, ONE, TWO
from smarig.benchmark.boxes.plant import Hidden
from smarig.benchmark.boxes.protocol import RunPlan, drawn_plan, hours
from smarig.benchmark.boxes.relays import Hysteresis
from smarig.benchmark.boxes.sitting import Draughts
from smarig.benchmark.boxes.wire import Wire, drawn_wire
from smarig.errors import UsageError

CHANNELS: dict[str, float] = {"transients": 0.5, "current": 0.5, "voltage": 0.35, "ambient": 0.25}
LEFT_OUT = "left_out"
_MIX: dict[str, float] = {EMPTY: 0.35 * 2 / 3, HARD_NULL: 0.35 / 3, ONE: 0.45, TWO: 0.15, LEFT_OUT: 0.05}
_HARD = ("draughts", "density", "invisible")


@dataclass(frozen=True)
class Noise:
    """Draughts on the wire; the encoder's own noise in counts; where its wheel stands, 0…1 of a count."""

    draughts: Draughts
    encoder_counts: float
    phase: float


@dataclass(frozen=True, eq=False)
class Box:
    """All that is drawn of a box."""

    seed: int
    number: int
    category: str
    left_out: str
    hidden: Hidden
    wire: Wire
    hysteresis: Hysteresis
    noise: Noise
    channels: tuple[str, ...]
    plan: tuple[RunPlan, ...]


def draw(
    seed: int,
    number: int,
    hidden: Mapping[str, Mapping[str, float]] | Literal["hard_null"] | None = None,
    channels: Collection[str] | None = None,
) -> Box:
    """The box of a number. ``hidden``: effects to hide, {} for none; ``channels``: those to record."""
    if seed < 0 or number < 0:
        raise UsageError(f"Seed and number of a box are whole numbers from 0 up, got {seed} and {number}.")
    dice = np.random.default_rng([seed, number]).spawn(6)
    wire = drawn_wire(dice[0])
    kind, hard = _kind(dice[5], hidden)
    hysteresis = drawn_hysteresis(dice[1], wire, odd=hard == "density")
    noise = _noise(dice[2], strong=hard == "draughts")
    recorded = _channels(dice[3], channels)
    plan = drawn_plan(dice[4], wire, hysteresis)
    if hidden is None or isinstance(hidden, str):
        found = _hidden(dice[5], kind, hard, wire, recorded, hours(plan, wire))
    else:
        found = checked(hidden, wire.arrangement)
    left_out = next(iter(found)) if kind == LEFT_OUT else ""
    category = ONE if kind == LEFT_OUT else kind
    return Box(seed, number, category, left_out, found, wire, hysteresis, noise, recorded, plan)


def _kind(rng: np.random.Generator, hidden: Any) -> tuple[str, str]:
    """Category, and what makes a hard null hard."""
    if isinstance(hidden, str) and hidden != HARD_NULL:
        raise UsageError(f"A box is forced by its effects or by '{HARD_NULL}', not by '{hidden}'.")
    drawn, hard = str(rng.choice(list(_MIX), p=list(_MIX.values()))), str(rng.choice(_HARD))
    if isinstance(hidden, str):
        drawn = hidden
    elif hidden is not None:
        drawn = (EMPTY, ONE, TWO)[min(len(hidden), 2)]
    return drawn, hard if drawn == HARD_NULL else ""


def _noise(rng: np.random.Generator, *, strong: bool) -> Noise:
    sd_K = 0.0 if rng.random() < 0.2 else rng.uniform(0, 0.15)
    sd_K = rng.uniform(0.15, 0.3) if strong else sd_K
    time_s = math.exp(rng.uniform(math.log(20), math.log(200)))
    return Noise(Draughts(float(sd_K), time_s), float(rng.uniform(0.2, 0.5)), float(rng.random()))


def _channels(rng: np.random.Generator, forced: Collection[str] | None) -> tuple[str, ...]:
    drawn = tuple(name for name, share in CHANNELS.items() if rng.random() < share)
    if forced is None:
        return drawn
    unknown = set(forced) - set(CHANNELS)
    if unknown:
        raise UsageError(f"No channel '{sorted(unknown)[0]}'; there are: {', '.join(CHANNELS)}.")
    return tuple(name for name in CHANNELS if name in forced)


def _hidden(
    rng: np.random.Generator,
    kind: str,
    hard: str,
    wire: Wire,
    channels: tuple[str, ...],
    session_h: float,
) -> Hidden:
    if hard == "invisible":
        unseen = [name for name, by in INVISIBLE_WITHOUT.items() if not set(by) & set(channels)]
        names = [str(rng.choice(unseen))]
    else:
        n = {ONE: 1, LEFT_OUT: 1, TWO: 2}.get(kind, 0)
        names = sorted(str(name) for name in rng.choice(possible(wire.arrangement), n, replace=False))
    return {name: EFFECTS[name].drawn(rng, session_h) for name in names}
