"""The strain of the law along a record: branches between turning points, each from the state at its beginning.

A branch that begins inside the loop transforms the phase that is left over the rest of its strip:

    cooling, loading      1 − ξ = (1 − ξ_r) (1 − ξ_c)/(1 − ξ_c,r),     dε^t = ε_L(σ) dξ
    heating, unloading        ξ = ξ_r ξ_h/ξ_h,r,                       ε^t = ε^t_r ξ/ξ_r

ξ_c and ξ_h are the fractions of full branches, and r marks the beginning: partial transformation by scaling, which is
also the rule of the thermomechanical twin. It is the identity for full loops. The transformation strain follows
Lagoudas et al. (2012), eqs. 9 to 11.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from smarig.core import Array
from smarig.identification.material.law import (
    MaterialLaw,
    cooled_fraction,
    heated_fraction,
    total_strain,
    transformation_strain,
)

_NONE_LEFT = 1e-9  # of a phase: a branch that begins with less does not transform


class MaterialBranch(NamedTuple):
    """Rows from ``first`` up to ``stop``; ``cooling``: austenite becomes martensite, by cooling or by loading."""

    first: int
    stop: int
    cooling: bool


class _State(NamedTuple):
    fraction: float
    transformed: float


def strain_along(
    law: MaterialLaw, temperature_degC: Array, stress_MPa: Array, branches: Sequence[MaterialBranch]
) -> Array:
    """Strain (n,) along temperatures (n,) and stresses, (n,) or (1,) if the stress is constant.

    The wire came to the first reading on a full branch of the other direction.
    """
    fraction, transformed = np.empty_like(temperature_degC), np.empty_like(temperature_degC)
    state = _initial(law, temperature_degC[:1], stress_MPa[:1], branches[0].cooling)
    for branch in branches:
        first = max(branch.first - 1, 0)  # the last reading of the branch before is where this one begins
        rows = slice(first, branch.stop)
        follow = _cooled if branch.cooling else _heated
        xi, strain = follow(
            law, temperature_degC[rows], stress_MPa if stress_MPa.size == 1 else stress_MPa[rows], state
        )
        skip = branch.first - first
        fraction[branch.first : branch.stop], transformed[branch.first : branch.stop] = (
            xi[skip:],
            strain[skip:],
        )
        state = _State(float(xi[-1]), float(strain[-1]))
    return total_strain(law, temperature_degC, stress_MPa, fraction, transformed)


def _initial(law: MaterialLaw, temperature_degC: Array, stress_MPa: Array, cooling: bool) -> _State:
    reached = heated_fraction if cooling else cooled_fraction
    xi = float(reached(law, temperature_degC, stress_MPa)[0])
    return _State(xi, xi * float(transformation_strain(law, stress_MPa)[0]))


def _cooled(
    law: MaterialLaw, temperature_degC: Array, stress_MPa: Array, start: _State
) -> tuple[Array, Array]:
    left = 1.0 - cooled_fraction(law, temperature_degC, stress_MPa)
    xi = 1.0 - (1.0 - start.fraction) * _share(left)
    limit = transformation_strain(law, stress_MPa)
    if limit.size == 1:
        return xi, start.transformed + limit * (xi - start.fraction)
    gained = np.diff(xi, prepend=start.fraction)
    middle = 0.5 * (limit + np.concatenate([limit[:1], limit[:-1]]))
    return xi, start.transformed + np.cumsum(middle * gained)


def _heated(
    law: MaterialLaw, temperature_degC: Array, stress_MPa: Array, start: _State
) -> tuple[Array, Array]:
    strain = start.transformed / start.fraction if start.fraction > _NONE_LEFT else None
    share = _share(heated_fraction(law, temperature_degC, stress_MPa, strain))
    return start.fraction * share, start.transformed * share


def _share(left: Array) -> Array:
    """What is left of a phase, of that at the first reading."""
    return np.minimum(left / left[0], 1.0) if left[0] > _NONE_LEFT else np.ones_like(left)
