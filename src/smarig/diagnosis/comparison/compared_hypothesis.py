"""A hypothesis on what a model of a wire lacks, with how well it predicts blocks that it has not seen.

parts of a hypothesis        none: the plain model; effects of the catalogue; a smooth dependence on a variable
log p(y_b | y_−b, H, θ)      its score on block b, with θ chosen without that block
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np

from smarig.core import Array

PartKind = Literal["effect", "variable"]


@dataclass(frozen=True, order=True)
class Part:
    """One thing that a hypothesis adds to the plain model: an effect, or a dependence on a variable."""

    kind: PartKind
    name: str


@dataclass(frozen=True, eq=False)
class Trial:
    """A hypothesis at one set of parameters.

    ``log_scores`` (B,) are the log predictive densities of the blocks, in nats. ``squares`` (B,) are the sums of the
    squared left-out errors of their readings. ``state`` is what the adapter needs to build an extended model.
    """

    parameters: Mapping[str, float]
    log_scores: Array
    squares: Array
    state: Any = field(default=None, repr=False)

    @property
    def score(self) -> float:
        """Of all blocks, in nats."""
        return float(self.log_scores.sum())


@dataclass(frozen=True, eq=False)
class ComparedHypothesis:
    """``parts`` with the ``trials`` of its parameters, in the order of the search; one trial if it has none."""

    parts: tuple[Part, ...]
    trials: tuple[Trial, ...]

    @property
    def name(self) -> str:
        """The parts joined by +; "nothing" for the plain model."""
        return " + ".join(p.name for p in self.parts) or "nothing"

    @cached_property
    def _scores(self) -> Array:
        return np.array([t.log_scores for t in self.trials])

    @cached_property
    def log_scores(self) -> Array:
        """(B,): of each block, at the parameters that predict all other blocks best."""
        others = self._scores.sum(axis=1, keepdims=True) - self._scores
        return self._scores[others.argmax(axis=0), np.arange(others.shape[1])]

    @property
    def best(self) -> Trial:
        """The trial that predicts all blocks best."""
        return self.trials[int(self._scores.sum(axis=1).argmax())]

    @property
    def score(self) -> float:
        """Of all blocks, in nats."""
        return float(self.log_scores.sum())

    def resampled(self, shares: Array) -> dict[str, Array]:
        """The values (draws,) of each parameter that predict best under other ``shares`` (draws, B) of the blocks."""
        chosen = (shares @ self._scores.T).argmax(axis=1)
        names = self.trials[0].parameters
        return {n: np.array([t.parameters[n] for t in self.trials])[chosen] for n in names}
