"""A measured first-order curve, and the completion of curves to saturation beyond their last points.

A curve continues parallel to the neighbour that reaches further. The gap between both closes linearly in β until all
curves meet in negative saturation. The curve that reaches furthest continues to saturation in a straight line.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smarig.core import Array, DataError

Line = tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class ForcCurve:
    """One first-order descending curve from the peak α down along β (n,) with outputs y (n,).

    β falls strictly and starts at the peak, so (β₀, y₀) is the major branch's point y(α, α). ``saturation`` is the
    (input, output) of negative saturation if it was measured with this curve. Magnetic FORCs rise; give them mirrored,
    (u, y) → (−u, −y). Raises DataError.
    """

    alpha: float
    beta: Array
    y: Array
    saturation: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        where = f"First-order curve with its peak at {self.alpha:g}"
        if self.beta.ndim != 1 or self.beta.shape != self.y.shape or self.beta.size == 0:
            raise DataError(
                f"{where}: β has shape {self.beta.shape} and y {self.y.shape}; both must be (n,)."
            )
        if not (np.isfinite(self.beta).all() and np.isfinite(self.y).all()):
            raise DataError(f"{where}: a point is not a number. Leave it out.")
        if self.beta[0] != self.alpha or np.any(np.diff(self.beta) >= 0):
            raise DataError(f"{where}: β must start at the peak and fall strictly.")


def saturation(curves: Sequence[ForcCurve]) -> tuple[float, float]:
    """Negative saturation (u₋, y₋): the lowest measured input, from calibration points or curves.

    Every calibration point counts as saturated: u₋ is the highest of their inputs and y₋ their mean output. If a curve
    extends below it, or if there is no calibration point, u₋ is the least β and y₋ the mean output of the curves that
    end there.
    """
    least = min(float(c.beta[-1]) for c in curves)
    points = [c.saturation for c in curves if c.saturation is not None]
    limit = max((u for u, _ in points), default=np.inf)
    if limit <= least:
        return limit, float(np.mean([y for _, y in points]))
    return least, float(np.mean([c.y[-1] for c in curves if c.beta[-1] == least]))


def completed_curves(curves: Sequence[ForcCurve], lower: float, y_lower: float) -> list[Line]:
    """Each curve from (u₋, y₋) to its peak: rising nodes β, and y. The curves are sorted by rising peak."""
    far = min(range(len(curves)), key=lambda k: curves[k].beta[-1])
    saturation_point = (np.array([lower]), np.array([y_lower]))
    lines = {far: _joined(saturation_point, curves[far])}
    for k in range(far - 1, -1, -1):
        lines[k] = _joined(_continued(curves[k], lines[k + 1], lower), curves[k])
    for k in range(far + 1, len(curves)):
        lines[k] = _joined(_continued(curves[k], lines[k - 1], lower), curves[k])
    return [lines[k] for k in range(len(curves))]


def _continued(curve: ForcCurve, guide: Line, lower: float) -> Line:
    """The guide's nodes beyond the curve's end. The gap at that end closes linearly in β."""
    beta, y = guide
    end = curve.beta[-1]
    if end <= lower:
        return beta[:1], y[:1]
    gap = curve.y[-1] - np.interp(end, beta, y)
    beyond = beta < end
    return beta[beyond], y[beyond] + gap * (beta[beyond] - lower) / (end - lower)


def _joined(tail: Line, curve: ForcCurve) -> Line:
    """The tail and the curve as one line. At saturation the common point is used (§5.5: the curves merge)."""
    beyond_tail = curve.beta > tail[0][-1]
    return (
        np.concatenate([tail[0], curve.beta[beyond_tail][::-1]]),
        np.concatenate([tail[1], curve.y[beyond_tail][::-1]]),
    )
