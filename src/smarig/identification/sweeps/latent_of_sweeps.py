"""τ and the latent heat of a wire from sweeps that no constant τ follows.

The law is that of ``sweep_heat``. τ and Λ minimise what is left of the branches of the major loop (``major_branches``).
The exponent of the convection is that of Churchill and Chu for the wire's diameter. The intervals contain what
exponents from 0 to twice that value would change.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from smarig.core import Array, correlation, root_mean_square
from smarig.identification.calibration.resistance import resistances
from smarig.identification.interval_estimate import Estimate
from smarig.identification.sweeps.major_branches import MajorBranches
from smarig.identification.sweeps.score_interval import half_width
from smarig.identification.sweeps.sweep_heat import SweepHeat, convection_exponent
from smarig.identification.sweeps.sweep_record import SweepRecord

START_SHARE = 0.15  # of the range: the latent heat at which the search starts
STEPS = (3e-3, 1e-2)  # of log τ and of the latent heat over the range, relative, for derivatives
STEP_EXPONENT = 0.05
MOST_EVALUATIONS = 30


@dataclass(frozen=True, eq=False)
class LatentFit:
    """τ with its half-width (of log τ), the latent heat Λ in K for the whole motion, and the law.

    ``rms`` is left of the branches of the major loop, ``constant_rms`` by the best constant τ.
    """

    log_tau: float
    half_log_tau: float
    latent: Estimate
    heat: SweepHeat
    rms: float
    constant_rms: float


def latent_of_sweeps(records: Sequence[SweepRecord], log_tau: float, names: str) -> LatentFit | None:
    """The fit from a start at ``log_tau``; None without both branches, or if heating would set heat free."""
    loops = [loop for r in records if (loop := MajorBranches.of(r)) is not None]
    if not loops:
        return None
    heat, motion = _known(records, math.exp(log_tau))
    span_K = records[0].span_K

    def left(x: Array, exponent: float = heat.exponent) -> Array:
        law = replace(heat, latent_K_per_unit=float(x[1]) * span_K / motion, exponent=exponent)
        return np.concatenate([loop.residuals(math.exp(float(x[0])), law) for loop in loops])

    def constant(x: Array) -> Array:
        return np.concatenate([loop.residuals(math.exp(float(x[0])), SweepHeat()) for loop in loops])

    start = np.array([log_tau, START_SHARE])
    scale = float(np.std(constant(start)))
    fit = least_squares(
        lambda x: left(x) / scale, start, diff_step=STEPS, x_scale=0.1, max_nfev=MOST_EVALUATIONS
    )
    plain = least_squares(lambda x: constant(x) / scale, start[:1], diff_step=STEPS[:1], x_scale=0.1)
    x, slopes, residual = np.asarray(fit.x), scale * np.asarray(fit.jac), left(fit.x)
    by_exponent = (left(x, heat.exponent + STEP_EXPONENT) - residual) / STEP_EXPONENT
    moved = np.linalg.lstsq(slopes, by_exponent, rcond=None)[0] * heat.exponent
    sweep = _numbered(loops)
    halves = [math.hypot(half_width(_alone(slopes, k), residual, sweep), float(moved[k])) for k in (0, 1)]
    kelvin, half_K = float(x[1]) * span_K, halves[1] * span_K
    if kelvin <= half_K:
        return None
    source = f"position on the major loop in sweeps of {names}"
    return LatentFit(
        log_tau=float(x[0]),
        half_log_tau=halves[0],
        latent=Estimate(kelvin, (kelvin - half_K, kelvin + half_K), "K", source, residual.size),
        heat=replace(heat, latent_K_per_unit=kelvin / motion),
        rms=root_mean_square(residual),
        constant_rms=scale * root_mean_square(np.asarray(plain.fun)),
    )


def by_power(records: Sequence[SweepRecord], log_tau: float) -> SweepHeat | None:
    """The heat of a constant τ by the resistances of the phases; None of two wires, or if they were not measured."""
    if records[0].actuator.two_wire:
        return None
    heat = replace(_known(records, math.exp(log_tau))[0], exponent=0.0)
    return None if heat.is_constant_tau else heat


def _known(records: Sequence[SweepRecord], tau_s: float) -> tuple[SweepHeat, float]:
    """The law before Λ is known: exponent and resistances; and the position's motion with its sign."""
    low = min(float(r.held_position.min()) for r in records)
    high = max(float(r.held_position.max()) for r in records)
    rising = correlation(records[0].rises_K(tau_s), records[0].held_position) > 0
    ends = (low, high) if rising else (high, low)
    actuator = records[0].actuator
    ohm = resistances([r.run for r in records], tau_s)
    cold, hot = ohm.get("R_M"), ohm.get("R_A")
    pair = (cold.value, hot.value) if isinstance(cold, Estimate) and isinstance(hot, Estimate) else None
    exponent = convection_exponent(actuator, 2 * records[0].middle_K)
    return SweepHeat(exponent=exponent, resistances_ohm=pair, ends=ends), ends[1] - ends[0]


def _numbered(loops: Sequence[MajorBranches]) -> NDArray[np.int64]:
    """The sweep of each residual, numbered through all records."""
    parts, first = [], 0
    for loop in loops:
        parts.append(np.unique(loop.sweep, return_inverse=True)[1] + first)
        first = int(parts[-1].max()) + 1
    return np.concatenate(parts)


def _alone(slopes: Array, k: int) -> Array:
    """The slope of one unknown (m,), less what the other explains."""
    own, other = slopes[:, k], slopes[:, 1 - k]
    return np.asarray(own - other * float(own @ other) / float(other @ other))
