"""``smarig benchmark forward``: speed, memory and accuracy of the operator, as ratios measured in one run.

The measure has 5050 relays on a 100 × 100 grid over [−1, 1] (α ≥ β at cell centres, masses uniform on [0,
1), seed 0). The random walk has steps uniform on ±3 grid cells, so each step crosses a few thresholds. It is
reflected at ±1, so the whole range is visited about thirty times in 10⁵ samples (``random_walk``). The
decaying sine has 200 periods, which gives the deepest memory. A batch has 10⁴ walks of 100 samples, and 1000
tables with 12 nodes follow one walk of 1000 samples; both beside a call for each. The baseline holds the
same relays in one NumPy array (``relay_array``), the fastest simple version known to us. Rates are samples
per second of processor time (one thread, since machines are shared), best of three. Nothing is asserted here.
"""

import time
import timeit
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.preisach import (
    THESIS_PARTITIONS,
    Everett,
    FodTable,
    Preisach,
    RelayMeasure,
    compiled_available,
    simulate_models,
    thesis_surface,
)

Array = NDArray[np.float64]
SIDE = 100
CELL = 2.0 / SIDE


def random_walk(n: int, seed: int = 0) -> Array:
    """Inputs (n,) in [−1, 1]: a sum of steps uniform on ±3 cells, reflected at both ends.

    >>> u = random_walk(100_000)
    >>> bool(u.min() < -0.999 and u.max() > 0.999)
    True
    """
    path = np.random.default_rng(seed).uniform(-3 * CELL, 3 * CELL, n).cumsum()
    return np.abs((path + 1.0) % 4.0 - 2.0) - 1.0


def decaying_sine(n: int) -> Array:
    """Inputs (n,): 200 periods with an amplitude that falls linearly from 1 to 0."""
    part = np.arange(n) / n
    return (1.0 - part) * np.sin(400 * np.pi * part)


def smooth_loops(n: int) -> Array:
    """Inputs (n,): 100 periods in three groups, each of which swells and falls: nested loops, sampled finely."""
    part = np.arange(n) / n
    return np.sin(200 * np.pi * part) * (0.5 + 0.5 * np.cos(6 * np.pi * part))


def noisy_loops(n: int, seed: int = 0) -> Array:
    """The smooth loops with noise of a hundredth of their amplitude, which turns them at every other sample."""
    noise = np.random.default_rng(seed).normal(0, 0.01, n)
    return np.clip(0.95 * smooth_loops(n) + noise, -1, 1)


def relays() -> RelayMeasure:
    """The 5050 relays of this benchmark."""
    centres = -1.0 + CELL * (np.arange(SIDE) + 0.5)
    i, j = np.tril_indices(SIDE)
    return RelayMeasure.from_arrays(centres[i], centres[j], np.random.default_rng(0).random(i.size))


def relay_array(measure: RelayMeasure, u: Array) -> Array:
    """y = Σ mass γ with every relay stored and switched by a mask at each step; the baseline."""
    alpha, beta, mass = measure.alpha, measure.beta, measure.mass
    gamma, switched = np.full(alpha.size, -1.0), np.empty(alpha.size, dtype=bool)
    y = np.empty(u.size)
    for k, v in enumerate(u.tolist()):
        np.less_equal(alpha, v, out=switched)
        np.copyto(gamma, 1.0, where=switched)
        np.greater_equal(beta, v, out=switched)
        np.copyto(gamma, -1.0, where=switched)
        y[k] = mass @ gamma
    return y


