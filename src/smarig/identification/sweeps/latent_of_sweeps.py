"""τ and the latent heat of a wire from sweeps that no constant τ follows.

The law is that of ``sweep_heat``. τ and Λ minimise what is left of the branches of the major loop (``major_branches``).
The exponent of the convection is that of Churchill and Chu for the wire's diameter. The intervals contain what
exponents from 0 to twice that value would change.

The two branches of the major loop in a run of sweeps, passed at several rates.

A rise from rest at the lower end follows one curve of the input, whatever its rate and its end (wiping-out, §3.3.1; a
wire that is all martensite forgets as well). So does a fall from the upper end. No assumption on minor loops is needed,
so the branches determine the heating of a wire that is no Preisach operator.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.optimize import least_squares

from smarig.core import Array, correlation, root_mean_square
from smarig.identification.calibration.resistance import resistances
from smarig.identification.interval_estimate import Estimate
from smarig.identification.positive.adapted_partition import nodes_along
from smarig.identification.sweeps.score_interval import half_width
from smarig.identification.sweeps.sweep_heat import SweepHeat, convection_exponent
from smarig.identification.sweeps.sweep_record import SweepRecord

Integers = NDArray[np.int64]
KNOTS = 60
AT_TOP = 0.95  # of the range: a fall from above it starts at the upper end
ROUGHNESS = 1e-3  # of neighbouring coefficients, where no block lies
_FEWEST = 30  # blocks of a branch


@dataclass(frozen=True, eq=False)
class MajorBranches:
    """Blocks of a record on its major loop: ``branch`` (b,) is 0 on rises, 1 on falls from the top, −1 elsewhere."""

    record: SweepRecord
    branch: Integers
    knots: tuple[Array, ...]

    @classmethod
    def of(cls, record: SweepRecord) -> "MajorBranches | None":
        """The branches of a record; None if it does not contain both."""
        branch = np.where(record.sizes > 0, _branch_of_blocks(record), -1)
        if min(np.count_nonzero(branch == k) for k in (0, 1)) < _FEWEST:
            return None
        inputs, outputs = record.means(record.inputs_K(record.actuator.tau_s)), record.means(record.position)
        knots = []
        for k in (0, 1):
            rows = np.flatnonzero(branch == k)
            rows = rows[np.argsort(inputs[rows], kind="stable")]
            nodes = nodes_along(inputs[rows], outputs[rows], np.zeros(rows.size, dtype=np.int64), KNOTS)
            inside = nodes[(nodes > record.lower) & (nodes < record.upper)]
            knots.append(np.concatenate([[record.lower], inside, [record.upper]]))
        return cls(record, branch, tuple(knots))

    @property
    def sweep(self) -> Integers:
        """The sweep of each residual."""
        of_block = self.record.sweep[self.record.blocks]
        return np.concatenate([of_block[self.branch == k] for k in range(len(self.knots))])

    def residuals(self, tau_s: float, heat: SweepHeat) -> Array:
        """Residuals (m,) of the best curve of each branch, model minus measurement."""
        tried = self.record.with_heat(heat)
        inputs, outputs = tried.means(tried.inputs_K(tau_s)), tried.means(tried.position)
        parts = []
        for k, knots in enumerate(self.knots):
            rows = self.branch == k
            u = np.clip(inputs[rows], knots[0], knots[-1])
            padded = np.concatenate([[knots[0]] * 3, knots, [knots[-1]] * 3])
            design = BSpline.design_matrix(u, padded, 3).toarray()
            rough = ROUGHNESS * np.diff(np.eye(design.shape[1]), 2, axis=0)
            target = np.concatenate([outputs[rows], np.zeros(len(rough))])
            values = np.linalg.lstsq(np.vstack([design, rough]), target, rcond=None)[0]
            parts.append(design @ values - outputs[rows])
        return np.concatenate(parts)


def _branch_of_blocks(record: SweepRecord) -> Integers:
    """0, 1 or −1 of each block (b,); a rest belongs to the fall before it."""
    names = [step.branch for step in record.run.steps]
    inputs, edge = record.inputs_K(record.actuator.tau_s), record.lower + AT_TOP * record.span_K
    of_step = np.full(len(names) + 1, -1)
    for k, name in enumerate(names):
        rows = np.flatnonzero(record.sweep == k)
        if name.startswith("rise"):
            of_step[k] = 0
        elif name.startswith("fall") and rows.size and inputs[rows[0]] >= edge:
            of_step[k] = 1
        elif name.startswith("rest") and k:
            of_step[k] = of_step[k - 1]
    return of_step[record.sweep[record.blocks]]


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
