"""Boxes from worlds that share no equation with the diagnosis: kinetic wires, and mechanisms nobody listed.

A public half is for development; the sealed half has mechanisms and seeds of its own and is scored once.
"""

from typing import Literal

import numpy as np

from benchmarks.boxes.box_effects import Hidden
from benchmarks.boxes.hold_plan import duration_h, random_plan
from benchmarks.boxes.kinetic_hysteresis import random_kinetic_hysteresis
from benchmarks.boxes.label import KINETIC, UNLISTED_CATEGORY
from benchmarks.boxes.random_box import Box, draw_box, random_channels, random_noise
from benchmarks.boxes.random_density import random_hysteresis
from benchmarks.boxes.unlisted_effects import UNLISTED
from benchmarks.boxes.wire import random_wire

Part = Literal["public", "sealed"]
World = Literal["relays", "kinetic", "unlisted"]
WORLDS: dict[World, float] = {"relays": 0.55, "kinetic": 0.2, "unlisted": 0.25}
_PART_SEED: dict[Part, int] = {"public": 0, "sealed": 1}


def draw_world_box(seed: int, number: int, part: Part = "public", world: World | None = None) -> Box:
    """The box of a number in one half; ``world`` forces the kind of box."""
    first = np.random.default_rng([seed, number, 7, _PART_SEED[part]])
    drawn = str(first.choice(list(WORLDS), p=list(WORLDS.values())))
    kind = world or drawn
    if kind == "relays":
        return draw_box(seed + 5000 * (1 + _PART_SEED[part]), number)
    return _foreign_box(first, seed, number, part, kinetic=kind == "kinetic")


def _foreign_box(rng: np.random.Generator, seed: int, number: int, part: Part, *, kinetic: bool) -> Box:
    generators = rng.spawn(6)
    wire = random_wire(generators[0], two_wire=False)
    own = random_kinetic_hysteresis if kinetic else _bumps
    hysteresis = own(generators[1], wire)
    plan = random_plan(generators[4], wire, hysteresis)
    hidden: Hidden = {} if kinetic else _unlisted(generators[5], part, duration_h(plan, wire))
    return Box(
        seed=seed,
        number=number,
        category=KINETIC if kinetic else UNLISTED_CATEGORY,
        left_out="",
        hidden=hidden,
        wire=wire,
        hysteresis=hysteresis,
        noise=random_noise(generators[2], strong=False),
        channels=random_channels(generators[3], None),
        plan=plan,
    )


def _bumps(rng: np.random.Generator, wire):
    return random_hysteresis(rng, wire, odd=False)


def _unlisted(rng: np.random.Generator, part: Part, session_h: float) -> Hidden:
    possible = [name for name, e in UNLISTED.items() if e.sealed is (part == "sealed")]
    name = str(rng.choice(possible))
    return {name: UNLISTED[name].random_values(rng, session_h)}
