"""The nonlinear model: weights depend on the present input, so loops keep equal vertical chords only; from
second-order curves.
"""

from smarig.identification.extended.fitted_extension import ExtensionData, FittedExtension
from smarig.identification.extended.nonlinear_fit import excess_values, fitted_excess, largest_excess


def nonlinear(data: ExtensionData) -> FittedExtension:
    """The excess Q(α, β, u) at every corner of the staircase."""
    fit = fitted_excess(data)
    return FittedExtension(
        "weights that depend on the present input",
        {"largest_excess": largest_excess(fit, data.unit)},
        fit.p_value,
        {"kind": "nonlinear", **excess_values(fit)},
    )
