"""Settled points with their uncertainties, from the samples of each step's window.

The standard uncertainty of a settled mean has three parts: scatter of the window's block means, remaining motion of
the wire within the window, and quantisation that noise does not dither.
"""

from dataclasses import dataclass

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.record import Run, Step

_BLOCKS = 25


@dataclass(frozen=True)
class SettledPoints:
    """Points (T_i, p_i) of §5.2.1: input (k,), output (k,), standard uncertainty (k,), branch labels."""

    input: Array
    output: Array
    uncertainty: Array
    branch: tuple[str, ...]
    unit: str

    def of(self, *branches: str) -> "SettledPoints":
        """The points of the named branches, in order."""
        keep = np.array([b in branches for b in self.branch], dtype=bool)
        kept = tuple(b for b in self.branch if b in branches)
        return SettledPoints(self.input[keep], self.output[keep], self.uncertainty[keep], kept, self.unit)

    @property
    def noise(self) -> float:
        """Root mean square of the uncertainties."""
        return root_mean_square(self.uncertainty) if self.uncertainty.size else float("nan")


def settled_points(run: Run) -> SettledPoints:
    """All valid settled steps of a run with their uncertainties."""
    per_count = run.info.output.resolution
    steps = run.settled
    uncertainty = np.array([_uncertainty(run, s, per_count) for s in steps])
    inputs, outputs = run.points()
    return SettledPoints(inputs, outputs, uncertainty, tuple(s.branch for s in steps), run.unit)


def _uncertainty(run: Run, step: Step, per_count: float) -> float:
    window = run["position"][run.window(step)]
    window = window[np.isfinite(window)]
    if window.size < 2 * _BLOCKS:
        return per_count / np.sqrt(12)
    used = window[: window.size // _BLOCKS * _BLOCKS].reshape(_BLOCKS, -1).mean(axis=1)
    block = used.var(ddof=1)
    # The end of the window minus its mean shows a wire that still moves. Differences within twice their
    # noise are ignored.
    moved, by_noise = (used[-5:].mean() - used.mean()) ** 2, block * (1 / 5 - 1 / _BLOCKS)
    moved = moved if moved > 4 * by_noise else 0.0
    undithered = per_count**2 / 12 if window.std() < 0.3 * per_count else 0.0
    return float(np.sqrt(block / _BLOCKS + moved + undithered))
