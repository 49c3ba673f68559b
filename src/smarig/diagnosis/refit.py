"""Everything refitted at once: what data leave unexplained whatever density the hysteresis has.

    y = Γ[u] + e,    Γ of any smooth density (``free_density``),    e ~ N(0, Σ)     ⇒     y ~ N(0, C)

How smooth, and how large the noise, are those of largest likelihood. An effect's trace t then explains
½ (tᵀC⁻¹y)²/(tᵀC⁻¹t) nats more than a new density alone could. Knows no effects.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular

from smarig.diagnosis import given
from smarig.diagnosis.free_density import free_density
from smarig.diagnosis.instruments import apart, own_means, speed, units
from smarig.diagnosis.noise import propagated, remembered
from smarig.diagnosis.posterior import Posterior
from smarig.diagnosis.spreads import DRAUGHTY, START, Stack, bounds_of
from smarig.diagnosis.suspects import suspect
from smarig.story.retelling import COUPLED, Retelling, retold
from smarig.story.subject import Subject
from smarig.story.told import Story

Array = NDArray[np.float64]
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
    log₁₀ of the density's parts' variances, s_m, s₀ and s_T; ``posterior`` the density that these readings speak for.
    """

    factor: Array
    scale: Array
    data: Array
    noise: Noise
    fitted: Array
    log_evidence: float
    coupled: int
    spreads: Array
    posterior: Posterior

    def centred(self, rest: Array, story: Story) -> Array:
        """Whitened (N,) readings minus predictions, the free constants of blocks apart taken out as in ``data``."""
        at = 0
        rest = rest.copy()
        for r in story.kinds:
            if r.kind not in COUPLED and r.kind != "current":
                rest[at : at + len(r)] -= own_means(rest[at : at + len(r)], r, story)
            at += len(r)
        return self.whitened(rest)

    def whitened(self, traces: Array) -> Array:
        """L⁻¹ of traces in the readings' units, (N,) or (N, m)."""
        scaled = traces / (self.scale if traces.ndim == 1 else self.scale[:, None])
        return solve_triangular(self.factor, scaled, lower=True, check_finite=False)


def refit(
    story: Story,
    told: Retelling,
    subject: Subject,
    suspects: Sequence[Array] = (),
    like: "Refit | None" = None,
    *,
    wary: bool = False,
    noise_of: "Refit | None" = None,
) -> Refit:
    """Likelihood-best smoothness and noise for a story as retold, and its readings whitened by them.

    ``suspects``: sets of traces (N, k), of which any one may be in the readings with strengths ~ N(0, 1); the noise
    is the likeliest with the likeliest of them, or with none, so no hidden effect passes for noise. ``wary``: all
    may be in at once. ``like``: begin where another refit ended; ``noise_of``: spreads as in another.
    """
    coupled = [r for r in story.kinds if r.kind in COUPLED]
    y = np.concatenate([r.value - told.values[r.kind] for r in coupled])
    span, n, h = subject.stroke, y.size, subject.hysteresis
    path = told.lived(h, subject.initial, told.felt_K)
    added = _added(story, told, subject)
    white, free, scale, reach = units(story, told, subject, coupled, speed(told, path), added)
    prior = free_density(told, h, path, told.output)
    whole = y + told.follows * (told.output - h.y_lower)  # of any hysteresis, not only a change of this one
    moves = np.concatenate([np.full(len(r), float(r.kind == "moving")) for r in coupled])
    stack = Stack(whole / scale, prior.covariances, free, white, moves, reach, bounds_of(story, subject))
    J, times = remembered(h, told)
    memories = [
        (seconds, propagated(J, times, seconds) / span**2)
        for seconds in _correlations_s(story, noise_of or like)
    ]
    if noise_of is not None:
        found, (correlation, memory) = noise_of.spreads, memories[0]
        cost = stack.cost(memory, found)
    else:
        begin, sets = START if like is None else like.spreads, [t[:n] / scale[:, None] for t in suspects]
        cost, found, correlation, memory = _judged(stack, memories, begin, sets, wary)
    *variances, _, s0, s_T = 10.0**found
    noise_part, density = stack.noise(memory, found), stack.density(found)
    C = reach[:, None] * density * reach + free + noise_part
    others = [apart(r, story, told) for r in story.kinds if r.kind not in COUPLED]
    factor, scales, data = _stacked([(C, scale, y), *others])
    whitened = solve_triangular(factor, data / scales, lower=True, check_finite=False)
    alone = float(0.5 * whitened[n:] @ whitened[n:] + np.log(np.diag(factor)[n:] * scales[n:]).sum())
    pull = solve_triangular(factor[:n, :n], whitened[:n], lower=True, trans=1, check_finite=False)
    sd = np.sqrt(np.diag(noise_part) - s_T**2 * reach**2 * np.diag(memory)) * scale
    late = float(np.median(sd[moves > 0])) if moves.any() else 0.0
    tells = scale * ((white < 1.0) & (told.sitting == 0))
    return Refit(
        factor,
        scales,
        whitened,
        Noise(sd, s_T, correlation, span * s0, late),
        y - scale * (noise_part @ pull),
        -cost - float(np.log(scale).sum()) - alone,  # of readings in their own units
        n,
        found,
        Posterior(
            prior,
            np.array(variances),
            density,
            reach,
            factor[:n, :n],
            free,
            pull,
            tells,
            span,
            h.y_lower,
            story.unit,
        ),
    )


