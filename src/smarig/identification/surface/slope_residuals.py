"""Slopes ∂y/∂β along first-order curves as residuals of a surface fit, beside the outputs (thesis §9.2).

    row of two neighbours β_i > β_{i+1} of a curve:   w h [(ŷ_i − ŷ_{i+1}) − (y_i − y_{i+1})]/(β_i − β_{i+1})

h is the mean spacing of the points, so that a row is an output and w = 1 gives slopes and outputs similar weight. The
difference quotient of the model is compared with that of the data, so nothing is differentiated numerically.
"""

import numpy as np
from scipy.sparse import csr_matrix

from smarig.identification.fod_data import FodData


def slope_rows(data: FodData, weight: float) -> csr_matrix:
    """The rows as a matrix (m, k) that maps errors ŷ − y of the points (k,) to weighted slope errors (m,)."""
    first, second, width = [], [], []
    for alpha in np.unique(data.alpha):
        at = np.flatnonzero(data.alpha == alpha)
        at = at[np.argsort(-data.beta[at], kind="stable")]
        step = data.beta[at[:-1]] - data.beta[at[1:]]
        apart = step > 0  # a repeated reading has no slope
        first += at[:-1][apart].tolist()
        second += at[1:][apart].tolist()
        width += step[apart].tolist()
    m = len(width)
    if not m:
        return csr_matrix((0, len(data)))
    values = weight * float(np.mean(width)) / np.array(width)
    rows = np.tile(np.arange(m), 2)
    return csr_matrix((np.concatenate([values, -values]), (rows, first + second)), shape=(m, len(data)))
