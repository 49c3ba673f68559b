"""Frozen relays drift towards the mean along the output's path: from minor loops that are repeated."""

from smarig.core import DataError
from smarig.identification.extended.accommodation_fit import identify_accommodation
from smarig.identification.extended.fitted_extension import ExtensionData, FittedExtension


def accommodating(data: ExtensionData) -> FittedExtension:
    """A drift of minor loops, of an amount κ along a path l of output."""
    fit = identify_accommodation(data.runs, data.hysteresis)
    if not 0 <= fit.amount.value <= 1:
        raise DataError(
            f"The amount of accommodation comes out as {fit.amount}, outside 0 … 1: repeated loops drift away from the "
            "mean, or not at all."
        )
    kept = {"kind": "accommodating", "amount": fit.amount.value, "path": fit.path.value}
    parameters = {"amount": fit.amount, "path": fit.path}
    return FittedExtension("drift of repeated minor loops", parameters, fit.p_value, kept)