def _correlations_s(story: Story, like: "Refit | None") -> tuple[float, ...]:
    """Correlation times of remembered noise worth trying."""
    if like is not None:
        return (like.noise.correlation_s,)
    return given.correlations_s(story) if story.given else CORRELATIONS_S


def _judged(
    stack: Stack, memories: Sequence[tuple[float, Array]], begin: Array, sets: Sequence[Array], wary: bool
) -> tuple[float, Array, float, Array]:
    """As ``_remembering``, with the likeliest suspect aside, or with all."""
    found = _remembering(stack, memories, begin)
    if not sets:
        return found
    aside = np.column_stack(sets) if wary else suspect(stack, found[3], found[:2], sets)
    return found if aside is None else _remembering(stack, memories, found[1], aside)


def _remembering(
    stack: Stack, memories: Sequence[tuple[float, Array]], begin: Array, aside: Array | None = None
) -> tuple[float, Array, float, Array]:
    """(cost, spreads, correlation time, remembered noise per K²) of the correlation time that is likeliest."""
    best: tuple[float, Array, float, Array] | None = None
    for seconds, memory in memories:
        start = begin if best is None else np.append(best[1][:-1], DRAUGHTY)
        cost, found = stack.likeliest(memory, start, aside)
        if best is None or cost < best[0]:
            best = (cost, found, seconds, memory)
    assert best is not None  # noqa: S101 - there is always one to try
    return best


def _added(story: Story, told: Retelling, subject: Subject) -> Array:
    """What the subject's effects change in each coupled reading, (n,)."""
    if not subject.effects:
        return np.zeros(told.output.size)
    plain = retold(story, replace(subject, effects=()))
    return np.concatenate(
        [told.values[r.kind] - plain.values[r.kind] for r in story.kinds if r.kind in COUPLED]
    )


def _stacked(blocks: list[tuple[Array, Array, Array]]) -> tuple[Array, Array, Array]:
    size = sum(y.size for _, _, y in blocks)
    factor, at = np.zeros((size, size)), 0
    for C, _, y in blocks:
        factor[at : at + y.size, at : at + y.size] = cholesky(C, lower=True, check_finite=False)
        at += y.size
    return factor, np.concatenate([s for _, s, _ in blocks]), np.concatenate([y for _, _, y in blocks])