def run(quick: bool = False) -> dict[str, Any]:
    """All figures; ``quick`` takes a tenth of the samples."""
    n = 10_000 if quick else 100_000
    measure = relays()
    few = random_walk(n // 10)
    baseline = few.size / _best(lambda: relay_array(measure, few))
    exact = relay_array(measure, few)
    here = Preisach(measure, compiled=False).simulate(few)
    plain = {name: _rates(h, n) for name, h in example_hystereses(measure).items()}
    return {
        "samples": n,
        "relays": measure.mass.size,
        "plain_python": plain,
        "relay_array_per_s": baseline,
        "ratio_to_relay_array": plain["measure"]["random_walk_per_s"] / baseline,
        "agreement_of_range": float(np.max(np.abs(here - exact)) / (2 * measure.mass.sum())),
        "peak_memory_MB": _peak_MB(measure, n),
        "numba": _numba(measure, 1 if quick else 100) if compiled_available() else None,
        "bulk": _bulk(measure, 10 if quick else 1) if compiled_available() else None,
    }


def example_hystereses(measure: RelayMeasure) -> dict[str, Everett]:
    """The hystereses of these benchmarks, one of each kind, by name."""
    nodes = np.array(THESIS_PARTITIONS["two_wire"])
    alpha, beta = np.meshgrid(nodes, nodes, indexing="ij")
    values = np.where(beta <= alpha, thesis_surface("two_e").y(alpha, beta), np.nan)
    table = FodTable.from_arrays(nodes, nodes, values)
    return {
        "measure": measure,
        "table": table,
        **{f"surface_{n}": thesis_surface(n) for n in ("two_c", "two_e")},
    }


def _rates(h: Everett, n: int) -> dict[str, float]:
    operator, scale = Preisach(h, compiled=False), h.upper
    walk, sine = random_walk(n) * scale, decaying_sine(n) * scale
    inputs = walk[: n // 10].tolist()

    def steps() -> None:
        operator.reset()
        for u in inputs:
            operator.step(u)

    walked = n / _best(lambda: operator.simulate(walk))
    swung = n / _best(lambda: operator.simulate(sine))
    return {
        "random_walk_per_s": walked,
        "decaying_sine_per_s": swung,
        "sine_over_walk": swung / walked,
        "step_per_s": len(inputs) / _best(steps),
    }


def _peak_MB(measure: RelayMeasure, n: int) -> float:
    """Peak memory of a run including its inputs and outputs, measured in a separate pass."""
    tracemalloc.start()
    try:
        Preisach(measure, compiled=False).simulate(random_walk(n))
        return tracemalloc.get_traced_memory()[1] / 1e6
    finally:
        tracemalloc.stop()


def _numba(measure: RelayMeasure, scale: int) -> dict[str, Any]:
    """The compiled loop at three sizes, each with new inputs; the first call compiles, or loads what was compiled."""
    operator = Preisach(measure, compiled=True)
    begin = time.process_time()
    operator.simulate(random_walk(1000))
    first_call_s = time.process_time() - begin
    seconds = {}
    for size in (1000 * scale, 10_000 * scale, 100_000 * scale):
        inputs = [random_walk(size, seed) for seed in range(1, 4 if size < 10**7 else 3)]
        seconds[size] = min(_best(lambda u=u: operator.simulate(u), 1) for u in inputs)
    walk = random_walk(10_000, 9)
    same = operator.simulate(walk) == Preisach(measure, compiled=False).simulate(walk)
    rates = {str(size): size / s for size, s in seconds.items()}
    sizes = sorted(seconds)
    sampled = {"smooth": smooth_loops(sizes[-1]), "noisy": noisy_loops(sizes[-1])}
    buffer = np.empty(sizes[-1])
    copied = sizes[-1] / _best(lambda: np.copyto(buffer, sampled["smooth"]))
    loops = {f"{name}_per_s": u.size / _best(lambda u=u: operator.simulate(u)) for name, u in sampled.items()}
    return {
        "first_call_s": first_call_s,
        "random_walk_per_s": rates,
        **loops,
        "memory_copy_per_s": copied,
        "time_per_sample_last_over_first": (seconds[sizes[-1]] / sizes[-1]) / (seconds[sizes[0]] / sizes[0]),
        "equal_to_plain_bit_for_bit": bool(same.all()),
    }


def _bulk(measure: RelayMeasure, part: int) -> dict[str, Any]:
    """Batches, many models and short calls, compiled: rates of processor time, and what calls one by one would take.

    ``threads_gain``: processor time over the time by the clock, of a batch.
    """
    operator = Preisach(measure, compiled=True)
    batch = np.stack([random_walk(100, seed) for seed in range(10_000 // part)])
    operator.simulate(batch[:2])
    rows_s = _best(lambda: [operator.simulate(row) for row in batch])
    batch_s, clock_s = (
        _best(lambda: operator.simulate(batch)),
        _best_by_clock(lambda: operator.simulate(batch)),
    )
    walk, tables = random_walk(1000), _tables(1000 // part)
    simulate_models(tables[:2], walk, compiled=True)
    each_s = _best(lambda: [Preisach(t, compiled=True).simulate(walk) for t in tables])
    models_s = _best(lambda: simulate_models(tables, walk, compiled=True))
    short, inputs = random_walk(100), random_walk(100).tolist()
    return {
        "batch_per_s": batch.size / batch_s,
        "batch_over_calls": rows_s / batch_s,
        "threads_gain": batch_s / clock_s,
        "models_per_s": len(tables) * walk.size / models_s,
        "models_over_calls": each_s / models_s,
        "call_of_100_us": 1e4 * _best(lambda: [operator.simulate(short) for _ in range(100)]),
        "step_us": 1e4 * _best(lambda: [operator.step(v) for v in inputs]),
    }


def _tables(count: int) -> list[FodTable]:
    """Tables on one partition of [−1, 1], as draws of a posterior are."""
    nodes, random = np.linspace(-1, 1, 12), np.random.default_rng(0)
    mass = random.random((count, 12, 12))
    below = np.cumsum(np.cumsum(mass, axis=1), axis=2)
    return [FodTable.from_arrays(nodes, nodes, np.where(np.tri(12, dtype=bool), y, np.nan)) for y in below]


def _best_by_clock(job: Callable[[], Any]) -> float:
    """The least seconds by the clock of three runs."""
    return min(timeit.repeat(job, number=1, repeat=3))


def _best(job: Callable[[], Any], times: int = 3) -> float:
    """The least processor seconds of several runs in one thread, since other processes only add to it."""
    least = float("inf")
    for _ in range(times):
        begin = time.process_time()
        job()
        least = min(least, time.process_time() - begin)
    return least
