"""Identification of self-sensing: resistance from voltage and current of recorded runs, by least squares in volts.

    V = i Σ c_k φ_k(y, T, ξ)       y measured, T and ξ by the model from the current; one map for each wire

A fit in volts weights each reading by its current, which suits a constant voltage noise. The noise comes from
successive readings at one current; what else is left over is the error of the map. The errors of the predicted
position are divided into those of its input, output and lag by their dependence on slope y_δ and lag l,

    E (y − ŷ)² = y_δ² σ_δ² + σ_e² + l² σ_λ².

The error of a map is that of readings which were left out of its fit, in blocks of a 25th of the time.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import nnls

from smarig.control import (
    ONE_WIRE_TERMS,
    TWO_WIRE_TERMS,
    ResistanceMap,
    SelfSensing,
    WirePrediction,
    map_terms,
)
from smarig.core import Array, DataError
from smarig.identification.interval_estimate import linear_fit
from smarig.identification.sensing.sensed_run import SensedRun, sensed_run, sensing_actuator
from smarig.identification.sensing.sensing_errors import SensingErrors, errors_along
from smarig.record import Run
from smarig.replay import Model

LEAST_CURRENT = 0.05  # of the largest: a smaller current gives no reading
FIT_CURRENT = 0.1  # of the largest: readings of the fit
INPUT_ERROR = 0.02  # of the model's input range, at least: ambient and heat loss of later runs may differ
MAP_ERROR, MAP_TIME_S = 1e-3, 60.0  # of the resistance, and its correlation time, at least: contacts drift
OUTPUT_ERROR = 1e-3  # of the stroke, at least
LAG_ERROR = 0.01  # of the lag, at least
FOLDS, LEVEL = 5, 0.95
FEWEST = 100  # readings of a wire
LONGEST_CORRELATION_S = 600.0


def identify_sensing(model: Model, runs: Sequence[Run]) -> tuple[SelfSensing, list[SensingErrors]]:
    """Self-sensing for a model, and its errors along the same runs.

    Raises DataError if the runs do not determine the resistance of each wire of the rig.
    """
    prepared = [sensed_run(model, run) for run in runs]
    columns = [_Columns(model, run) for run in prepared]
    actuator, h = sensing_actuator(model), model.hysteresis
    stroke = abs(h.everett(h.upper, h.lower))
    largest_A = max(run.largest_A for run in prepared)
    if not largest_A > 0:
        raise DataError("No run has a current, so no resistance is known. Self-sensing needs heated runs.")
    wires, noises = zip(
        *(
            _wire_map(columns, wire, FIT_CURRENT * largest_A, two_wire=actuator.two_wire)
            for wire in range(2 if actuator.two_wire else 1)
        )
    )
    (input_K, output, lag), output_s = _prediction_errors(columns)
    sensing = SelfSensing(
        wires=wires,
        noise_V=max(noises),
        least_A=LEAST_CURRENT * largest_A,
        input_error_K=max(input_K, INPUT_ERROR * (h.upper - h.lower)),
        output_error=max(output, OUTPUT_ERROR * stroke),
        output_time_s=output_s,
        lag_error=max(lag, LAG_ERROR),
        interval_factor=1.0,
        reading_factor=1.0,
        stroke=stroke,
    )
    errors = errors_along(model, sensing, prepared)
    factors = (
        _widening([e.error_over_half for e in errors]),
        _widening([e.reading_over_half for e in errors]),
    )
    widened = replace(sensing, interval_factor=factors[0], reading_factor=factors[1])
    return widened, [e.widened(*factors) for e in errors]


def _widening(shares: Sequence[Array]) -> float:
    """The factor with which the intervals contain 95 % of the positions of each run, at least 1."""
    return max([1.0, *(float(np.quantile(s, LEVEL)) for s in shares if s.size)])


class _Columns:
    """A run with the model's prediction at every tick."""

    def __init__(self, model: Model, run: SensedRun) -> None:
        self.run, h = run, model.hysteresis
        offset_K = INPUT_ERROR * (h.upper - h.lower)
        prediction = WirePrediction(sensing_actuator(model), h, run.initial, run.period_s, offset_K)
        rows = []
        for current_A, position in zip(run.current_A.tolist(), run.position.tolist()):
            here, warmer, colder = prediction.step(current_A)
            prediction.corrected(position)
            rows.append((here.position, warmer.position, colder.position, prediction.lag, *here.wire))
        self.predicted, warm, cold, self.lag = np.array(rows).T[:4]
        self.states = np.array(rows)[:, 4:]
        self.per_K = (warm - cold) / (2 * offset_K)
        self.wire = np.array([prediction.wire_of(i) for i in run.current_A.tolist()])


