"""The excess of second-order curves of several runs, from the run that contains all curves of one partition."""

from typing import Any

import numpy as np

from smarig.core import DataError
from smarig.identification.extended.fitted_extension import ExtensionData
from smarig.identification.extended.nonlinear_fit import NonlinearFit, identify_nonlinear
from smarig.identification.interval_estimate import Estimate


def fitted_excess(data: ExtensionData) -> NonlinearFit:
    """Q of the run with the finest partition with complete second-order curves; DataError if there is none."""
    noise, fits, reason = data.noise, [], ""
    for run in data.runs:
        try:
            fits.append(identify_nonlinear([run], noise, data.hysteresis))
        except DataError as error:
            reason = str(error)
    if not fits:
        raise DataError(
            f"No run contains all second-order curves of a partition (protocol second_order_transition): {reason}"
        )
    return max(fits, key=lambda fit: fit.excess.nodes.size)


def largest_excess(fit: NonlinearFit, unit: str) -> Estimate:
    """The largest |Q| with its 95 % interval."""
    values = np.where(np.isfinite(fit.error), np.abs(fit.excess.values), -1.0)
    at = np.unravel_index(int(np.argmax(values)), values.shape)
    low, high = fit.interval()
    alpha, beta, u = (float(fit.excess.nodes[k]) for k in at)
    source = f"largest |Q|, at α = {alpha:g}, β = {beta:g}, u = {u:g}"
    ends = float(low[at]), float(high[at])
    return Estimate(float(fit.excess.values[at]), ends, unit, source, int(np.isfinite(fit.error).sum()))


def excess_values(fit: NonlinearFit) -> dict[str, Any]:
    """Partition and tensor, for a model file."""
    return {"nodes": fit.excess.nodes.tolist(), "values": fit.excess.values.tolist()}
