"""The share of the held-out error that is missing knowledge: one density of relays predicts all readings as well.

The fits are positive. A wire that changed, or an input that is shifted, cannot be fitted by one
density without a larger error of the training readings; a turn inside the fitted loop can.
"""

import numpy as np
from scipy.optimize import nnls

from smarig.core import Array
from smarig.diagnosis.comparison.measured.additions import KeptAddition
from smarig.diagnosis.comparison.missing_knowledge import (
    MissingKnowledge,
    inputs_of_error,
    missing_share,
)
from smarig.diagnosis.comparison.verdict_rules import RULES

CONSTANT = 10.0  # column of the unknown zero, of either sign


def missing_knowledge(base: KeptAddition, share: float) -> MissingKnowledge | None:
    """The missing knowledge, or None if the held-out error is no matter of knowledge."""
    if share < RULES["not_determined"].value:
        return None
    problem, square = base.problem, base.held_out_error() ** 2
    u = np.concatenate([r.u[rows] for r, rows in zip(problem.records, problem.rows)])[~problem.train]
    return MissingKnowledge(min(share, 1.0), inputs_of_error(u, square))


def share_of_fits(base: KeptAddition) -> float:
    """Share of the held-out square error that one density for all readings would not have."""
    train, y = base.problem.train, base.problem.y
    ones = np.full((y.size, 1), CONSTANT)
    columns = np.hstack([base.relays.features, ones, -ones])
    left, own = _positive_error(columns, y), _positive_error(columns[train], y[train])
    return missing_share(base.held_out_error(), (left[~train], left[train]), own)


def _positive_error(columns: Array, y: Array) -> Array:
    return y - columns @ nnls(columns, y, maxiter=10 * columns.shape[1])[0]
