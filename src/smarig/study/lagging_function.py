"""Whether the output is a function of an input that reaches the specimen late, so that its loop is no hysteresis.

The input as it acts is v with dv/dt = (u − v)/τ. The lag τ is that with which a curve of v leaves least of the fitted
output. A loop of a state keeps its width at every rate, and in a hold; that of a lag does not. So the data tell both
apart if they hold several rates or holds, and the curve is taken only if it predicts the held-out data far better than
a model of hysteresis does: as well as the noise allows, or so well that no loop is left.
"""

from collections.abc import Sequence

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.identification import ErrorLevel, error_verdict
from smarig.record import Run
from smarig.study.candidate_models import CandidateModel, compared_points
from smarig.study.data_split import DataSplit
from smarig.study.error_reasons import one_way
from smarig.study.function_of_input import FunctionOfInput, curve_through, noise_of

_MOST_ROWS = 20_000  # of all runs: blocks of more readings are averaged
_NODES = 40  # of the curve while the lag is searched
_LAGS = np.geomspace(1e-4, 0.1, 25)  # of the length of a record, from which the search begins
_SETTLED = 5.0  # lags from the start of a record on, in which the input that acted before it still counts
_FAR_LESS, _NOTHING = (
    0.5,
    0.1,
)  # of the error of the model: an error that is noise, and one that leaves no loop
_BLOCKS = 10  # of the readings, each left out once for the interval of the lag

Record = tuple[Array, Array, Array]  # times, inputs and outputs (n,)


def lagging_function(best: CandidateModel, split: DataSplit) -> FunctionOfInput | None:
    """The output as a function of the late input, with the lag and its interval; None if the data do not show it."""
    if split.kind not in ("run", "time") or one_way(best):
        return None
    train, held = (_records(runs) for runs in (split.train, split.held_out))
    if not train or len(train) < len(split.train) or len(held) < len(split.held_out):
        return None
    lag = _best_lag(train)
    if lag is None:
        return None
    v, y = _late(train, lag)
    curve = curve_through(v, y, min(_NODES, max(v.size // 4, 1)))
    own = root_mean_square(y - np.interp(v, *curve))
    parts = [_late([record], lag) for record in held]
    errors = np.concatenate([y - np.interp(v, *curve) for v, y in parts])
    whole = [sum(t.size for t, _, _ in records) for records in (train, held)]
    if 2 * y.size < whole[0] or 2 * errors.size < whole[1]:
        return None  # the start of a record fades, and what is left of it is no test
    noise = noise_of(best, [compared_points(r) for r in best.train])
    span, rms = float(np.ptp(y)), root_mean_square(errors)
    pairs = ((own, best.train_rms), (rms, best.rms))
    if not all(_is_better(error, of_model, noise, span) for error, of_model in pairs):
        return None
    interval = _interval(train, lag)
    if interval[0] <= 0:
        return None
    return FunctionOfInput(*curve, rms, noise, best.rms, lag_s=lag, lag_ci95=interval)


def _is_better(rms: float, of_model: float, noise: float, span: float) -> bool:
    """Whether a curve leaves far less than the model, and noise, or so little that no loop is left."""
    good = error_verdict(rms, noise, rms / span if span else np.nan).level is ErrorLevel.GOOD
    return rms <= (_FAR_LESS if good else _NOTHING) * of_model


def _records(runs: Sequence[Run]) -> list[Record]:
    """The readings of runs with a clock, in blocks if they are many."""
    found = []
    size = -(-sum(len(run) for run in runs) // _MOST_ROWS)
    for run in runs:
        if not run.has("t_s") or run.settled:
            continue
        t, u, y = (run[name] for name in ("t_s", "input", "position"))
        known = np.isfinite(t) & np.isfinite(u) & np.isfinite(y)
        t, u, y = (x[known][: known.sum() // size * size].reshape(-1, size).mean(axis=1) for x in (t, u, y))
        if t.size > 2 * _NODES and (np.diff(t) > 0).all():
            found.append((t, u, y))
    return found


def _late(records: Sequence[Record], lag: float) -> tuple[Array, Array]:
    """The inputs that acted and the outputs (n,), from when the start of each record has faded."""
    parts = []
    for t, u, y in records:
        v = _following(t, u, lag)
        kept = t >= t[0] + _SETTLED * lag
        parts.append((v[kept], y[kept]))
    return np.concatenate([v for v, _ in parts]), np.concatenate([y for _, y in parts])


def _following(t: Array, u: Array, lag: float) -> Array:
    """The solution (n,) of dv/dt = (u − v)/lag, from rest, for inputs with straight lines between them."""
    steps = np.diff(t) / lag
    fading = np.exp(-steps)
    share = np.divide(1 - fading, steps, out=np.ones_like(steps), where=steps > 1e-9)
    gain = (u[1:] * (1 - share) + u[:-1] * (share - fading)).tolist()
    v, out = float(u[0]), [float(u[0])]
    for kept, added in zip(fading.tolist(), gain):
        v = kept * v + added
        out.append(v)
    return np.array(out)


def _left(records: Sequence[Record], lag: float) -> float:
    """The rms of the outputs about a curve of the late input."""
    v, y = _late(records, lag)
    if v.size < 4 * _NODES:
        return np.inf
    return root_mean_square(y - np.interp(v, *curve_through(v, y, _NODES)))


def _best_lag(records: Sequence[Record]) -> float | None:
    """The lag that leaves least; None if it is at an end of what was searched."""
    from scipy.optimize import minimize_scalar  # imported here: takes half a second

    length = max(float(t[-1] - t[0]) for t, _, _ in records)
    left = [_left(records, lag * length) for lag in _LAGS]
    k = int(np.argmin(left))
    if not 0 < k < _LAGS.size - 1:
        return None
    ends = np.log(_LAGS[[k - 1, k + 1]] * length)
    found = minimize_scalar(
        lambda x: _left(records, np.exp(x)), bounds=ends, method="bounded", options={"xatol": 1e-3}
    )
    return float(np.exp(found.x))


def _interval(records: Sequence[Record], lag: float) -> tuple[float, float]:
    """The 95 % interval of the lag, by leaving out each block of readings once, and half a step between readings."""
    size = sum(t.size for t, _, _ in records)
    number = np.arange(size) * _BLOCKS // size
    starts = np.cumsum([0, *(t.size for t, _, _ in records)])
    found = []
    for block in range(_BLOCKS):
        kept = [
            (t, u, np.where(number[a : a + t.size] == block, np.nan, y))
            for a, (t, u, y) in zip(starts, records)
        ]
        found.append(_lag_near(kept, lag))
    spread = 2.262 * float(np.sqrt((_BLOCKS - 1) * np.var(found)))  # Student's t of nine degrees of freedom
    spread += max(float(np.median(np.diff(t))) for t, _, _ in records) / 2
    return lag - spread, lag + spread


def _lag_near(records: Sequence[Record], lag: float) -> float:
    """The lag that leaves least of the known outputs, by a parabola through three lags."""
    lags = lag * np.array([0.9, 1.0, 1.1])
    squares = []
    for each in lags:
        v, y = _late(records, float(each))
        known = np.isfinite(y)
        curve = curve_through(v[known], y[known], _NODES)
        squares.append(float(np.mean((y[known] - np.interp(v[known], *curve)) ** 2)))
    a, b, _ = np.polyfit(lags - lag, squares, 2)
    return lag - b / (2 * a) if a > 0 else lag
