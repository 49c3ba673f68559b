"""Whether the output is a function of the input, so that the data show no hysteresis.

A curve of means, with as many nodes as predict left-out readings best, answers three questions:

    do its errors depend on the direction of the input?      a loop that is open
    does the model predict held-out readings better?         any other memory
    is its error that of a good model?                       other variables, drift

If the first two are answered with no and the third with yes, the data show no hysteresis. The first two count
differences of more than three standard errors over blocks of readings.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, root_mean_square
from smarig.identification import (
    ErrorLevel,
    RunVerification,
    error_verdict,
)
from smarig.measurement import output_noise_sd
from smarig.study.baselines import RunPoints, curve_of_means
from smarig.study.candidate_models import CandidateModel, compared_points, noise_of_repeats
from smarig.study.data_split import DataSplit
from smarig.study.error_reasons import one_way

Curve = tuple[Array, Array]
_FEWEST_NODES = 5
_FOLDS, _BLOCKS = 5, 20
_STANDARD_ERRORS = 3.0
_SEED = 3


@dataclass(frozen=True, eq=False)
class FunctionOfInput:
    """The curve, as nodes u and y (k,) joined by lines, with its rms error on data that it was not fitted to.

    ``noise`` is that of a reading; ``model_rms`` the error of the best model on held-out data, or of its fit if nothing
    is held out. ``lag_s`` is the time by which the input acts late, 0 if it does not; then u are inputs as they act.
    """

    u: Array
    y: Array
    rms: float
    noise: float
    model_rms: float
    lag_s: float = 0.0
    lag_ci95: tuple[float, float] = (0.0, 0.0)

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        errors = {"rms": self.rms, "noise": self.noise, "model_rms": self.model_rms}
        lag = {"lag_s": {"value": self.lag_s, "ci95": list(self.lag_ci95)}} if self.lag_s else {}
        return {"input": self.u.tolist(), "output": self.y.tolist(), **errors, **lag}


def function_of_input(best: CandidateModel, split: DataSplit) -> FunctionOfInput | None:
    """The output as a function of the input; None if the data show hysteresis, or dependence on something else."""
    if split.kind == "load" or one_way(best):  # noise goes back too, but shows no way back
        return None
    train, held_out = ([compared_points(r) for r in runs] for runs in (best.train, best.held_out))
    u, y, way = (np.concatenate([getattr(p, k)[p.counted] for p in train]) for k in ("u", "y", "direction"))
    if min((way > 0).sum(), (way < 0).sum()) < _FOLDS * _FEWEST_NODES or not np.ptp(u):
        return None
    noise, span = noise_of(best, train), float(np.ptp(y))
    folds = np.random.default_rng(_SEED).permutation(u.size) % _FOLDS
    count = _best_count(u, y, folds)
    if _by_direction(u, _by_fold(u, y, folds, count, _plain), way > 0):
        return None
    finest = {k: _by_fold(u, y, folds, k, _errors) for k in (count, u.size)}  # a jump needs every reading
    count, errors = min(finest.items(), key=lambda pair: float(np.mean(pair[1] ** 2)))
    curve = curve_through(u, y, count)
    if split.kind != "none":
        pairs = [_held_out_errors(run, points, curve) for run, points in zip(best.held_out, held_out)]
        of_model, errors = (np.concatenate(part) for part in zip(*pairs))
        if stands_out(errors**2 - of_model**2):
            return None
    rms = root_mean_square(errors)
    good = error_verdict(rms, noise, rms / span if span else np.nan).level is ErrorLevel.GOOD
    return FunctionOfInput(*curve, rms, noise, best.rms) if good else None


def _best_count(u: Array, y: Array, folds: NDArray[np.int64]) -> int:
    """The number of nodes that predicts left-out readings best; at most one for each reading."""
    counts = [_FEWEST_NODES * 2**k for k in range(64) if _FEWEST_NODES * 2 ** (k + 1) <= u.size]
    return min(
        [*counts, u.size], key=lambda count: float(np.abs(_by_fold(u, y, folds, count, _plain)).mean())
    )


def _by_fold(
    u: Array, y: Array, folds: NDArray[np.int64], count: int, errors: Callable[[Array, Array, Curve], Array]
) -> Array:
    """The errors (n,) of curves with ``count`` nodes, each at the readings of a fold that it was not fitted to."""
    out = np.empty_like(y)
    for fold in range(_FOLDS):
        kept = folds != fold
        out[~kept] = errors(u[~kept], y[~kept], curve_through(u[kept], y[kept], count))
    return out


def curve_through(u: Array, y: Array, count: int) -> Curve:
    """The means in ``count`` intervals, and the ends of the lines through the outermost of them: a mean lies inside its
    interval, where a steep curve is far from its end.
    """
    nodes, means = curve_of_means(u, y, count)
    ends = [_end(nodes[:2], means[:2], u.min()), _end(nodes[-2:][::-1], means[-2:][::-1], u.max())]
    return np.r_[u.min(), nodes, u.max()], np.r_[ends[0], means, ends[1]]


def _end(nodes: Array, means: Array, at: float) -> float:
    """The line through the first two nodes, at a place."""
    run = float(np.ptp(nodes))
    return float(
        means[0] + (means[1] - means[0]) / (nodes[1] - nodes[0]) * (at - nodes[0]) if run else means[0]
    )


def _plain(u: Array, y: Array, curve: Curve) -> Array:
    """Outputs minus those on the lines between the nodes."""
    return y - np.interp(u, *curve)


def _errors(u: Array, y: Array, curve: Curve) -> Array:
    """How far outputs lie outside those of the nodes on both sides: between two nodes a function may jump anywhere."""
    nodes, means = curve
    k = np.searchsorted(nodes, u)
    before, after = means[np.maximum(k - 1, 0)], means[np.minimum(k, nodes.size - 1)]
    return y - np.clip(y, np.minimum(before, after), np.maximum(before, after))


def _held_out_errors(run: RunVerification, points: RunPoints, curve: Curve) -> tuple[Array, Array]:
    """The errors of the model and of the curve on a held-out run; about their means where the zero is free."""
    rows = points.counted
    of_model = points.y[rows] - run.predicted[rows]
    of_curve = _errors(points.u[rows], points.y[rows], curve)
    if run.offset_kind == "fitted" and rows.any():
        return of_model - of_model.mean(), of_curve - of_curve.mean()
    return of_model, of_curve


def _by_direction(u: Array, errors: Array, rising: NDArray[np.bool_]) -> bool:
    """Whether errors (n,) differ between rising and falling input: χ² of the difference over intervals of u."""
    squares = []
    for rows in np.array_split(np.argsort(u, kind="stable"), _BLOCKS):
        up, down = errors[rows[rising[rows]]], errors[rows[~rising[rows]]]
        if min(up.size, down.size) > 1:
            variance = up.var(ddof=1) / up.size + down.var(ddof=1) / down.size
            squares.append((up.mean() - down.mean()) ** 2 / variance if variance > 0 else 0.0)
    freedom = len(squares)
    return sum(squares) > freedom + _STANDARD_ERRORS * np.sqrt(2 * freedom)


def stands_out(x: Array) -> bool:
    """Whether the mean of x (n,) is above 0 by more than chance, over blocks of readings."""
    blocks = np.array([part.mean() for part in np.array_split(x, _BLOCKS) if part.size])
    return bool(blocks.mean() > _STANDARD_ERRORS * blocks.std(ddof=1) / np.sqrt(blocks.size))


def noise_of(best: CandidateModel, train: Sequence[RunPoints]) -> float:
    """The noise of a reading: from repeated readings, else from neighbouring ones."""
    known = noise_of_repeats(best.held_out)
    return known[0] if known is not None else float(np.median([output_noise_sd(p.u, p.y) for p in train]))
