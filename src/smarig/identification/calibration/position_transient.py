"""τ from position transients with a known hysteresis: the trajectory is simulated for each τ and compared.

The chain is current → heating (5.1) with time constant τ → Preisach operator → position. In each hold the mean
difference from the measured position is removed, so neither the encoder's zero nor the model's error in steady
state counts; only the shape of the approach does. The fit needs R/hA (the actuator's) and the memory at the start
of a run (its record names it, or it continues the previous run).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import fminbound

from smarig.core import Array
from smarig.identification.calibration.holds import drive_holds, valid_rows
from smarig.identification.interval_estimate import Estimate, quantile, variance_inflation
from smarig.measurement import Start
from smarig.plant import Actuator, JouleHeating
from smarig.preisach import Everett, Preisach
from smarig.record import Run, continues_run
from smarig.replay import recorded_start

_LONGEST = 40_000  # samples simulated: dozens of holds, a few seconds of computing
_FACTOR = 30.0  # τ is searched within this factor of the actuator's value
_LEAST_TRIALS = 13  # of τ: so often each session is simulated before the search is refined
_STEP = 0.02  # of log τ, for the derivative


@dataclass(frozen=True, eq=False)
class _SessionSegment:
    """One session: steady inputs of the currents and times (n,) from a known state, positions, and the holds."""

    source_K: list[float]
    dt_s: Array
    position: Array
    start: Start
    windows: tuple[NDArray[np.int64], ...]


def tau_from_position(runs: Sequence[Run], actuator: Actuator, hysteresis: Everett) -> Estimate | str:
    """τ as an Estimate, or the sentence why the runs do not determine it."""
    segments = _session_segments(runs, actuator)
    count = sum(len(s.windows) for s in segments)
    if not count:
        return (
            "The time constant τ cannot be determined from position: no run that begins in a known state has "
            "current, position and a clock, and a step of the current that is then held."
        )

    def errors(log_tau: float) -> list[Array]:
        return [e for s in segments for e in _errors(s, math.exp(log_tau), actuator, hysteresis)]

    log_tau = _best_log_tau(errors, math.log(actuator.tau_s))
    if log_tau is None:
        return (
            f"The time constant τ cannot be determined from position: no value within a factor {_FACTOR:g} of the "
            f"actuator's {actuator.tau_s:.3g} s follows the transients best; the model or R/hA does not fit."
        )
    slope = [(b - a) / (2 * _STEP) for a, b in zip(errors(log_tau - _STEP), errors(log_tau + _STEP))]
    names = ", ".join(run.path.name for run in runs)
    return _estimate(log_tau, errors(log_tau), slope, f"position in {count} holds of {names}, simulated")


def _best_log_tau(errors: Callable[[float], list[Array]], guess: float) -> float | None:
    """log τ of least squares; None if it lies at the end of the searched range."""

    def square(log_tau: float) -> float:
        return sum(float(e @ e) for e in errors(log_tau))

    coarse = guess + np.linspace(-1, 1, _LEAST_TRIALS) * math.log(_FACTOR)
    k = int(np.argmin([square(x) for x in coarse]))
    if k in (0, coarse.size - 1):
        return None
    return np.asarray(fminbound(square, coarse[k - 1], coarse[k + 1], xtol=1e-4), dtype=float).item()


def _estimate(log_tau: float, errors: list[Array], slope: list[Array], text: str) -> Estimate | str:
    square = sum(float(e @ e) for e in errors)
    curvature = sum(float(g @ g) for g in slope)
    n = sum(e.size for e in errors)
    # Late readings of a hold do not depend on τ: only readings with a derivative count.
    effective_n = curvature**2 / max(sum(float(g**2 @ g**2) for g in slope), 1e-300)
    weighted = [g * e for g, e in zip(slope, errors)]
    score = sum(float(w @ w) for w in weighted)
    f = variance_inflation(weighted)
    if curvature == 0:
        return "The time constant τ cannot be determined from position: the transients do not depend on it."
    spread = math.sqrt(max(score * f, square / n * curvature)) / curvature
    half = quantile(effective_n / f - 1) * spread
    if not half < math.log(_FACTOR):
        return (
            "The time constant τ cannot be determined from position: its 95 % interval is wider than the range of the "
            "search. Measure faster transients, or check the model and R/hA of the actuator."
        )
    tau = math.exp(log_tau)
    ends = (tau * math.exp(-half), tau * math.exp(half))
    return Estimate(tau, ends, "s", f"{text}, interval widened for correlated residuals", n)


def _session_segments(runs: Sequence[Run], actuator: Actuator) -> list[_SessionSegment]:
    """Runs from a known state, each with the runs that continue it, up to the limit of samples."""
    sessions: list[list[Run]] = []
    for k, run in enumerate(runs):
        usable = run.has("current_A") and run.has("position") and run.has("t_s")
        if usable and recorded_start(run) is not None:
            sessions.append([run])
        elif (
            usable and k and sessions and sessions[-1][-1] is runs[k - 1] and continues_run(runs[k - 1], run)
        ):
            sessions[-1].append(run)
    found, remaining = [], _LONGEST
    for session in sessions:
        segment = _joined_segment(session, remaining, actuator)
        remaining -= len(segment.source_K)
        found.append(segment)
        if remaining <= 0:
            break
    return found


def _joined_segment(session: list[Run], limit: int, actuator: Actuator) -> _SessionSegment:
    t, i, y, keep = (
        np.concatenate(parts)[:limit]
        for parts in zip(
            *[(run["t_s"], run["current_A"], run["position"], valid_rows(run)) for run in session]
        )
    )
    known = np.isfinite(t) & np.isfinite(i)
    windows, offset = [], 0
    for run in session:
        for hold in drive_holds(run):
            rows = np.arange(hold.begin + offset, hold.end + offset)
            rows = rows[rows < t.size]
            rows = rows[keep[rows] & known[rows] & np.isfinite(y[rows])]
            if rows.size >= 10:
                windows.append(rows)
        offset += len(run)
    filled_t = np.interp(np.arange(t.size), np.flatnonzero(known), t[known]) if known.any() else t
    first = float(np.median(np.diff(filled_t))) if t.size > 1 else 0.0
    start, heating = recorded_start(session[0]) or "negative", JouleHeating(actuator, 1.0)
    source_K = [heating.source(current) for current in np.nan_to_num(i).tolist()]
    return _SessionSegment(
        source_K, np.diff(filled_t, prepend=filled_t[:1] - first), y, start, tuple(windows)
    )


def _errors(s: _SessionSegment, tau_s: float, actuator: Actuator, hysteresis: Everett) -> list[Array]:
    """Model minus measurement in each hold, without its mean."""
    samples = _LEAST_TRIALS * len(s.source_K)
    operator = Preisach(hysteresis, s.start, samples=samples)
    difference = operator.follow(_hysteresis_inputs_K(s, tau_s, actuator)) - s.position
    return [difference[w] - difference[w].mean() for w in s.windows]


def _hysteresis_inputs_K(s: _SessionSegment, tau_s: float, actuator: Actuator) -> list[float]:
    """The hysteresis input at each sample, kelvin."""
    heating, inputs_K = JouleHeating(actuator, 1.0), []
    for source_K, decay in zip(s.source_K, np.exp(-np.maximum(s.dt_s, 0.0) / tau_s).tolist()):
        heating.decay = decay
        inputs_K.append(heating.relax(source_K))
    return inputs_K
