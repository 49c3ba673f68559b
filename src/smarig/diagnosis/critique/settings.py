"""Checks of what a user asks of a critique: the false alarm probability, the null data sets and the seed."""

from smarig.core import UsageError
from smarig.diagnosis.critique.calibration import LEAST_P

MAX_NULL_DATA_SETS = 100_000  # a larger number is a typing error


def check_settings(alpha: float, nulls: int, seed: int) -> None:
    """Raise UsageError for a false alarm probability, a number of null data sets or a seed that cannot be used."""
    if not LEAST_P <= alpha < 0.5:
        raise UsageError(
            f"The false alarm probability must lie between {LEAST_P:g} and 0.5, but is {alpha:g}."
        )
    if seed < 0:
        raise UsageError(f"Seed {seed} is negative. Give a whole number ≥ 0.")
    if nulls > MAX_NULL_DATA_SETS:
        raise UsageError(f"{nulls} null data sets are too many. Use at most {MAX_NULL_DATA_SETS}.")
    if nulls < 1 / alpha:
        raise UsageError(
            f"{nulls} null data sets cannot resolve a probability of {alpha:g}. Use at least {int(1 / alpha) + 1}."
        )
