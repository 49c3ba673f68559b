"""What the lag of the heating does to temperatures of runs that did not settle.

At a rate r, a thermometer that is later than the wire by the time τ reads r τ too little on heating and too much on
cooling: A_s and A_f fall, M_s and M_f rise. A wire that is later than its thermometer does the opposite. A run at one
rate cannot tell this from a narrower or wider hysteresis. Temperatures of the heating model contain its τ, which a wire
with latent heat or free convection does not keep: their intervals are widened by r τ, one draw for both directions.
Of measured temperatures τ is not known, so the shift per second of lag is stated.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from smarig.transformation.branch_tangents import DRAWS, BranchTangents, Corner
from smarig.transformation.full_branches import COOLING, HEATING, FullBranch

_SEED = 11  # one lag for all cycles of a run


def with_lag(tangents: BranchTangents, branch: FullBranch, lag_s: float | None) -> BranchTangents:
    """The tangents with corners whose draws contain a lag of up to ± ``lag_s`` (uniform)."""
    if lag_s is None or branch.rate_K_per_s is None:
        return tangents
    way = 1.0 if branch.direction == HEATING else -1.0
    shift = way * branch.rate_K_per_s * lag_s * np.random.default_rng(_SEED).uniform(-1, 1, DRAWS)

    def moved(corner: Corner | None) -> Corner | None:
        return corner and replace(corner, draws=corner.draws + shift)

    return replace(tangents, low=moved(tangents.low), high=moved(tangents.high))


def lag_note(branches: Sequence[FullBranch], lag_s: float | None, unit: str) -> str | None:
    """The sentence of a run that did not settle; None for one that did."""
    rates = {
        d: [b.rate_K_per_s for b in branches if b.direction == d and b.rate_K_per_s]
        for d in (HEATING, COOLING)
    }
    if not all(rates.values()):
        return None
    mean = _means(rates)
    at = f"at {mean[HEATING]:.3g} (heating) and {mean[COOLING]:.3g} (cooling) {unit}/s on average"
    if lag_s is None:
        return (
            f"The temperature did not settle: it moved {at}. The intervals contain no lag between the specimen and its "
            f"thermometer; each second by which the thermometer is later lowers A_s and A_f by {mean[HEATING]:.3g} K "
            f"and raises M_s and M_f by {mean[COOLING]:.3g} K, and a later specimen does the opposite."
        )
    return (
        f"The temperature did not settle: it moved {at}. The intervals are widened by ± rate × τ of the heating: "
        f"{mean[HEATING] * lag_s:.3g} K on heating, {mean[COOLING] * lag_s:.3g} K on cooling. Settled points avoid it."
    )


def _means(rates: Mapping[str, Sequence[float]]) -> dict[str, float]:
    return {direction: float(np.mean(found)) for direction, found in rates.items()}
