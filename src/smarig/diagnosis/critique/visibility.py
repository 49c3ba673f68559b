"""The size that each effect must have to be visible in these data, and which effects can imitate each other.

    δ = ‖L⁻¹ t‖/√N        t the effect's trace at typical strength, L Lᵀ = C: covariance of density and noise

This depends on the readings only through the size of the noise.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.critique.candidates import DETECTION_SD, Candidate
from smarig.diagnosis.critique.critique import Critique

Array = NDArray[np.float64]
IMITATION_THRESHOLD = 0.8  # share of an effect's evidence that another can imitate: they form one group


@dataclass(frozen=True, eq=False)
class VisibilityTable:
    """For effects ``names`` (k,): δ at typical strength, least detectable strength, and imitation shares (k, k).

    ``imitated[i, j]`` is the share of the evidence of effect i that effect j could explain.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    delta: Array
    least_strength: Array
    imitated: Array

    @property
    def invisible(self) -> tuple[str, ...]:
        """Effects that these data cannot show at any strength."""
        return tuple(n for n, d in zip(self.names, self.delta) if d == 0)

    def group(self, name: str) -> tuple[str, ...]:
        """The effects that could imitate one."""
        row = self.imitated[self.names.index(name)]
        return tuple(n for n, share in zip(self.names, row) if share >= IMITATION_THRESHOLD and n != name)


def visibility(critique: Critique, insensitive: Sequence[str] = ()) -> VisibilityTable:
    """The visibility of all named candidates of a critique, and of effects to which the data are insensitive."""
    found = _visibility(critique)
    k, n = len(insensitive), len(found.names)
    imitated = np.zeros((n + k, n + k))
    imitated[:n, :n] = found.imitated
    return VisibilityTable(
        (*found.names, *insensitive),
        (*found.units, *[""] * k),
        np.append(found.delta, np.zeros(k)),
        np.append(found.least_strength, np.full(k, np.inf)),
        imitated,
    )


def _visibility(critique: Critique) -> VisibilityTable:
    named = [s.candidate for s in critique.scores if not s.candidate.generic]
    n = critique.refitted.data.size
    delta = [_delta(c, n) for c in named]
    least_strength = [DETECTION_SD / float(c.size.max()) if c.size.size else np.inf for c in named]
    return VisibilityTable(
        tuple(c.name for c in named),
        tuple(c.kind.primary.unit if c.kind else "" for c in named),
        np.array(delta),
        np.array(least_strength),
        np.array([[_imitated(a, b) for b in named] for a in named]),
    )


def _delta(candidate: Candidate, n: int) -> float:
    """δ of the most visible variant."""
    if candidate.kind is None or not candidate.size.size:
        return 0.0
    return float(candidate.size.max() * abs(candidate.kind.primary.typical) / np.sqrt(n))


def _imitated(a: Candidate, b: Candidate) -> float:
    """The share of a's most visible trace that b's best variant explains."""
    if not a.traces.shape[1] or not b.traces.shape[1]:
        return 0.0
    return float(np.max((b.traces.T @ a.traces[:, int(np.argmax(a.size))]) ** 2))
