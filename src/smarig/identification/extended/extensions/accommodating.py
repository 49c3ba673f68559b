"""The accommodation model: minor loops drift towards the mean along the output's path; identified from repeated
loops.
"""

from smarig.core import DataError
from smarig.identification.extended.accommodation_fit import identify_accommodation
from smarig.identification.extended.fitted_extension import ExtensionData, FittedExtension


def accommodating(data: ExtensionData) -> FittedExtension:
    """The drift of minor loops, with amount κ along an output path l."""
    fit = identify_accommodation(data.runs, data.hysteresis)
    if not 0 <= fit.amount.value <= 1:
        raise DataError(
            f"The amount of accommodation is {fit.amount}, outside 0 … 1: repeated loops drift away from the "
            "mean or do not drift."
        )
    kept = {"kind": "accommodating", "amount": fit.amount.value, "path": fit.path.value}
    parameters = {"amount": fit.amount, "path": fit.path}
    return FittedExtension("drift of repeated minor loops", parameters, fit.p_value, kept)
