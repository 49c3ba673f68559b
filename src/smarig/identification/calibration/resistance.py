"""R_M and R_A from voltage, current and position: V = i (R_M + ξ (R_A − R_M)), by least squares in volts.

ξ is the austenite fraction of a single wire from the position: 0 at one end of the session's travel and 1 at the other.
Each end is a median, because the extreme of a noisy position is not the end. A fit in volts weights each reading by its
current, which suits a constant voltage noise. Two wires (currents of both signs): ``two_wire_resistance``.
"""

from collections.abc import Sequence

import numpy as np

from smarig.core import Array
from smarig.identification.calibration.holds import valid_rows
from smarig.identification.calibration.two_wire_resistance import two_wire_resistances
from smarig.identification.interval_estimate import Estimate, linear_fit
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
