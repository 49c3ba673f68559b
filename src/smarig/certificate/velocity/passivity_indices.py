"""Tests a controller's δ and γ on signals: both inequalities at every T, and how tight they are.

Only the response of a controller is used, not its transfer function.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.control import VelocityController, finite, not_negative
from smarig.core import Array, DataError, UsageError


def response(controller: VelocityController, error: ArrayLike, dt_s: float) -> Array:
    """ũ (n,) to errors (n,), from rest. Raises DataError for errors that are not finite."""
    errors = np.asarray(error, dtype=float)
    if errors.ndim != 1 or not np.isfinite(errors).all():
        raise DataError("A controller needs finite errors of shape (n,).")
    running, control = controller.start(dt_s), np.empty(errors.size)
    for k, e in enumerate(errors.tolist()):
        control[k] = running.output(e)
        running.advance(e)
    return control


@dataclass(frozen=True, eq=False)
class Inequalities:
    """Running sums up to every T, (n,) each, times dt: ⟨ė, ũ⟩_T, ‖ė‖²_T and ‖ũ‖²_T."""

    supplied: Array
    error_squared: Array
    control_squared: Array

    def strictly_passive(self, delta: float) -> bool:
        """⟨ė, ũ⟩_T ≥ δ ‖ė‖²_T at every T, except for rounding. Raises UsageError if it cannot be computed."""
        return not self._violates_delta(delta).any()

    def finite_gain(self, gamma: float) -> bool:
        """‖ũ‖_T ≤ γ ‖ė‖_T at every T, except for rounding. Raises UsageError for γ < 0 or if it cannot be computed."""
        return not self._violates_gamma(gamma).any()

    def _violates_delta(self, delta: float) -> NDArray[np.bool_]:
        least = _finite_sums(_scaled(finite("delta", delta), self.error_squared))
        size = np.sqrt(self.error_squared) * np.sqrt(self.control_squared) + np.abs(least)
        return least - self.supplied > 1e-12 * size  # ⟨ė, ũ⟩ is a sum of products that cancel

    def _violates_gamma(self, gamma: float) -> NDArray[np.bool_]:
        gain = not_negative("gamma", gamma)
        most = _finite_sums(_scaled(gain * gain, self.error_squared))
        return self.control_squared - most > 1e-12 * (self.control_squared + most)

    def violated_at(self, index: Literal["delta", "gamma"], value: float) -> int | None:
        """The first sample T at which the inequality with this δ or γ fails; None if it holds."""
        _check_index(index)
        broken = self._violates_delta(value) if index == "delta" else self._violates_gamma(value)
        return int(np.argmax(broken)) if broken.any() else None


def inequalities(controller: VelocityController, error: ArrayLike, dt_s: float) -> Inequalities:
    """Both sides of the inequalities of Thm 8.2 along errors (n,), from rest. Raises UsageError on overflow.

    >>> from smarig.control import lead_lag
    >>> lead = lead_lag(2.0, zero_s=4.0, pole_s=1.0)
    >>> seen = inequalities(lead, [1.0, -2.0, 0.5], dt_s=0.1)
    >>> seen.strictly_passive(lead.delta), seen.finite_gain(lead.gamma)
    (True, True)
    """
    errors = np.asarray(error, dtype=float)
    control = response(controller, errors, dt_s)
    with np.errstate(all="ignore"):
        sums = [dt_s * np.cumsum(products) for products in (errors * control, errors**2, control**2)]
    return Inequalities(*map(_finite_sums, sums))


def _scaled(index: float, sums: Array) -> Array:
    with np.errstate(all="ignore"):  # an overflow is refused later
        return index * sums


def _finite_sums(sums: Array) -> Array:
    """The sums. Raises UsageError if one is infinite, because it then decides no inequality."""
    if not np.isfinite(sums).all():
        raise UsageError("The errors or the index overflow the computation. Give smaller ones.")
    return sums


def _check_index(index: str) -> None:
    if index not in ("delta", "gamma"):
        raise UsageError(f"Unknown index '{index}'. Give delta or gamma.")


def violating_signal(
    controller: VelocityController, dt_s: float, index: Literal["delta", "gamma"], by: float = 1.01
) -> Array:
    """Errors (n,) that violate ⟨ė, ũ⟩_T ≥ (by·δ) ‖ė‖²_T, or ‖ũ‖_T ≤ (γ/by) ‖ė‖_T, at their end.

    They show how tight the index is. Raises UsageError if none of the controller's probes violates it, or for by ≤ 1.
    """
    _check_index(index)
    if not by > 1:
        raise UsageError(f"The factor is {by:g}. Give a factor above 1; the index itself cannot be violated.")
    value = by * controller.delta if index == "delta" else controller.gamma / by
    for probe in controller.probes(dt_s):
        last = inequalities(controller, probe, dt_s).violated_at(index, value)
        if last is not None:
            return probe[: last + 1]
    raise UsageError(f"No signal was found that violates {index} by a factor of {by:g}.")
