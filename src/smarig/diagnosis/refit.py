"""Everything refitted at once: what data leave unexplained whatever density the hysteresis has.

    y = Γ[u] + e,    Γ of any smooth density (``free_density``),    e ~ N(0, Σ)     ⇒     y ~ N(0, C)

How smooth, and how large the noise, are those of largest likelihood. An effect's trace t then explains
½ (tᵀC⁻¹y)²/(tᵀC⁻¹t) nats more than a new density alone could. Knows no effects.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_solve, cholesky, solve_triangular
from scipy.optimize import minimize

from smarig.diagnosis.free_density import free_density
from smarig.diagnosis.noise import propagated, remembered
from smarig.identification.noise_floor import noise_floor
from smarig.preisach.operator import Preisach
from smarig.story.retelling import COUPLED, Retelling, Subject
from smarig.story.told import Readings, Story

Array = NDArray[np.float64]
ANY = 30.0  # sd of a zero, in ranges of the output: whatever it likes
CORRELATIONS_S = (30.0, 120.0)


@dataclass(frozen=True, eq=False)
class Noise:
    """Standard deviations: ``white`` (n,) of each coupled reading by itself, temperature (K), settled positions."""

    white: Array
    temperature_K: float
    correlation_s: float
    settled: float


@dataclass(frozen=True, eq=False)
class Refit:
    """The stacked readings of a story, whitened: ``factor`` (N, N) is the Cholesky factor of C.

    ``scale`` (N,) divides each reading; ``data`` (N,) are the readings so divided, whitened; ``fitted`` (coupled,)
    what the refitted density says there beyond what the subject's does, in their unit.
    """

    factor: Array
    scale: Array
    data: Array
    noise: Noise
    fitted: Array
    log_evidence: float
    coupled: int

    def centred(self, rest: Array, story: Story) -> Array:
        """Whitened (N,) readings minus predictions, the free constants of blocks apart taken out as in ``data``."""
        at = 0
        rest = rest.copy()
        for r in story.kinds:
            if r.kind not in COUPLED and r.kind != "current":
                rest[at : at + len(r)] -= rest[at : at + len(r)].mean()
            at += len(r)
        return self.whitened(rest)

    def whitened(self, traces: Array) -> Array:
        """L⁻¹ of traces in the readings' units, (N,) or (N, m)."""
        scaled = traces / (self.scale if traces.ndim == 1 else self.scale[:, None])
        return solve_triangular(self.factor, scaled, lower=True, check_finite=False)


def refit(story: Story, told: Retelling, subject: Subject, traces: Array) -> Refit:
    """Likelihood-best smoothness and noise for a story as retold, and its readings whitened by them.

    ``traces`` (N, m), of all that may be wrong, are left out of the likelihood (as if each had an unknown
    strength), so that no hidden effect passes for noise.
    """
    coupled = [r for r in story.kinds if r.kind in COUPLED]
    apart = [r for r in story.kinds if r.kind not in COUPLED]
    y = np.concatenate([r.value - told.values[r.kind] for r in coupled])
    span, n = subject.stroke, y.size
    white, free, scale, reach = _units(story, told, subject, coupled, span)
    h = subject.hysteresis
    path = Preisach(h, subject.initial).simulate(told.felt_K)
    priors = free_density(told, h, path, told.output)
    J, times = remembered(h, told)  # pyright: ignore[reportArgumentType]
    whole = y + told.follows * (
        told.output - h.y_lower
    )  # what any hysteresis must give, not only a change of this one
    aside = _leading(traces[:n] / scale[:, None])
    fixed = free + _BIG**2 * aside @ aside.T
    best = None
    bounds = _bounds(story, subject)
    for correlation in CORRELATIONS_S:
        memory = propagated(J, times, correlation) / span**2
        start = _START if best is None else np.log10(best[1])
        found = _likeliest(whole / scale, priors, memory, fixed, white, reach, start, bounds)
        if best is None or found[0] < best[0]:
            best = (*found, correlation, memory)
    assert best is not None  # noqa: S101 - CORRELATIONS_S is not empty
    cost, (v, s0, s_T, g), correlation, memory = best
    noise_part = _noise(memory, s0, s_T, white, reach)
    C = reach[:, None] * (v * priors[0] + g * priors[1]) * reach + free + noise_part
    blocks = [(C, scale, y), *[_apart(r, told) for r in apart]]
    factor, scales, data = _stacked(blocks)
    whitened = solve_triangular(factor, data / scales, lower=True, check_finite=False)
    weights = solve_triangular(factor[:n, :n], whitened[:n], lower=True, trans="T", check_finite=False)
    fitted = y - scale * (noise_part @ weights)
    sd = np.sqrt(np.diag(noise_part) - s_T**2 * reach**2 * np.diag(memory)) * scale
    noise = Noise(sd, s_T, correlation, span * s0)
    return Refit(factor, scales, whitened, noise, fitted, -cost, n)