def _wire_map(
    columns: Sequence[_Columns], wire: int, least_A: float, *, two_wire: bool
) -> tuple[ResistanceMap, float]:
    """The map of one wire and the standard deviation of a reading in volts."""
    segments: list[tuple[Array, Array]] = []
    for c in columns:
        used = (c.wire == wire) & (np.abs(c.run.current_A) > least_A) & np.isfinite(c.run.voltage_V)
        rows = np.flatnonzero(used)
        for k in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1) if rows.size else []:
            terms = map_terms(c.run.position[k], c.states[k], two_wire=two_wire)
            segments.append((c.run.current_A[k, None] * terms, c.run.voltage_V[k]))
    fit = linear_fit(segments) if segments else None
    if fit is None or fit.n < FEWEST:
        number = f" {wire + 1}" if two_wire else ""
        raise DataError(
            f"The runs do not determine the resistance of wire{number} at several positions and temperatures. "
            "Use runs that heat each wire over its whole range, such as first_order_descending."
        )
    names = TWO_WIRE_TERMS if two_wire else ONE_WIRE_TERMS
    left_V = _left_out(segments)
    noise_V = _white_noise([r for r in left_V if r.size > 1])
    current = np.concatenate([a[:, 0] for a, _ in segments])
    missed = float(np.mean((np.concatenate(left_V) / current) ** 2 - (noise_V / current) ** 2))
    ohm = float(np.median(np.concatenate([v for _, v in segments]) / current))
    return ResistanceMap(
        dict(zip(names, fit.x.tolist())),
        {k: (x - d, x + d) for k, x, d in zip(names, fit.x.tolist(), fit.half.tolist())},
        max(missed, 0.0) ** 0.5 + MAP_ERROR * ohm,
        max(_correlation_s(left_V, columns[0].run.period_s), MAP_TIME_S),
        fit.n,
    ), noise_V


def _left_out(segments: Sequence[tuple[Array, Array]]) -> list[Array]:
    """Residuals in volts of each segment by fits without the fifth of the readings that contains them."""
    ends = np.cumsum([v.size for _, v in segments])
    A, b = np.concatenate([a for a, _ in segments]), np.concatenate([v for _, v in segments])
    residual = np.empty(b.size)
    blocks = np.array_split(np.arange(b.size), FOLDS * FOLDS)
    for first in range(FOLDS):
        fold = np.concatenate(blocks[first::FOLDS])
        rest = np.ones(b.size, dtype=bool)
        rest[fold] = False
        residual[fold] = b[fold] - A[fold] @ np.linalg.lstsq(A[rest], b[rest], rcond=None)[0]
    return np.split(residual, ends[:-1])


def _white_noise(segments: Sequence[Array]) -> float:
    """From differences of neighbours, robust against the steps of the drive."""
    change = np.abs(np.concatenate([np.diff(r) for r in segments]))
    return max(float(np.median(change)) / 0.954, 1e-9)


def _prediction_errors(columns: Sequence[_Columns]) -> tuple[list[float], float]:
    """σ_δ in kelvin, σ_e in the unit of position and σ_λ, and the correlation time of the errors."""
    errors = [c.run.position - c.predicted for c in columns]
    square = np.concatenate(errors) ** 2
    slope = np.concatenate([c.per_K for c in columns])
    lag = np.concatenate([c.lag for c in columns])
    found = nnls(np.column_stack([slope**2, np.ones_like(slope), lag**2]), square)[0]
    return np.sqrt(found).tolist(), _correlation_s(errors, columns[0].run.period_s)


def _correlation_s(segments: Sequence[Array], period_s: float) -> float:
    """The lag at which the autocorrelation of the smoothed errors falls below 1/e; at least a second."""
    block = max(1, round(1.0 / period_s))  # means of a second: noise is not correlated
    means = [
        r[: r.size // block * block].reshape(-1, block).mean(axis=1) for r in segments if r.size >= block
    ]
    total = sum(float(m @ m) for m in means)
    longest = int(LONGEST_CORRELATION_S / (block * period_s))
    for lag in range(1, longest):
        if sum(float(m[:-lag] @ m[lag:]) for m in means if m.size > lag) < total / np.e:
            return lag * block * period_s
    return LONGEST_CORRELATION_S
