"""Thm 8.2: the bound of the velocity error, and a check of each of its hypotheses.

    δ ‖ė‖² ≤ γ‖ṙ‖‖ė‖ + ‖u_o‖(‖ṙ‖ + ‖ė‖) + Q₀     ⇒     ‖ė‖_T ≤ [(γ + δ)‖ṙ‖_T + ‖u_o‖_T]/δ + √(Q₀/δ)
                                                        ≤ k_e (‖ṙ‖_T + ‖u_o‖_T),   k_e = max{γ + δ, 1}/δ,  Q₀ = 0

Q₀ is the energy stored at the start, zero from u(0) = 0: the thesis's proof with this term kept. The first bound holds
in any units. k_e adds output per second to input, so its value depends on the units. The theorem proves that the
velocity error stays bounded; it does not prove that the position converges.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from smarig.certificate.certificate_units import UNKNOWN, Units, with_unit
from smarig.certificate.hypothesis import Hypothesis, all_hold, failing
from smarig.certificate.hysteresis_analysis import HysteresisAnalysis
from smarig.certificate.storage_bound import StorageBound, storage_bound
from smarig.control import VelocityController
from smarig.core import Array, UsageError
from smarig.preisach import Everett, Initial, Preisach


def k_e(controller: VelocityController) -> float:
    """max{γ + δ, 1}/δ.

    >>> from smarig.control import constant_gain
    >>> k_e(constant_gain(4.0))
    2.0
    """
    return max(controller.gamma + controller.delta, 1.0) / controller.delta


def sharp_bound(
    controller: VelocityController, rate_norm: ArrayLike, offset_norm: ArrayLike, stored: float = 0.0
) -> Array:
    """[(γ + δ)‖ṙ‖ + ‖u_o‖]/δ + √(Q₀/δ), broadcast. Raises UsageError for invalid norms or undecided Q₀."""
    delta, gamma = controller.delta, controller.gamma
    rates, offsets = np.asarray(rate_norm, dtype=float), np.asarray(offset_norm, dtype=float)
    if not (np.all(rates >= 0) and np.all(offsets >= 0)):
        raise UsageError("A norm of the rate or of the offset is negative or NaN. Give numbers ≥ 0.")
    if np.isnan(stored):
        raise UsageError("The stored energy could not be determined, so there is no bound.")
    driven = ((gamma + delta) * rates + offsets) / delta
    return driven + np.sqrt(max(stored, 0.0) / delta)


@dataclass(frozen=True)
class Stability:
    """The result of Thm 8.2 for one model and one controller. ``stored`` is Q₀, inf if there is no bound."""

    k_e: float
    delta: float
    gamma: float
    stored: float
    hypotheses: tuple[Hypothesis, ...]
    units: Units = UNKNOWN

    @property
    def holds(self) -> bool | None:
        """Whether all hypotheses hold."""
        return all_hold(self.hypotheses)

    @property
    def text(self) -> str:
        """The result in a sentence for a report."""
        numbers = (
            f"δ = {with_unit(self.delta, self.units.gain)}, γ = {with_unit(self.gamma, self.units.gain)}"
        )
        if self.holds:
            return (
                f"Stable (Thm 8.2): the velocity error does not exceed k_e = {self.k_e:.4g} times the drive of the "
                f"loop, ‖ė‖ ≤ k_e (‖ṙ‖ + ‖u_o‖) up to every T ({numbers})."
            )
        reasons = " ".join(h.text for h in failing(self.hypotheses))
        return f"Thm 8.2 does not cover this loop ({numbers}). {reasons}"


@dataclass(frozen=True)
class StabilityBasis:
    """The part of Thm 8.2 that depends on the model only: Q₀, and the hypotheses about it."""

    stored: float
    hypotheses: tuple[Hypothesis, ...]
    units: Units = UNKNOWN


def basis(
    found: HysteresisAnalysis, initial: Initial = "negative", energy: StorageBound | None = None
) -> StabilityBasis:
    """Examine a model once for any number of controllers; ``energy``: its storage, if already computed."""
    start = Preisach(found.hysteresis, initial).state
    energy = energy or storage_bound(found, start)
    hypotheses = (
        _passive(energy),
        _output_follows_input(found),
        _density(found),
        _starts_at_rest(start.u, energy.energy, found.units),
    )
    return StabilityBasis(energy.energy, hypotheses, found.units)


def stability(
    hysteresis: Everett, controller: VelocityController, initial: Initial = "negative"
) -> Stability:
    """The hypotheses of Thm 8.2, one by one, for the loop without delay (``loop``).

    >>> from smarig.control import constant_gain
    >>> from smarig.preisach import thesis_surface
    >>> stability(thesis_surface("one_e"), constant_gain(4.0)).holds
    True
    >>> [h.name for h in failing(stability(thesis_surface("two_p"), constant_gain(4.0), "anhysteretic").hypotheses)]
    ['passive', 'output follows input']
    """
    return controller_stability(basis(HysteresisAnalysis.of(hysteresis), initial), controller)


def controller_stability(found: StabilityBasis, controller: VelocityController) -> Stability:
    """The hypotheses of Thm 8.2 for an examined model and one controller."""
    unit = found.units.gain
    controller_hypotheses = (_strictly_passive(controller.delta, unit), _finite_gain(controller, unit))
    return Stability(
        k_e(controller),
        controller.delta,
        controller.gamma,
        found.stored,
        (*found.hypotheses, *controller_hypotheses),
        found.units,
    )


def _passive(energy: StorageBound) -> Hypothesis:
    if energy.basis == "none":
        return Hypothesis("passive", False, "some loop gives energy back in every cycle, so no bound exists")
    if energy.basis == "undecided":
        return Hypothesis("passive", None, "dissipativity is not decided for this kind of hysteresis")
    why = {
        "positive": "ν ≥ 0 (Thm 8.1)",
        "recoverable": "ν ≥ 0 fails, but Q_r is proved a storage function",
        "dissipative": "ν ≥ 0 fails, but no loop gives energy back",
    }[energy.basis]
    if not energy.proven:
        stored = with_unit(energy.energy, energy.unit)
        return Hypothesis("passive", None, f"{why}; the stored energy ({stored}) is a limit from below")
    return Hypothesis("passive", True, why)


def _output_follows_input(found: HysteresisAnalysis) -> Hypothesis:
    monotonicity = found.monotone
    if monotonicity.holds:
        return Hypothesis(
            "output follows input", True, "no branch moves opposite to its input (Assumption 2.1)"
        )
    back = with_unit(monotonicity.setback, found.units.output, 3)
    why = f"a monotone move can bring the output back by {back}, so u_k Δy_k may fall short of ∫u dy"
    return Hypothesis("output follows input", False, why)


def _density(found: HysteresisAnalysis) -> Hypothesis:
    if found.classes.M_PC:
        return Hypothesis("μ ∈ M_PC", True, "the output has no jumps, so the loop has a solution")
    return Hypothesis("μ ∈ M_PC", False, "relays jump, so the loop need not have a solution")


def _starts_at_rest(u: float, stored: float, units: Units) -> Hypothesis:
    if u == 0.0 and not 0.0 < stored < np.inf:
        return Hypothesis("u(0) = 0", True, "the loop starts at zero")
    where = f"u = {with_unit(u, units.input)}"
    if stored == 0.0:
        return Hypothesis("u(0) = 0", True, f"the loop starts at {where}, but with no stored energy")
    energy = with_unit(stored, units.energy)
    why = (
        f"the loop starts at {where} with a stored energy of {energy}, which the bound with √(Q₀/δ) includes"
    )
    return Hypothesis("u(0) = 0", False, why)


def _strictly_passive(delta: float, unit: str) -> Hypothesis:
    if delta > 0:
        return Hypothesis("H₁ strictly passive", True, f"δ = {with_unit(delta, unit)}")
    return Hypothesis("H₁ strictly passive", False, f"δ = {with_unit(delta, unit)} is not positive")


def _finite_gain(controller: VelocityController, unit: str) -> Hypothesis:
    """γ and k_e must be finite; a bound that overflows bounds nothing."""
    delta, gamma = controller.delta, controller.gamma
    if not np.isfinite(gamma):
        return Hypothesis("H₁ of finite gain", False, "γ is infinite")
    if delta > 0 and not np.isfinite(k_e(controller)):
        why = f"k_e overflows with δ = {delta:.4g} and γ = {gamma:.4g}, so it bounds nothing"
        return Hypothesis("H₁ of finite gain", False, why)
    return Hypothesis("H₁ of finite gain", True, f"γ = {with_unit(gamma, unit)}")
