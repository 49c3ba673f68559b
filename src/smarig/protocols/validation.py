"""Random holds from a seed: data to verify a model, never used to fit one."""

import random

from smarig.core import Mark, Protocol, Settled
from smarig.protocols._building_blocks import checked_count, saturate, settle_at
from smarig.protocols._setup import Setup


def validation(setup: Setup, *, points: int = 40, seed: int = 1, settle: Settled | None = None) -> Protocol:
    """Random holds over the whole range, from negative saturation, with nested memory of every depth.

    ``seed`` determines the sequence. Use the run to verify a model, and never to fit it.
    """
    checked_count("points", points, 2, 100_000)
    settle = settle or Settled()
    dice = random.Random(seed)
    inputs = [setup.at(dice.random()) for _ in range(points)]
    yield Mark("validation", {"seed": seed, "points": points})
    yield from saturate(setup, settle)
    yield from settle_at(setup, inputs, "validation", settle)
    yield from saturate(setup, settle)
