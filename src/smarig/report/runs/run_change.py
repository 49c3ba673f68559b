"""How a run differs from another: beyond the noise or not; as a shift of the input, or as a change of the stroke."""

from dataclasses import dataclass

import numpy as np

from smarig.core import Array
from smarig.identification import ErrorLevel, error_verdict
from smarig.report.runs.run_alignment import AlignedRun

_FEWEST = 8  # common points for a fit of shift and stroke
_CLEAR = 3.0  # standard errors
_EXPLAINED = 0.5  # of the squared difference


@dataclass(frozen=True)
class RunChange:
    """The change from the first run to another, from their common steps.

    ``level``: "good" (within the noise), "fair", "poor", or "unknown" without a noise; ``text`` is the size relative to
    the noise. ``shift`` ± ``shift_se`` of the input and ``gain`` ± ``gain_se`` of the output (as a share) are
    those that reproduce the difference best; ``explained`` is the share of its square that both explain together.
    None if the common steps are too few.
    """

    level: ErrorLevel
    text: str
    shift: tuple[float, float] | None = None
    gain: tuple[float, float] | None = None
    explained: float = 0.0

    @property
    def is_shift(self) -> bool:
        """Whether a shift of the input explains the difference."""
        return self._is(self.shift)

    @property
    def is_gain_change(self) -> bool:
        """Whether a change of the stroke explains the difference."""
        return self._is(self.gain)

    def _is(self, found: tuple[float, float] | None) -> bool:
        return found is not None and self.explained >= _EXPLAINED and abs(found[0]) > _CLEAR * found[1]


def run_change(first: AlignedRun, other: AlignedRun) -> RunChange:
    """The change from ``first`` to ``other``; the differences of ``other`` are those from ``first``."""
    d = other.difference
    y = first.run.points()[1][: d.size]
    extent = float(np.ptp(y)) if y.size else 0.0
    verdict = error_verdict(other.rms, other.noise, other.rms / extent if extent else 0.0)
    u = other.input
    if d.size < _FEWEST or not extent or not np.ptp(u):
        return RunChange(verdict.level, verdict.text)
    basis = np.column_stack([-_slopes(u, y), y - y.mean(), np.ones_like(y)])
    weights, *_ = np.linalg.lstsq(basis, d, rcond=None)
    residual = d - basis @ weights
    centred = d - d.mean()
    total = float(centred @ centred)
    if not total:
        return RunChange(verdict.level, verdict.text)
    variance = float(residual @ residual) / (d.size - basis.shape[1])
    errors = np.sqrt(variance * np.diag(np.linalg.pinv(basis.T @ basis)))
    return RunChange(
        verdict.level,
        verdict.text,
        (float(weights[0]), float(errors[0])),
        (float(weights[1]), float(errors[1])),
        1.0 - float(residual @ residual) / total,
    )


def _slopes(u: Array, y: Array) -> Array:
    """dy/du (n,) along the branch that leads to each point; zero where the input did not move."""
    du, dy = np.diff(u, prepend=u[0]), np.diff(y, prepend=y[0])
    moved = np.abs(du) > 1e-9 * np.ptp(u)
    return np.where(moved, dy / np.where(moved, du, 1.0), 0.0)