_BIG = 30.0  # sd of the strength of a trace that is left out, in ranges


LEADING = 25  # directions of what may be wrong that noise is not judged by


def _leading(traces: Array) -> Array:
    """An orthonormal basis (n, r) of the directions most traces share."""
    size = np.sqrt(np.sum(traces**2, axis=0))
    u = np.linalg.svd(traces[:, size > 0] / size[size > 0], full_matrices=False)[0]
    return u[:, : min(LEADING, traces.shape[0] // 6)]


def _units(
    story: Story, told: Retelling, subject: Subject, coupled: list[Readings], span: float
) -> tuple[Array, Array, Array, Array]:
    """Per coupled reading: own white noise (scaled), covariance of free zeros, scale, slope to y (scaled)."""
    raw = _raw_noise(story, subject)
    white, scale, zero = [], [], []
    for k, r in enumerate(coupled):
        y = r.value - told.values[r.kind]
        own = {"settled": 0.0, "moving": raw}.get(r.kind)
        noise = max(_local_noise(y), _FINEST["resistance"]) if own is None else own
        scale.append(np.full(len(r), noise if own is None else span))
        white.append(np.full(len(r), 1.0 if own is None else noise / span))
        zero.append(np.full(len(r), k if own is None else 0))
    own_zero, scales = np.concatenate(zero), np.concatenate(scale)
    same = own_zero[:, None] == own_zero[None, :]
    size = np.where(own_zero == 0, ANY, _ANY_ZERO)
    slope = told.follows * span / scales
    return np.concatenate(white), np.where(same, np.outer(size, size), 0.0), scales, slope


def _noise(memory: Array, s0: float, s_T: float, white: Array, slope: Array) -> Array:
    """Σ, scaled: s₀ is in every position, a reading's own noise beside it."""
    C = slope[:, None] * (s_T**2 * memory) * slope
    C[np.diag_indices_from(C)] += white**2 + np.where(white < 1.0, s0**2, 0.0)
    return C


def _likeliest(
    y: Array,
    priors: tuple[Array, Array],
    memory: Array,
    fixed: Array,
    white: Array,
    slope: Array,
    start: Array,
    bounds: tuple[Array, Array],
) -> tuple[float, tuple[float, ...]]:
    """(−log likelihood, (v, s₀, s_T, g)) at its least."""

    parts = [slope[:, None] * part * slope for part in (*priors, memory)]
    positions = np.where(white < 1.0, 1.0, 0.0)

    def cost(x: Array) -> tuple[float, Array]:
        v, s0, s_T, g = 10.0**x
        C = v * parts[0] + g * parts[1] + s_T**2 * parts[2] + fixed
        C[np.diag_indices_from(C)] += white**2 + s0**2 * positions
        try:
            L = cholesky(C, lower=True, check_finite=False, overwrite_a=True)
        except LinAlgError:
            return 1e12, np.zeros(4)
        inverse = cho_solve((L, True), np.eye(y.size), check_finite=False)
        a = inverse @ y
        value = 0.5 * float(y @ a) + float(np.log(np.diag(L)).sum())
        by = [float(np.sum(inverse * part) - a @ part @ a) for part in parts]
        by_s0 = float(np.diag(inverse) @ positions - (a * a) @ positions)
        slopes = np.array([v * by[0], 2 * s0**2 * by_s0, 2 * s_T**2 * by[2], g * by[1]])
        return value, 0.5 * np.log(10.0) * slopes

    found = minimize(
        cost,
        np.clip(start, *bounds),
        jac=True,
        method="L-BFGS-B",
        bounds=list(zip(*bounds)),
        options={"maxiter": 40, "ftol": 1e-6},
    )
    return float(found.fun), tuple(10.0**found.x)


_START = np.array([3.0, -3.7, -1.3, -5.0])  # log₁₀ of v, s₀ (ranges), s_T (K), g (ranges²)
DRAUGHTIEST_K, NOISIEST_COUNTS = 0.5, 2.0  # what is more is no noise of a rig, unless repeats say so


def _bounds(story: Story, subject: Subject) -> tuple[Array, Array]:
    """Of the search above: no mean is better than its samples allow, and a misfit of kelvins is not a draught."""
    samples = max(float(np.median([step.n for run in story.runs for step in run.settled])), 1.0)
    least = _raw_noise(story, subject) / np.sqrt(samples)
    repeats = noise_floor(list(story.runs)).value or 0.0
    counts = max(NOISIEST_COUNTS * subject.per_count, 2 * repeats)
    return (
        np.array([-3.0, np.log10(least / subject.stroke), -4.0, -9.0]),
        np.array([9.0, np.log10(counts / subject.stroke), np.log10(DRAUGHTIEST_K), 0.0]),
    )


def _raw_noise(story: Story, subject: Subject) -> float:
    """Sd of a single position reading, from the scatter within settled windows; half a count at least."""
    spread = []
    for run in story.runs:
        for step in run.settled[:: max(1, len(run.settled) // 40)]:
            rows = np.flatnonzero(run["step"] == step.index)[-max(step.n, 1) :]
            if rows.size > 20:
                spread.append(float(np.var(np.diff(run["position"][rows])) / 2))
    return float(np.sqrt(max(np.median(spread) if spread else 0.0, (0.5 * subject.per_count) ** 2, 1e-12)))


_FINEST = {"resistance": 5e-4, "current": 5e-5, "room": 0.005}  # ohm, A, K: no instrument is better
_ANY_ZERO = 1e3  # sd of a block's own zero, in noises: sure to be absorbed, and no trouble for rounding


def _apart(readings: Readings, told: Retelling) -> tuple[Array, Array, Array]:
    """A block of its own: a free constant (not for currents), white noise judged by what a smooth curve leaves."""
    y = readings.value - told.values[readings.kind]
    noise = max(_local_noise(y), _FINEST[readings.kind])
    zero = 0.0 if readings.kind == "current" else _ANY_ZERO**2
    y = y if readings.kind == "current" else y - y.mean()
    return np.full((y.size, y.size), zero) + np.eye(y.size), np.full(y.size, noise), y


def _local_noise(y: Array) -> float:
    """Sd of white noise from second differences of neighbours, robustly."""
    bends = y[:-2] - 2 * y[1:-1] + y[2:]
    return max(
        float(np.median(np.abs(bends))) / 0.6745 / np.sqrt(6.0), 1e-9 * max(float(np.abs(y).max()), 1e-9)
    )


def _stacked(blocks: list[tuple[Array, Array, Array]]) -> tuple[Array, Array, Array]:
    size = sum(y.size for _, _, y in blocks)
    factor, at = np.zeros((size, size)), 0
    for C, _, y in blocks:
        factor[at : at + y.size, at : at + y.size] = cholesky(C, lower=True, check_finite=False)
        at += y.size
    return factor, np.concatenate([s for _, s, _ in blocks]), np.concatenate([y for _, _, y in blocks])
