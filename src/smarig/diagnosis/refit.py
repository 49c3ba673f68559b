"""Everything refitted at once: what data leave unexplained whatever density the hysteresis has.

    y = Γ[u] + e,    Γ of any smooth density (``free_density``),    e ~ N(0, Σ)     ⇒     y ~ N(0, C)

How smooth, and how large the noise, are those of largest likelihood. An effect's trace t then explains
½ (tᵀC⁻¹y)²/(tᵀC⁻¹t) nats more than a new density alone could. Knows no effects.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_solve, cholesky, solve_triangular
from scipy.linalg.lapack import dpotri  # pyright: ignore[reportAttributeAccessIssue]
from scipy.optimize import OptimizeResult, minimize

from smarig.diagnosis import given
from smarig.diagnosis.free_density import FreeDensity, free_density
from smarig.diagnosis.noise import propagated, remembered
from smarig.preisach.fod_table import FodTable
from smarig.story.retelling import COUPLED, Retelling, Subject, retold
from smarig.story.told import Readings, Story

Array = NDArray[np.float64]
ANY = 30.0  # sd of a zero, in ranges of the output: whatever it likes
INEXACT = 0.01  # of what an effect adds: no mechanism is exactly its equation
UNSEEN = 0.03  # of the stroke: what may lie beyond the farthest hold, and is part of what a resistance tells
JITTER_S = 0.02  # of a time stamp: what moves fast is known no better
CORRELATIONS_S = (120.0, 30.0, 300.0)


@dataclass(frozen=True, eq=False)
class Noise:
    """Standard deviations: ``white`` (n,) of each coupled reading by itself, temperature (K), settled positions.

    ``moving`` is the usual one of positions on their way, 0 where none was read.
    """

    white: Array
    temperature_K: float
    correlation_s: float
    settled: float
    moving: float = 0.0


@dataclass(frozen=True, eq=False)
class Refit:
    """The stacked readings of a story, whitened: ``factor`` (N, N) is the Cholesky factor of C.

    ``scale`` (N,) divides each reading; ``data`` (N,) are the readings so divided, whitened; ``fitted`` (coupled,)
    what the refitted density says there beyond what the subject's does, in their unit. ``spreads`` are the
    log₁₀ of the density's parts' variances, s_m, s₀ and s_T.
    """

    factor: Array
    scale: Array
    data: Array
    noise: Noise
    fitted: Array
    log_evidence: float
    coupled: int
    spreads: Array
    density: FodTable

    def centred(self, rest: Array, story: Story) -> Array:
        """Whitened (N,) readings minus predictions, the free constants of blocks apart taken out as in ``data``."""
        at = 0
        rest = rest.copy()
        for r in story.kinds:
            if r.kind not in COUPLED and r.kind != "current":
                rest[at : at + len(r)] -= _own_means(rest[at : at + len(r)], r, story)
            at += len(r)
        return self.whitened(rest)

    def whitened(self, traces: Array) -> Array:
        """L⁻¹ of traces in the readings' units, (N,) or (N, m)."""
        scaled = traces / (self.scale if traces.ndim == 1 else self.scale[:, None])
        return solve_triangular(self.factor, scaled, lower=True, check_finite=False)


