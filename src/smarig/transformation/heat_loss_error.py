"""What the heat loss of a wire leaves open in temperatures that no thermometer measured.

Above ambient, T = P/hA. Correlations of free convection about thin wires differ by a tenth: Morgan (1975) by 8 % from
Churchill and Chu (1975) at Rayleigh numbers of 1e-3 to 0.1. Where one constant h is stated, at a known steady state
T_ref, h falls as (T/T_ref)^n towards lower temperatures: n is 0.10 to 0.16 for thin wires in still air, 1/4 for thick
ones, and 0 in moved air. The temperature is then T (T_ref/T)^n. Where only the current is known, the resistance lies
between those of both phases.

All of this moves the temperatures of all branches, cycles and runs of a wire together, so one set of draws serves all.
"""

from dataclasses import dataclass, replace

import numpy as np

from smarig.core import Array
from smarig.plant import Actuator
from smarig.transformation.branch_tangents import DRAWS, BranchTangents, Corner

CORRELATION = 0.1  # of the temperature above ambient: 95 % of what correlations differ
MOST_EXPONENT = 0.25  # of h over T: laminar free convection of thick wires
_SEED, _NORMAL_95 = 12, 1.96


@dataclass(frozen=True)
class HeatLossError:
    """The relative error of temperatures above ambient.

    ``reference_K``: the temperature at which a constant heat loss is stated, None for one that follows the temperature.
    ``resistances``: the least and the largest heat at a current, over that of the mean resistance; (1, 1) for a
    measured power.
    """

    reference_K: float | None
    resistances: tuple[float, float] = (1.0, 1.0)

    @property
    def sentence(self) -> str:
        """What the intervals contain of it."""
        share = f"{100 * CORRELATION:.0f} %"
        if self.reference_K is None:
            return f"Their intervals contain an uncertainty of {share} in the free convection, common to all of them."
        return (
            f"Their intervals contain what one constant heat loss, stated at {self.reference_K:.4g} K above ambient, "
            "may deviate in still air, which moves all of them together."
        )

    def errors(self, rise_K: float) -> Array:
        """Draws (B,) of the error in K of a temperature above ambient; none at or below it."""
        if rise_K <= 0:
            return np.zeros(DRAWS)
        dice = np.random.default_rng(_SEED)
        factor = 1.0 + CORRELATION / _NORMAL_95 * dice.standard_normal(DRAWS)
        exponent = dice.uniform(0.0, MOST_EXPONENT, DRAWS)
        if self.reference_K is not None:
            factor *= (self.reference_K / rise_K) ** exponent
        return rise_K * (factor * dice.uniform(*self.resistances, DRAWS) - 1.0)


def heat_loss_error(actuator: Actuator, *, measured_power: bool) -> HeatLossError:
    """The error with the heat loss of an actuator, from a measured power or from the heating model (5.1)."""
    heating, thermomechanical = actuator.file.heating, actuator.file.thermomechanical
    if measured_power and thermomechanical is not None and thermomechanical.heat_loss == "free_convection":
        return HeatLossError(None)
    reference_K = heating.reference_temperature.value
    if measured_power:
        return HeatLossError(reference_K)
    ends = sorted((heating.resistance_martensite.value, heating.resistance_austenite.value))
    mean = sum(ends) / 2
    return HeatLossError(reference_K, (ends[0] / mean, ends[1] / mean))


def with_heat_loss(tangents: BranchTangents, error: HeatLossError | None) -> BranchTangents:
    """The tangents with corners whose draws contain the error of the heat loss."""
    if error is None:
        return tangents

    def moved(corner: Corner | None) -> Corner | None:
        return corner and replace(corner, draws=corner.draws + error.errors(corner.value))

    return replace(tangents, low=moved(tangents.low), high=moved(tangents.high))
