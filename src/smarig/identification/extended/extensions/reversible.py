"""The model y = Γ[u] + r(u): a reversible part in addition to the hysteresis, from both major branches."""

import numpy as np

from smarig.identification.extended.fitted_extension import ExtensionData, FittedExtension
from smarig.identification.extended.reversible_fit import identify_reversible
from smarig.identification.interval_estimate import Estimate


def reversible(data: ExtensionData) -> FittedExtension:
    """A function r(u) of the present input, added to the output."""
    fit = identify_reversible(data.runs, data.hysteresis, data.noise)
    nodes, values = fit.part.nodes, fit.part.values
    low, high = fit.interval()
    k = int(np.argmax(np.abs(values)))
    largest = Estimate(
        float(values[k]),
        (float(low[k]), float(high[k])),
        data.unit,
        f"largest |r|, at input {nodes[k]:g}",
        nodes.size,
    )
    kept = {"kind": "reversible", "nodes": nodes.tolist(), "values": values.tolist()}
    return FittedExtension("r(u), without memory", {"largest_r": largest}, fit.p_none, kept)