def refit(
    story: Story, told: Retelling, subject: Subject, traces: Array, like: "Refit | None" = None
) -> Refit:
    """Likelihood-best smoothness and noise for a story as retold, and its readings whitened by them.

    ``traces`` (N, m), of all that may be wrong, are left out of the likelihood (as if each had an unknown
    strength), so that no hidden effect passes for noise. ``like``: begin where another refit ended.
    """
    coupled = [r for r in story.kinds if r.kind in COUPLED]
    apart = [r for r in story.kinds if r.kind not in COUPLED]
    y = np.concatenate([r.value - told.values[r.kind] for r in coupled])
    span, n = subject.stroke, y.size
    h = subject.hysteresis
    path = told.lived(h, subject.initial, told.felt_K)
    added = _added(story, told, subject)
    white, free, scale, reach = _units(story, told, subject, coupled, _speed(told, path), added)
    density = free_density(told, h, path, told.output)
    priors = density.covariances
    J, times = remembered(h, told)  # pyright: ignore[reportArgumentType]
    whole = y + told.follows * (
        told.output - h.y_lower
    )  # what any hysteresis must give, not only a change of this one
    aside = _leading(traces[:n] / scale[:, None])
    fixed = free + _BIG**2 * aside @ aside.T
    moves = np.concatenate([np.full(len(r), float(r.kind == "moving")) for r in coupled])
    bounds = _bounds(story, subject)
    best: tuple[float, Array, float, Array] | None = None
    tried = given.correlations_s(story) if story.given else CORRELATIONS_S
    for correlation in (like.noise.correlation_s,) if like else tried:
        memory = propagated(J, times, correlation) / span**2
        start = like.spreads if like else _START if best is None else np.append(best[1][:-1], DRAUGHTY)
        cost, spreads = _likeliest(
            whole / scale, (*priors, memory), fixed, white, moves, reach, start, bounds
        )
        if best is None or cost < best[0]:
            best = (cost, spreads, correlation, memory)
    assert best is not None  # noqa: S101 - CORRELATIONS_S is not empty
    cost, spreads, correlation, memory = best
    *variances, s_m, s0, s_T = 10.0**spreads
    C_prior = np.sum([w * prior for w, prior in zip(variances, priors)], axis=0)
    noise_part = _noise(memory, _own(white, moves, s_m, s0), s_T, reach)
    C = reach[:, None] * C_prior * reach + free + noise_part
    blocks = [(C, scale, y), *[_apart(r, story, told) for r in apart]]
    factor, scales, data = _stacked(blocks)
    whitened = solve_triangular(factor, data / scales, lower=True, check_finite=False)
    alone = float(0.5 * whitened[n:] @ whitened[n:] + np.log(np.diag(factor)[n:] * scales[n:]).sum())
    pull = solve_triangular(factor[:n, :n], whitened[:n], lower=True, trans=1, check_finite=False)
    fitted = y - scale * (noise_part @ pull)
    sd = np.sqrt(np.diag(noise_part) - s_T**2 * reach**2 * np.diag(memory)) * scale
    late = float(np.median(sd[moves > 0])) if moves.any() else 0.0
    noise = Noise(sd, s_T, correlation, span * s0, late)
    masses, shift = _renewed(density, C_prior, np.array(variances), reach, factor[:n, :n], free, pull)
    zero = h.y_lower + float(np.mean((scale * shift)[(white < 1.0) & (told.sitting == 0)]))
    table = density.triangle.table(span * masses, zero, story.unit)
    evidence = -cost - float(np.log(scale).sum()) - alone  # of readings in their own units
    return Refit(factor, scales, whitened, noise, fitted, evidence, n, spreads, table)


AGAIN = 10  # times at most that what non-negative masses lost is given to others


def _renewed(
    density: FreeDensity,
    C_prior: Array,
    variances: Array,
    reach: Array,
    factor: Array,
    free: Array,
    pull: Array,
) -> tuple[Array, Array]:
    """Masses (cells,) in strokes and zeros (n,), scaled, of the posterior mean; ``factor`` is C's, ``pull`` C⁻¹y.

    Where a mass would be negative it is none, and others must make up for it: the outputs stay the posterior's.
    """
    masses, shift = density.renewed(variances, reach * pull), free @ pull
    wanted = C_prior @ (reach * pull)
    for _ in range(AGAIN):
        lost = wanted - density.outputs(masses - density.mass)
        if np.sqrt(np.mean(lost**2)) < LOST:
            break
        more = cho_solve((factor, True), reach * lost, check_finite=False)
        masses, shift = density.renewed(variances, reach * more, masses), shift + free @ more
    return masses, shift


LOST = 1e-5  # strokes
_BIG = 30.0  # sd of the strength of a trace that is left out, in ranges


LEADING = 25  # directions of what may be wrong that noise is not judged by


