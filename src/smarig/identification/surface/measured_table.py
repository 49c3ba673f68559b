"""FOD data as an interpolating hysteresis: a table on one partition, or a table of curves.

There is no fit and no noise model: the measured values are reproduced exactly.
"""

import numpy as np

from smarig.core import DataError
from smarig.identification.fod_data import FodData
from smarig.preisach import FodTable, ForcCurve, ForcTable


def table(data: FodData) -> FodTable | ForcTable:
    """``FodTable`` if every β ≤ α of one partition was measured, else ``ForcTable`` of the curves."""
    try:
        return FodTable.from_arrays(*data.as_table(), unit=data.unit)
    except DataError:  # irregular: curves with points of their own
        return curve_table(data)


def curve_table(data: FodData) -> ForcTable:
    """Table of the curves, each from its peak down; repeated readings and repeated curves are averaged."""
    curves = []
    for alpha in np.unique(data.alpha):
        mine = data.alpha == alpha
        beta, where = np.unique(data.beta[mine], return_inverse=True)
        y = np.bincount(where, data.y[mine]) / np.bincount(where)
        if beta[-1] == alpha and beta.size > 1:
            curves.append(ForcCurve(float(alpha), beta[::-1], y[::-1]))
    return ForcTable.from_curves(curves, unit=data.unit)
