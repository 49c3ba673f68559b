"""What the numbers of a model file may be: a file with an impossible number is refused, not believed."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from smarig.core import DataError, shown
from smarig.record import is_timestamp

MOST_RUNS, MOST_WARNINGS, LONGEST_TEXT = 1000, 10_000, 10_000
_ERRORS = ("rms", "norm2", "weighted_norm2", "sse", "weighted_sse", "sigma")
_COUNTS = ("points", "curves", "starts")
_ROUNDING = 1e-3  # of correlations: parameters that the data hardly determine
_Row = Sequence[float | None]


def finite(value: Any, name: str) -> float:
    """The value as a number. Raises DataError if it is none, or not finite."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e300:
        raise DataError(f"{name} is {shown(value)}, expected a finite number")
    return float(value)


def not_negative(value: Any, name: str) -> None:
    """Raise DataError for anything but a finite number ≥ 0, or null for an unknown one."""
    if value is not None and finite(value, name) < 0:
        raise DataError(f"{name} is {shown(value)}, expected a number of 0 or more")


def count(value: Any, name: str) -> None:
    """Raise DataError for anything but an integer ≥ 0."""
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**63:
        raise DataError(f"{name} is {shown(value)}, expected an integer of 0 or more")


def check_covariance(parameters: Sequence[str], covariance: Sequence[_Row]) -> None:
    """Raise DataError unless it is a covariance: square, symmetric, no variance or eigenvalue below 0.

    An entry may be null, which means unknown.
    """
    size = len(parameters)
    if len(covariance) != size or any(len(row) != size for row in covariance):
        raise DataError(f"'covariance' is not {size} × {size}, one row for each of 'parameters'")
    if len(set(parameters)) != size:
        raise DataError("'parameters' names one of them twice")
    matrix = np.array(covariance, dtype=float).reshape(size, size)
    if np.isinf(matrix).any():
        raise DataError("'covariance' contains a number that is not finite")
    variance = np.diagonal(matrix)
    if (variance < 0).any():
        k = int(np.argmax(variance < 0))
        raise DataError(f"'covariance' has a variance below 0: {variance[k]:g} of '{parameters[k]}'")
    known = np.isfinite(matrix).all(axis=1) & (variance > 0)
    scale = np.sqrt(variance[known])
    correlation = matrix[np.ix_(known, known)] / np.outer(scale, scale)
    if (np.abs(correlation - correlation.T) > _ROUNDING).any():
        raise DataError("'covariance' is not symmetric")
    if correlation.size and np.linalg.eigvalsh(correlation).min() < -_ROUNDING:
        raise DataError("'covariance' is that of no parameters: it has an eigenvalue below 0")


def check_intervals(intervals: Mapping[str, tuple[float | None, float | None]]) -> None:
    """Raise DataError unless each interval has finite ends in order; null means unknown."""
    for name, ends in intervals.items():
        known = [finite(v, f"an end of the interval of '{name:.40}'") for v in ends if v is not None]
        if any(low > high for low, high in pairwise(known)):
            raise DataError(f"the interval of '{name:.40}' has its ends in the wrong order: {list(ends)}")


def check_fit(fit: Mapping[str, Any]) -> None:
    """Raise DataError for errors below 0, parts of points, and other impossible figures of a fit."""
    for key in _ERRORS:
        not_negative(fit.get(key), f"'fit.{key}'")
    for key in _COUNTS:
        count(fit.get(key, 0), f"'fit.{key}'")
    if "load" in fit and fit["load"] is not None:
        _check_load(fit["load"])
    for value in _numbers(fit):
        if not np.isfinite(value):
            raise DataError("'fit' contains a number that is not finite")


def _check_load(load: Any) -> None:
    if not isinstance(load, Mapping) or not isinstance(load.get("condition"), str):
        raise DataError("'fit.load' does not name its condition")
    values = load.get("values")
    if not isinstance(values, list) or not values:
        raise DataError("'fit.load.values' is not a list of numbers")
    numbers = [finite(v, "one of 'fit.load.values'") for v in values]
    if any(a >= b for a, b in pairwise(numbers)):
        raise DataError("'fit.load.values' do not increase")
    for key in ("between_rms", "beyond_rms"):
        not_negative(load.get(key), f"'fit.load.{key}'")


def check_constants(parameters: Mapping[str, Any]) -> None:
    """Raise DataError unless every constant of the wire is a positive number."""
    for section in parameters.values():
        for key, quantity in section.items() if isinstance(section, Mapping) else ():
            if isinstance(quantity, Mapping) and "value" in quantity:
                value = quantity["value"]
                if not finite(value, f"'{key!s:.40}' of the actuator") > 0:
                    raise DataError(f"'{key!s:.40}' of the actuator is {value:g}, expected a positive number")


def check_run(run: Any) -> None:
    """Raise DataError for an impossible number in the provenance of one run."""
    count(run.rows, "'rows' of a run in 'provenance'")
    if run.start_epoch is not None and not is_timestamp(run.start_epoch):
        raise DataError(f"'start_epoch' of a run in 'provenance' is no date: {run.start_epoch:g}")
    for name, condition in run.conditions.items():
        if not isinstance(condition.value, str):
            finite(condition.value, f"condition '{name:.40}' of a run in 'provenance'")


def check_sizes(file: Any) -> None:
    """Raise DataError for lists and texts that no page or message can show."""
    for name, value, most in (
        ("provenance", file.provenance, MOST_RUNS),
        ("warnings", file.warnings, MOST_WARNINGS),
    ):
        if len(value) > most:
            raise DataError(f"'{name}' has {len(value)} entries, more than {most}")
    signals = (file.input.quantity, file.input.unit, file.output.quantity, file.output.unit)
    for text in (file.name, file.rig, file.actuator.name, file.created, *signals, *file.warnings):
        if len(text) > LONGEST_TEXT:
            raise DataError(
                f"it contains a name or a warning of {len(text)} characters; the longest is {LONGEST_TEXT}"
            )


def _numbers(value: Any) -> Iterator[float]:
    """All numbers of a structure of JSON."""
    left = [value]
    while left:
        inner = left.pop()
        if isinstance(inner, Mapping):
            left += inner.values()
        elif isinstance(inner, list):
            left += inner
        elif isinstance(inner, float):
            yield inner
