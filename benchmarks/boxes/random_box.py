"""Boxes from seeds: wire, hysteresis, noise, channels, protocol and hidden effects have separate random
streams.

A box with a forced property therefore equals the box of its number in everything else.
"""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from benchmarks.boxes.box_effects import (
    EFFECTS,
    INVISIBLE_WITHOUT,
    Hidden,
    complete_parameters,
    possible_effects,
)
from benchmarks.boxes.box_session import AmbientFluctuation
from benchmarks.boxes.hold_plan import RunPlan, duration_h, random_plan
from benchmarks.boxes.kinetic_hysteresis import BoxHysteresis
from benchmarks.boxes.label import EMPTY, HARD_NULL, ONE, TWO
from benchmarks.boxes.random_density import random_hysteresis
from benchmarks.boxes.wire import BoxWire, random_wire
from smarig.core import UsageError

CHANNELS: dict[str, float] = {"transients": 0.5, "current": 0.5, "voltage": 0.35, "ambient": 0.25}
LEFT_OUT = "left_out"
_MIX: dict[str, float] = {EMPTY: 0.35 * 2 / 3, HARD_NULL: 0.35 / 3, ONE: 0.45, TWO: 0.15, LEFT_OUT: 0.05}
_HARD = ("draughts", "density", "invisible")


@dataclass(frozen=True)
class BoxNoise:
    """Ambient fluctuation of the wire, encoder noise in counts, and encoder phase, 0…1 of a count."""

    ambient_fluctuation: AmbientFluctuation
    encoder_counts: float
    phase: float


@dataclass(frozen=True, eq=False)
class Box:
    """All random properties of a box."""

    seed: int
    number: int
    category: str
    left_out: str
    hidden: Hidden
    wire: BoxWire
    hysteresis: BoxHysteresis
    noise: BoxNoise
    channels: tuple[str, ...]
    plan: tuple[RunPlan, ...]


def draw_box(
    seed: int,
    number: int,
    hidden: Mapping[str, Mapping[str, float]] | Literal["hard_null"] | None = None,
    channels: Collection[str] | None = None,
) -> Box:
    """The box of a number. ``hidden``: effects to hide, {} for none; ``channels``: those to record."""
    if seed < 0 or number < 0:
        raise UsageError(
            f"Seed and number of a box must be whole numbers from 0 up (given: {seed} and {number})."
        )
    generators = np.random.default_rng([seed, number]).spawn(6)
    wire = random_wire(generators[0])
    kind, hard = _category_of(generators[5], hidden)
    hysteresis = random_hysteresis(generators[1], wire, odd=hard == "density")
    noise = random_noise(generators[2], strong=hard == "draughts")
    recorded = random_channels(generators[3], channels)
    plan = random_plan(generators[4], wire, hysteresis)
    if hidden is None or isinstance(hidden, str):
        found = _hidden(generators[5], kind, hard, wire, recorded, duration_h(plan, wire))
    else:
        found = complete_parameters(hidden, wire.arrangement)
    left_out = next(iter(found)) if kind == LEFT_OUT else ""
    category = ONE if kind == LEFT_OUT else kind
    return Box(
        seed=seed,
        number=number,
        category=category,
        left_out=left_out,
        hidden=found,
        wire=wire,
        hysteresis=hysteresis,
        noise=noise,
        channels=recorded,
        plan=plan,
    )


def _category_of(rng: np.random.Generator, hidden: Any) -> tuple[str, str]:
    """The category, and the property that makes a hard null hard."""
    if isinstance(hidden, str) and hidden != HARD_NULL:
        raise UsageError(f"A box can be forced by its effects or by '{HARD_NULL}', not by '{hidden}'.")
    drawn, hard = str(rng.choice(list(_MIX), p=list(_MIX.values()))), str(rng.choice(_HARD))
    if isinstance(hidden, str):
        drawn = hidden
    elif hidden is not None:
        drawn = (EMPTY, ONE, TWO)[min(len(hidden), 2)]
    return drawn, hard if drawn == HARD_NULL else ""


def random_noise(rng: np.random.Generator, *, strong: bool) -> BoxNoise:
    """Noise of room and encoder; ``strong`` with much of the former."""
    sd_K = 0.0 if rng.random() < 0.2 else rng.uniform(0, 0.15)
    sd_K = rng.uniform(0.15, 0.3) if strong else sd_K
    time_s = math.exp(rng.uniform(math.log(20), math.log(200)))
    return BoxNoise(
        AmbientFluctuation(float(sd_K), time_s), float(rng.uniform(0.2, 0.5)), float(rng.random())
    )


def random_channels(rng: np.random.Generator, forced: Collection[str] | None) -> tuple[str, ...]:
    """The channels that are recorded besides the position."""
    drawn = tuple(name for name, share in CHANNELS.items() if rng.random() < share)
    if forced is None:
        return drawn
    unknown = set(forced) - set(CHANNELS)
    if unknown:
        raise UsageError(f"No channel '{sorted(unknown)[0]}'. The channels are: {', '.join(CHANNELS)}.")
    return tuple(name for name in CHANNELS if name in forced)


def _hidden(
    rng: np.random.Generator,
    kind: str,
    hard: str,
    wire: BoxWire,
    channels: tuple[str, ...],
    session_h: float,
) -> Hidden:
    if hard == "invisible":
        invisible = [name for name, by in INVISIBLE_WITHOUT.items() if not set(by) & set(channels)]
        names = [str(rng.choice(invisible))]
    else:
        n = {ONE: 1, LEFT_OUT: 1, TWO: 2}.get(kind, 0)
        names = sorted(str(name) for name in rng.choice(possible_effects(wire.arrangement), n, replace=False))
    return {name: EFFECTS[name].random_values(rng, session_h) for name in names}
