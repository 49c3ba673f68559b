"""Checks of what an operator is given: one input, or a row of inputs."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import NOT_NUMBERS, Array, DataError, UsageError

NAN_INPUT = "The input of the Preisach operator is NaN."


def input_array(u: Sequence[float] | ArrayLike) -> Array:
    """Inputs (n,) as floats. UsageError for another shape, DataError for NaN."""
    inputs = vector(u, "The Preisach operator", "input")
    # The minimum is NaN if any input is; this needs no extra memory.
    if inputs.size and inputs.min() != inputs.min():
        where = int(np.argmax(np.isnan(inputs)))
        raise DataError(f"The input of the Preisach operator is NaN at sample {where}.")
    return inputs


def input_rows(u: Sequence[float] | ArrayLike) -> Array:
    """Inputs (n,), or (n, m) of a batch, as floats. UsageError for another shape, DataError for NaN."""
    try:
        rows = np.asarray(u, dtype=float)
    except NOT_NUMBERS:
        return input_array(u)  # says what is wrong
    if rows.ndim != 2:
        return input_array(rows)
    if rows.size and rows.min() != rows.min():
        row, sample = np.argwhere(np.isnan(rows))[0].tolist()
        raise DataError(f"Input {row} of the batch is NaN at sample {sample}.")
    return rows


def input_number(u: float) -> float:
    """One input as a float. UsageError if it is not a number, DataError for NaN."""
    try:
        nan = math.isnan(u)
    except NOT_NUMBERS:
        raise not_a_number(u) from None
    if nan:
        raise DataError(NAN_INPUT)
    return u


def not_a_number(u: object) -> UsageError:
    """The error for an input that is no number."""
    return UsageError(f"The Preisach operator needs a number as its input, got {u!r:.40}.")


def vector(values: Sequence[float] | ArrayLike, what: str, of: str) -> Array:
    """Values (n,) as floats. UsageError for another shape: ``what`` needs a one-dimensional ``of``."""
    try:
        row = np.asarray(values, dtype=float)
    except NOT_NUMBERS:
        raise UsageError(f"{what} needs a one-dimensional {of} of numbers below 1.8e308.") from None
    if row.ndim != 1:
        raise UsageError(f"{what} needs a one-dimensional {of}, got shape {row.shape}.")
    return row
