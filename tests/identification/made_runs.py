"""Runs made in memory: known hysteresis, known inputs, and readings as poor as those of a bench (one sample
per point)."""

from pathlib import Path

import numpy as np

from smarig.preisach.hysteresis.gorbet_1997 import THESIS_PARTITIONS, thesis_surface
from smarig.preisach.operator import Preisach
from smarig.record import Run, Step
from smarig.record.schema import SAMPLE_COLUMNS

PER_COUNT = {"one": 2 * np.pi * 15 / 2000, "two": 0.18}
UNIT = {"one": "mm", "two": "deg"}
PARTITION = {"one": THESIS_PARTITIONS["one_wire"], "two": THESIS_PARTITIONS["two_wire"]}
NOISE_COUNTS = 0.4


def fod_inputs(partition):
    """Inputs of the protocol of §5.4.1: u₀; then for every i rise to u_i and fall through u_{i−1} … u₀."""
    levels = list(partition)
    return [levels[0]] + [u for k in range(1, len(levels)) for u in [levels[k], *reversed(levels[:k])]]


def made_run(inputs, outputs, *, name="made.run.sqlite", unit="mm", initial="negative", **meta):
    """A run of settled steps, one sample each; no file behind it."""
    n = len(inputs)
    columns = {key: np.full(n, np.nan) for key in SAMPLE_COLUMNS}
    columns |= {
        "tick": np.arange(n, dtype=float),
        "t_s": 30.0 * np.arange(n),
        "step": np.arange(n, dtype=float),
    }
    columns |= {"input": np.array(inputs, dtype=float), "position": np.array(outputs, dtype=float)}
    steps = tuple(
        Step(k, 0, False, "", float(u), 30.0 * k, 30.0 * k + 30.0, "settled", float(y), 1)
        for k, (u, y) in enumerate(zip(inputs, outputs, strict=True))
    )
    told = {
        "input": {"quantity": "temperature", "unit": "K"},
        "output": {"quantity": "position", "unit": unit},
        "end": {"cause": "done"},
    }
    if initial:
        told["initial"] = initial
    return Run(Path(name), {**told, "source": "twin", **meta}, columns, steps, ())


def read(y, wire, rng):
    """One encoder reading of each output: 0.4 counts of noise, then whole counts."""
    q = PER_COUNT[wire]
    return np.round(np.asarray(y) / q + NOISE_COUNTS * rng.standard_normal(len(y))) * q


def driven_run(surface_name, inputs, *, seed=None, initial="negative", offset=0.0, **meta):
    """A run of a Table 5.1 surface along inputs; exact outputs without a seed."""
    wire = surface_name[:3]
    y = Preisach.from_surface(thesis_surface(surface_name)).simulate(inputs, initial) + offset
    y = y if seed is None else read(y, wire, np.random.default_rng(seed))
    return made_run(inputs, y, unit=UNIT[wire], initial=initial, **meta)


def fod_run(surface_name, *, seed=None, partition=None, **meta):
    """The protocol of §5.4.1 on a Table 5.1 surface."""
    return driven_run(
        surface_name,
        fod_inputs(PARTITION[surface_name[:3]] if partition is None else partition),
        seed=seed,
        **meta,
    )
