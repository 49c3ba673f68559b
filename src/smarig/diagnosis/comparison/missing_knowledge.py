"""Missing knowledge: an error of held-out runs that lies where the training runs determine nothing.

    share = 1 − (ΔS_h + ΔS_t) / (S_h − S_t),    ΔS = S(all) − S_t,    S: mean squares, of held-out and training readings

S_t, what the training readings leave to their own model, is nobody's knowledge: noise, most of all. One model of all
readings tells missing knowledge from a change: what changed, it cannot fit as well. The share is an upper bound, for
such a model also follows noise that lasts over many readings. Means, so that a long record does not outvote a short
one.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from smarig.core import Array, spaced

EXPERIMENT = "Train with a run that turns where the held-out runs turn."
ENDS = (0.05, 0.95)  # of the square error: the inputs between which it lies


@dataclass(frozen=True)
class MissingKnowledge:
    """``share`` of the held-out square error where the training runs determine nothing, and the ``inputs`` between
    which nine tenths of that error lie.
    """

    share: float
    inputs: tuple[float, float]

    def sentence(self, unit: str) -> str:
        """What is not known, and the run that would close it; ``unit`` is that of the input."""
        low, high = self.inputs
        return (
            f"Up to {100 * self.share:.0f} % of the held-out error is missing knowledge, and nothing need have "
            f"changed: between {low:.4g} and {high:.4g}{spaced(unit)} the held-out runs enter states that no training "
            f"run determines. {EXPERIMENT}"
        )

    def to_json(self, unit: str) -> dict[str, Any]:
        """The object ``missing_knowledge`` of the command line."""
        where = {"input": list(self.inputs), "unit": unit}
        return {"share_of_error": self.share, "where": where, "experiment": EXPERIMENT}


def missing_share(held_out: Array, together: tuple[Array, Array], train: Array) -> float:
    """The share of the ``held_out`` square error beyond that of training readings that a model of all readings does
    not have, from 0 to 1.

    ``together`` are the errors of that model, of held-out and of training readings; ``train`` those of a model of the
    training readings alone. A zero that is shifted in between has 0.5 at most: a common zero misses both parts.
    """
    held, fitted, own, before = (float(np.mean(e**2)) for e in (*together, train, held_out))
    left = max(held - own, 0.0) + max(fitted - own, 0.0)
    return max(1.0 - left / (before - own), 0.0) if before > own else 0.0


def inputs_of_error(u: Array, square: Array) -> tuple[float, float]:
    """The inputs between which nine tenths of the square errors (n,) at inputs u (n,) lie."""
    order = np.argsort(u)
    below = np.cumsum(square[order]) / square.sum()
    low, high = (float(u[order][np.searchsorted(below, q)]) for q in ENDS)
    return low, high
