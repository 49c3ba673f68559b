"""The restricted model: weights depend on the first past maximum (order 1), so loops are congruent only after the
same one.

It is identified from second-order curves, like the nonlinear model. A higher order n needs curves of order n + 1,
which no protocol measures.
"""

from smarig.identification.extended.fitted_extension import ExtensionData, FittedExtension
from smarig.identification.extended.nonlinear_fit import excess_values, fitted_excess, largest_excess


def restricted(data: ExtensionData) -> FittedExtension:
    """The excess Q(M_1; β, α) of every move inside the first triangle."""
    fit = fitted_excess(data)
    return FittedExtension(
        "weights that depend on the first past maximum",
        {"largest_excess": largest_excess(fit, data.unit)},
        fit.p_value,
        {"kind": "restricted", **excess_values(fit)},
    )