def _leading(traces: Array) -> Array:
    """An orthonormal basis (n, r) of the directions most traces share."""
    if not traces.shape[1]:
        return np.zeros((traces.shape[0], 0))
    size = np.sqrt(np.sum(traces**2, axis=0))
    u = np.linalg.svd(traces[:, size > 0] / size[size > 0], full_matrices=False)[0]
    return u[:, : min(LEADING, traces.shape[0] // 6)]


def _units(
    story: Story, told: Retelling, subject: Subject, coupled: list[Readings], speed: Array, added: Array
) -> tuple[Array, Array, Array, Array]:
    """Per coupled reading: own white noise (scaled), covariance of free zeros, scale, slope to y (scaled)."""
    raw, span = _raw_noise(story, subject), subject.stroke
    white, scale, zero, at = [], [], [], 0
    for k, r in enumerate(coupled):
        y = r.value - told.values[r.kind]
        own = {"settled": 0.0, "moving": raw}.get(r.kind)
        noise = max(_local_noise(y), _FINEST["resistance"]) if own is None else own
        scale.append(np.full(len(r), noise if own is None else span))
        late = JITTER_S * speed[at : at + len(r)] if r.kind == "moving" else np.zeros(len(r))
        late = given.scatter(story, told, subject) if story.given else late
        rough = INEXACT * np.abs(added[at : at + len(r)])
        white.append(np.full(len(r), 1.0) if own is None else np.sqrt(noise**2 + late**2 + rough**2) / span)
        at += len(r)
        shared = story.zero[r.step] if story.zero.size else np.zeros(len(r), dtype=np.int64)
        zero.append(np.full(len(r), -1 - k) if own is None else shared)
    own_zero, scales = np.concatenate(zero), np.concatenate(scale)
    same = own_zero[:, None] == own_zero[None, :]
    size = np.where(own_zero >= 0, ANY, _ANY_ZERO)
    slope = told.follows * span / scales
    free = np.where(same, np.outer(size, size), 0.0)
    beyond = np.where(own_zero >= 0, 0.0, UNSEEN * slope * (told.output - subject.hysteresis.y_lower) / span)
    return np.concatenate(white), free + np.outer(beyond, beyond), scales, slope


def _added(story: Story, told: Retelling, subject: Subject) -> Array:
    """What the subject's effects change in each coupled reading, (n,)."""
    if not subject.effects:
        return np.zeros(told.output.size)
    plain = retold(story, replace(subject, effects=()))
    return np.concatenate(
        [told.values[r.kind] - plain.values[r.kind] for r in story.kinds if r.kind in COUPLED]
    )


def _speed(told: Retelling, path: Array) -> Array:
    """Output per second at each coupled reading, over the tick before it; ``path`` (m,) is the output at ticks."""
    at, before = told.marks, np.maximum(told.marks - 1, 0)
    return np.abs(path[at] - path[before]) / np.maximum(told.t_s[at] - told.t_s[before], 1e-9)


def _noise(memory: Array, own: Array, s_T: float, slope: Array) -> Array:
    """Σ, scaled, of each reading's own variance (n,) and of what the hysteresis remembers."""
    C = slope[:, None] * (s_T**2 * memory) * slope
    C[np.diag_indices_from(C)] += own
    return C


def _own(white: Array, moves: Array, s_m: float, s0: float) -> Array:
    """Variances (n,): s₀ is in every position, s_m in moving ones, a reading's own noise beside them."""
    return white**2 + s_m**2 * moves + np.where(white < 1.0, s0**2, 0.0)


def _likeliest(
    y: Array,
    shapes: tuple[Array, ...],
    fixed: Array,
    white: Array,
    moves: Array,
    slope: Array,
    start: Array,
    bounds: tuple[Array, Array],
) -> tuple[float, Array]:
    """(−log likelihood, log₁₀ of the spreads) at its least; ``shapes`` of the density's parts, then memory noise.

    Where a search ends at a bound of s_T, another begins from the other side: draughts and the rest mimic each other.
    """
    parts = [slope[:, None] * shape * slope for shape in shapes]
    positions = np.where(white < 1.0, 1.0, 0.0)

    def cost(x: Array) -> tuple[float, Array]:
        *weights, s_m, s0, s_T = 10.0**x
        weights.append(s_T**2)
        C = fixed.copy()
        for w, part in zip(weights, parts):
            C += w * part
        C[np.diag_indices_from(C)] += _own(white, moves, s_m, s0)
        try:
            L = cholesky(C, lower=True, check_finite=False, overwrite_a=True)
        except LinAlgError:
            return 1e12, np.zeros(x.size)
        inverse = dpotri(L, lower=1)[0]  # its lower half
        a = cho_solve((L, True), y, check_finite=False)
        value = 0.5 * float(y @ a) + float(np.log(np.diag(L)).sum())
        diagonal = np.diag(inverse).copy()
        by = [2 * float(np.vdot(inverse, S)) - float(diagonal @ np.diag(S)) - float(a @ S @ a) for S in parts]
        alone = diagonal - a * a
        slopes = [w * b for w, b in zip(weights[:-1], by)]
        slopes += [
            2 * s_m**2 * float(alone @ moves),
            2 * s0**2 * float(alone @ positions),
            2 * s_T**2 * by[-1],
        ]
        return value, 0.5 * np.log(10.0) * np.array(slopes)

    def least(start: Array) -> OptimizeResult:
        return minimize(
            cost,
            np.clip(start, *bounds),
            jac=True,
            method="L-BFGS-B",
            bounds=list(zip(*bounds)),
            options={"maxiter": 30, "ftol": 1e-5},
        )

    found = least(start)
    if min(found.x[-1] - bounds[0][-1], bounds[1][-1] - found.x[-1]) < NEAR:
        calm = found.x[-1] > DRAUGHTY
        again = least(np.append(_START[:-1], CALM if calm else DRAUGHTY))
        found = min(found, again, key=lambda f: float(f.fun))
    return float(found.fun), found.x


NEAR, CALM = 0.05, -2.0  # log₁₀: of a bound of s_T; and of s_T in still air
DRAUGHTY = -0.8  # log₁₀ of s_T where every search begins: from still air it would not find draughts
_START = np.array(
    [-0.5, -1.5, -4.5, -4.0, -3.7, DRAUGHTY]
)  # log₁₀ of spreads: density's parts; s_m, s₀ (ranges); s_T (K)
ASTRAY = (1e-5, 0.1)  # ranges: what moving positions may miss besides; wrong heat must not bend the density
DRAUGHTIEST_K = 0.4  # what is more is no draught
FINEST_MARK = 0.1  # counts: no encoder's marks lie better
COARSEST = 0.6  # counts: no mean of settled samples is worse, unless they scatter


def _bounds(story: Story, subject: Subject) -> tuple[Array, Array]:
    """Of the search above: no mean is better than its samples allow, and a misfit of kelvins is not a draught."""
    if story.given:
        span = subject.hysteresis.upper - subject.hysteresis.lower
        return _with_density(*given.bounds(story, span, subject.stroke))
    samples = max(float(np.median([step.n for run in story.runs for step in run.settled])), 1.0)
    one = _raw_noise(story, subject)
    least, most = (
        max(one / np.sqrt(samples), FINEST_MARK * subject.per_count) / subject.stroke,
        max(COARSEST * subject.per_count, one) / subject.stroke,
    )
    return _with_density((least, most), (10**-2.5, DRAUGHTIEST_K))


def _with_density(position: tuple[float, float], kelvin: tuple[float, float]) -> tuple[Array, Array]:
    """Bounds of all spreads, log₁₀: those of the density's parts, then s₀ and s_T as given."""
    return (
        np.array([-6.0, -6.0, -9.0, np.log10(ASTRAY[0]), np.log10(position[0]), np.log10(kelvin[0])]),
        np.array([2.0, 2.0, 0.0, np.log10(ASTRAY[1]), np.log10(position[1]), np.log10(kelvin[1])]),
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


def _apart(readings: Readings, story: Story, told: Retelling) -> tuple[Array, Array, Array]:
    """A block of its own, white noise judged by what a smooth curve leaves; free constants but for currents."""
    y = readings.value - told.values[readings.kind]
    noise = max(_local_noise(y), _FINEST[readings.kind])
    if readings.kind == "current":
        return np.eye(y.size), np.full(y.size, noise), y
    sitting = _sitting(readings, story)
    same = np.where(sitting[:, None] == sitting, _ANY_ZERO**2, 0.0)
    return same + np.eye(y.size), np.full(y.size, noise), y - _own_means(y, readings, story)


def _own_means(y: Array, readings: Readings, story: Story) -> Array:
    """The mean (n,) of each sitting."""
    sitting = _sitting(readings, story)
    return (np.bincount(sitting, y) / np.maximum(np.bincount(sitting), 1))[sitting]


def _sitting(readings: Readings, story: Story) -> NDArray[np.int64]:
    return story.zero[readings.step] if story.sittings else np.zeros(len(readings), dtype=np.int64)


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
