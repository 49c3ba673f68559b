"""Accuracy and speed of ``positive`` on unseen curves, compared with plain non-negative least squares.

The training data are about 600 points on 20 of the published curves (``synthetic_curves``) at 0.1 % noise.
The other curves, noise-free, are predicted. The baseline is ``scipy.optimize.nnls`` on the raw masses of
regular grids of several sizes, as relays at the centres of cells and as cells of constant density. It has no
prior, so its result depends on the grid. Seconds are processor time. The table also shows the convergence
when the triangle is refined.
"""

from time import process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from benchmarks.synthetic_curves import NODES, curves
from smarig.identification import Observations, fit_positive

Array = NDArray[np.float64]
NOISE = 0.001
EVERY, SEEDS, REPEATS = 5, 5, 3
GRIDS = (15, 30, 40)  # intervals of the raw grids: 120, 465 and 820 cells
FINE = 24  # intervals of the triangle, computed in a fifth of a second


def run(quick: bool = False) -> dict[str, Any]:
    """Mean held-out rms error over the seeds, best of ``REPEATS`` times, and ratios to the best raw grid.

    ``{"training_points", "held_out_points", "noise", "seeds", "results": [{"method", "unknowns", "rms",
    "seconds"}], "rms_ratio", "refinement": [{"intervals", "change"}]}``; rms in output units, where the
    range is about 2 × saturation; ``change`` is the rms difference to the predictions of the next finer
    triangle.
    """
    seeds = range(1 if quick else SEEDS)
    rows = [_row("positive", _positive, seeds)]
    rows += [
        _row(f"nnls_{kind}", _nnls_method(n, design), seeds)
        for kind, design in _DESIGNS.items()
        for n in GRIDS
    ]
    best = min(row["rms"] for row in rows[1:])
    train, test = _split(0)
    return {
        "training_points": train[2].size,
        "held_out_points": test[2].size,
        "noise": NOISE,
        "seeds": len(seeds),
        "results": rows,
        "rms_ratio": rows[0]["rms"] / best,
        "refinement": _refinement((10, 20, 40) if quick else (10, 20, 40, 80)),
    }


def _split(seed: int) -> tuple[tuple[Array, Array, Array], tuple[Array, Array, Array]]:
    """Every second point of every fifth curve, with noise; and all points of the other curves without noise."""
    alpha, beta, y = curves(NOISE, seed)
    exact = curves()[2]
    row, column = (np.rint((u + 1) / 2 * (NODES - 1)).astype(int) for u in (alpha, beta))
    train = (row % EVERY == 0) & ((column % 2 == 0) | (column == row)) & (row > 0)
    test = row % EVERY != 0
    return (alpha[train], beta[train], y[train]), (alpha[test], beta[test], exact[test])


def _row(name: str, method, seeds: range) -> dict[str, Any]:
    errors, seconds = [], []
    unknowns = 0
    for seed in seeds:
        train, (alpha, beta, exact) = _split(seed)
        predict, unknowns = method(*train)
        for _ in range(REPEATS):
            begin = process_time()
            method(*train)
            seconds.append(process_time() - begin)
        errors.append(float(np.sqrt(np.mean((predict(alpha, beta) - exact) ** 2))))
    return {"method": name, "unknowns": unknowns, "rms": float(np.mean(errors)), "seconds": min(seconds)}


def _observed(alpha: Array, beta: Array, y: Array) -> Observations:
    curve = np.unique(alpha, return_inverse=True)[1].astype(np.int64)
    return Observations.of_points(alpha, beta, y, curve, (-1.0, 1.0))


def _positive(alpha: Array, beta: Array, y: Array):
    fit = fit_positive(_observed(alpha, beta, y), intervals=FINE)
    return fit.y, fit.cells


def _relays(intervals: int, alpha: Array, beta: Array) -> Array:
    """1 if the relay at the centre of a cell is on: y = y₋ + Σ ν of those."""
    middle = (np.arange(intervals) + 0.5) * 2 / intervals - 1
    i, j = np.tril_indices(intervals)
    return ((middle[i] <= alpha[:, None]) & (middle[j] < beta[:, None])).astype(float)


def _cells(intervals: int, alpha: Array, beta: Array) -> Array:
    """The part of each cell below and left of (α, β); on the diagonal, the part of its length."""
    edges = np.linspace(-1.0, 1.0, intervals + 1)
    i, j = np.tril_indices(intervals)
    share_a, share_b = (np.clip((u[:, None] - edges[:-1]) * intervals / 2, 0.0, 1.0) for u in (alpha, beta))
    return np.where(i == j, np.minimum(share_a[:, i], share_b[:, j]), share_a[:, i] * share_b[:, j])


_DESIGNS = {"relays": _relays, "cells": _cells}


def _nnls_method(intervals: int, design):
    def method(alpha: Array, beta: Array, y: Array):
        low = float(y.min())
        rows = design(intervals, alpha, beta)
        masses, _ = nnls(rows, y - low, maxiter=20 * rows.shape[1])
        return lambda a, b: low + design(intervals, a, b) @ masses, rows.shape[1]

    return method


def _refinement(intervals: tuple[int, ...]) -> list[dict[str, float]]:
    train, (alpha, beta, _) = _split(0)
    observations = _observed(*train)
    outputs = [fit_positive(observations, intervals=n, smoothing=1e-12).y(alpha, beta) for n in intervals]
    changes = [float(np.sqrt(np.mean((b - a) ** 2))) for a, b in zip(outputs, outputs[1:])]
    return [{"intervals": n, "change": change} for n, change in zip(intervals, changes)]
