"""R_M and R_A from voltage, current and position: V = i (R_M + ξ (R_A − R_M)), by least squares in volts.

ξ is the austenite fraction of a single wire from the position: 0 at one end of the session's travel and 1 at the other.
Each end is a median, because the extreme of a noisy position is not the end. A fit in volts weights each reading by its
current, which suits a constant voltage noise. Two wires (currents of both signs): ``two_wire_resistances``.

R_M and R_A of two antagonist wires, where the phase of the heated wire is known whatever its hysteresis.

    V = i R_M (1 + a x + b x²)          while a wire that was cold is being heated, x small
    V = i R_A (1 + c (1 − x/x_max))     where it is as hot as in any of the runs
    x(t) = ∫ (i/i_max)² e^(−(t−s)/τ) ds/τ: its temperature relative to the steady one at the largest current

The position does not tell the phase of a wire: with both wires cold both are martensite, wherever the pulley stands
(thesis §5.5.1). So only the first moments of a heating are used, extrapolated to the cold wire, and the hottest ones,
which are taken to be austenite. Fits are in volts, which suits a constant voltage noise.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.identification.calibration.holds import valid_rows
from smarig.identification.interval_estimate import Estimate, LinearFit, linear_fit
from smarig.record import Run

_MIN_TRAVEL_SHARE = 0.8  # of the widest run's travel: a run with less does not show both phases
_SECOND_WIRE = 0.1  # of the largest current: more in the other direction flows through a second wire
_NAMES = {"R_M": "The martensite resistance R_M", "R_A": "The austenite resistance R_A"}


def resistances(runs: Sequence[Run], tau_s: float) -> dict[str, Estimate | str]:
    """``R_M`` and ``R_A``, each an Estimate or the sentence why the data do not determine it.

    ``tau_s`` is the time constant of the heating; a rough value will do.
    """
    electrical = [run for run in runs if run.has("voltage_V") and run.has("current_A")]
    if not electrical:
        return _unavailable("no run has both a measured voltage and a measured current")
    if any(_has_both_signs(run) for run in electrical):
        return two_wire_resistances([run for run in electrical if run.has("t_s")], tau_s)
    moved = [(run, _travel(run)) for run in electrical if run.has("position")]
    widest = max((travel for _, travel in moved), default=0.0)
    if widest == 0:
        return _unavailable(
            "no run with voltage and current has a position that moves, so the phase is not known"
        )
    used = [run for run, travel in moved if travel >= _MIN_TRAVEL_SHARE * widest]
    ends = _pooled(used, [_ends(run["position"]) for run in used])
    fit = linear_fit([_rows(run, low, high) for run, (low, high, _) in zip(used, ends)])
    if fit is None:
        return _unavailable("the readings with current do not cover both ends of the travel")
    # The uncertainty of the ends of the travel scales ξ, and so the difference R_A − R_M.
    end = 2 * max(noise / (high - low) for low, high, noise in ends) * float(abs(fit.x[1] - fit.x[0]))
    text = (
        f"voltage against current and position in {', '.join(run.path.name for run in used)}, phase fraction "
        f"0 and 1 at the ends of the travel, residual rms {fit.rms:.2g} V, widened for correlated residuals"
    )
    found: dict[str, Estimate | str] = {}
    for name, value, half in zip(_NAMES, fit.x.tolist(), np.hypot(fit.half, end).tolist()):
        found[name] = Estimate(value, (value - half, value + half), "ohm", text, fit.n)
    return found


def _has_both_signs(run: Run) -> bool:
    """Whether the current selects one of two wires by its sign. Noise around zero has both signs too."""
    low, high = run.extremes("current_A") or (0.0, 0.0)
    return low < -_SECOND_WIRE * high and high > -_SECOND_WIRE * low


def _unavailable(why: str) -> dict[str, Estimate | str]:
    return {name: f"{text} cannot be determined: {why}." for name, text in _NAMES.items()}


def _travel(run: Run) -> float:
    return float(np.nanmax(run["position"]) - np.nanmin(run["position"]))


def _ends(y: Array) -> tuple[float, float, float]:
    """Lower and upper end of the travel, each the median of the readings within noise of it, and that noise.

    The noise is that of neighbouring readings, at least their smallest step (a count).
    """
    y = y[np.isfinite(y)]
    change = np.abs(np.diff(y))
    noise = max(float(np.median(change)) / 0.954, float(change[change > 0].min()))
    band = 6 * noise
    return float(np.median(y[y <= y.min() + band])), float(np.median(y[y >= y.max() - band])), noise


def _pooled(runs: Sequence[Run], ends: list[tuple[float, float, float]]) -> list[tuple[float, float, float]]:
    """Common ends for runs of one session and encoder zero: the farthest of all."""
    sessions = [(run.info.start_epoch or id(run), run.info.encoder_zero) for run in runs]
    pooled = []
    for mine in sessions:
        same = [end for end, session in zip(ends, sessions) if session == mine]
        pooled.append((min(e[0] for e in same), max(e[1] for e in same), max(e[2] for e in same)))
    return pooled


def _rows(run: Run, low: float, high: float) -> tuple[Array, Array]:
    """Columns i (1 − ξ) and i ξ, whose coefficients are R_M and R_A, and the voltage."""
    i, v, y = run["current_A"], run["voltage_V"], run["position"]
    austenite = (y - low) / (high - low)
    keep = np.isfinite(i) & np.isfinite(v) & np.isfinite(austenite) & valid_rows(run)
    return np.column_stack([i * (1 - austenite), i * austenite])[keep], v[keep]


Segments = list[tuple[Array, Array]]
COLD, BARELY_WARM = 0.01, 0.12  # x of a cold wire, and up to which its heating is used
HOT = 0.9  # of the largest x
CURVATURE = 0.2  # of the change towards the hottest point, which a straight line may miss
MIN_CURRENT = 0.1  # of the largest: a smaller one determines no resistance


def two_wire_resistances(runs: Sequence[Run], tau_s: float) -> dict[str, Estimate | str]:
    """``R_M`` and ``R_A`` from runs with voltage and current, each an Estimate or a sentence."""
    most_A = max(float(np.nanmax(np.abs(run["current_A"]))) for run in runs)
    warmth = [_relative_temperatures(run, most_A, tau_s) for run in runs]
    hottest = max(float(x.max()) for x in warmth)
    names = ", ".join(run.path.name for run in runs)
    cold, hot = [], []
    for run, x in zip(runs, warmth):
        for wire, sign in enumerate((1.0, -1.0)):
            i, v = run["current_A"], run["voltage_V"]
            used = (sign * i > MIN_CURRENT * most_A) & np.isfinite(v) & valid_rows(run)
            cold += _segments(i, v, x[:, wire], used & _heated_from_cold(x[:, wire]), 3)
            hot += _segments(i, v, 1 - x[:, wire] / hottest, used & (x[:, wire] >= HOT * hottest), 2)
    found: dict[str, Estimate | str] = {}
    found["R_M"] = _estimate(
        _fit(cold),
        0.0,
        f"voltage against current in {names} at the start of heating a cold wire, extrapolated to its start",
        "The martensite resistance R_M cannot be determined: no cold wire is heated by a measured current in steps.",
    )
    found["R_A"] = _estimate(
        _fit(hot),
        1 - HOT,
        f"voltage against current in {names} where a wire is hottest, which is taken to be austenite",
        "The austenite resistance R_A cannot be determined: no wire stays hot.",
    )
    return found


def _relative_temperatures(run: Run, most_A: float, tau_s: float) -> Array:
    """x (n, 2) of both wires at each sample, cold before the first."""
    i = np.nan_to_num(run["current_A"]) / most_A
    dt_s = np.diff(run["t_s"], prepend=run["t_s"][0])
    decay = np.exp(-np.clip(dt_s, 0.0, None) / tau_s)
    power = np.column_stack([np.where(i > 0, i, 0.0) ** 2, np.where(i < 0, i, 0.0) ** 2])
    first = second = 0.0
    x = []
    for (p, q), d in zip(power.tolist(), decay.tolist()):
        first, second = p + (first - p) * d, q + (second - q) * d
        x.append((first, second))
    return np.array(x)


def _heated_from_cold(x: Array) -> NDArray[np.bool_]:
    """Rows at which a wire has only been heated since it was cold, and little."""
    since_cold, largest = np.empty(x.size), 0.0
    for k, now in enumerate(x.tolist()):
        largest = now if now < COLD else max(largest, now)
        since_cold[k] = largest
    return (since_cold <= BARELY_WARM) & (x >= since_cold)


def _segments(i: Array, v: Array, x: Array, used: NDArray[np.bool_], order: int) -> Segments:
    """Rows of each uninterrupted segment: i, i x, i x² up to ``order`` columns, and the voltage."""
    rows = np.flatnonzero(used)
    segments = np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1) if rows.size else []
    return [(np.column_stack([i[k] * x[k] ** p for p in range(order)]), v[k]) for k in segments]


def _fit(segments: Segments) -> LinearFit | None:
    """With as many powers of x as the rows determine, at least the resistance alone."""
    if not segments:
        return None
    for columns in range(segments[0][0].shape[1], 0, -1):
        fit = linear_fit([(a[:, :columns], v) for a, v in segments])
        if fit is not None:
            return fit
    return None


def _estimate(fit: LinearFit | None, range_x: float, source: str, otherwise: str) -> Estimate | str:
    """The resistance with its interval, which holds a share of the change over the range of x that was used."""
    if fit is None:
        return otherwise
    bend = CURVATURE * range_x * abs(float(fit.x[1])) if fit.x.size > 1 else 0.0
    value, half = float(fit.x[0]), float(np.hypot(fit.half[0], bend))
    text = f"{source}, residual rms {fit.rms:.2g} V, widened for correlated residuals"
    return Estimate(value, (value - half, value + half), "ohm", text, fit.n)
