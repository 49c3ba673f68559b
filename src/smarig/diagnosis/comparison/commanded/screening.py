"""Screening of all effects: the left-out scores of the readings without what a weak effect changes, times a strength.

    e_b(θ) = P_bb⁻¹ (P (y − θ t))_b,    θ = tᵀPy / tᵀPt

Exact where a trace is proportional to the strength and the input is not moved; the best effects are then refined.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smarig.core import Array
from smarig.diagnosis.comparison.commanded.block_scores import Problem, trial_of
from smarig.diagnosis.comparison.commanded.commanded_problem import (
    CommandedProblem,
    FittedPlant,
    by_kind,
    less_optimism,
)
from smarig.diagnosis.comparison.commanded.effect_traces import DETECTION_SD, Candidate, named
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part, Trial
from smarig.plant import Effect, EffectType


@dataclass(frozen=True, eq=False)
class Screened:
    """An effect of the catalogue at the strength that its traces suggest, with its scores by linear traces.

    ``promise``: the score that it may reach, in nats. ``starts`` are other strengths to search from: by each channel
    that no density changes, and the usual one of either sign. ``whitened`` (N,) is its trace at this strength after
    density and constants have taken their part.
    ``detectable``: whether the largest strength within its bounds would exceed the noise.
    """

    effect: Effect
    trial: Trial
    promise: float
    starts: tuple[Effect, ...]
    whitened: Array
    detectable: bool

    @property
    def part(self) -> Part:
        """The part of a hypothesis."""
        return Part("effect", self.effect.kind.name)

    @property
    def hypothesis(self) -> ComparedHypothesis:
        """The effect alone, at this strength."""
        return ComparedHypothesis((self.part,), (self.trial,))


def candidates(subject: CommandedProblem) -> tuple[Candidate, ...]:
    """The traces of all effects about the base model, in the readings' units."""
    base = subject.base
    return tuple(named(subject.timeline, base.plant_model, base.prediction, subject.catalogue))


def screened(
    subject: CommandedProblem,
    fitted: FittedPlant,
    found: Sequence[Candidate],
    ranking: Sequence[Problem] | None = None,
) -> list[Screened]:
    """All effects that change a reading, the best first; ``ranking``: problems in which they are compared."""
    names = {e.kind.name for e in fitted.effects}
    problems = ranking or fitted.problems
    nothing = [trial_of(subject.timeline, p, {}).score for p in (fitted.problems, problems)]
    all_found = [
        one
        for c in found
        if c.name not in names and (one := _screened(subject, fitted, c, problems, nothing)) is not None
    ]
    return [one for one, _ in sorted(all_found, key=lambda pair: -pair[1])]


def _screened(
    subject: CommandedProblem,
    fitted: FittedPlant,
    candidate: Candidate,
    ranking: Sequence[Problem],
    nothing: Sequence[float],
) -> tuple[Screened, float] | None:
    """An effect and its score of ranking; ``nothing``: scores without it, of the fitted model and of ranking."""
    kind = candidate.kind
    if not np.any(candidate.traces):
        return None
    readings = by_kind(subject.timeline, candidate.traces)
    traces = [p.trace(readings) for p in fitted.problems]
    strengths, gains, sizes = _best_strengths(ranking, traces)
    largest = max(kind.primary.upper, -kind.primary.lower)
    share = largest / np.array([abs(e.strength) for e in candidate.variants])
    detectable = bool(np.any(share * sizes > DETECTION_SD))
    own = np.array([_bounded(kind, e, s) for e, s in zip(candidate.variants, strengths)])
    gains = gains * np.where(strengths != 0, 1 - (1 - own / np.where(strengths, strengths, 1.0)) ** 2, 0.0)
    k = int(np.argmax(gains))
    shifts = [t[:, k] * own[k] for t in traces]
    value = candidate.variants[k].strength * float(own[k])
    effect = kind(**{**candidate.variants[k].values, kind.primary.name: value})
    parameters = fitted.parameters | {f"{kind.name}.{n}": v for n, v in effect.values.items()}
    trial = trial_of(subject.timeline, fitted.problems, parameters, shifts)
    trial = less_optimism(trial, [*fitted.effects, effect])
    white = np.concatenate([p.root @ s for p, s in zip(fitted.problems, shifts)])
    ranked = trial_of(subject.timeline, ranking, parameters, shifts)
    by_channel = _by_channels(candidate, k, fitted.problems[1:], traces[1:])
    most = max((gain for _, gain in by_channel), default=0.0)
    usual = {kind.primary.typical, max(-kind.primary.typical, kind.primary.lower)} - {0.0}
    strengths_to_try = [s for s, _ in by_channel] + sorted(usual, key=lambda s: -s * value)
    promise = max(trial.score, nothing[0] + most)
    starts = tuple(effect.at(s) for s in strengths_to_try)
    return Screened(effect, trial, promise, starts, white, detectable), max(ranked.score, nothing[1] + most)


def _by_channels(
    candidate: Candidate, k: int, problems: Sequence[Problem], traces: Sequence[Array]
) -> list[tuple[float, float]]:
    """(strength, nats) by each independent channel alone, of variant ``k``; those that show something."""
    kind, variant = candidate.kind, candidate.variants[k]
    found = []
    for p, t in zip(problems, traces):
        multiples, gains, _ = _best_strengths([p], [t])
        if gains[k] > 0:
            found.append((variant.strength * _bounded(kind, variant, float(multiples[k])), float(gains[k])))
    return found


def _best_strengths(problems: Sequence[Problem], traces: Sequence[Array]) -> tuple[Array, Array, Array]:
    """(least-squares multiples (m,) of traces, nats (m,) that they gain, whitened lengths (m,) of the traces)."""
    square = sum(np.sum(t * (p.precision @ t), axis=0) for p, t in zip(problems, traces))
    product = sum(t.T @ (p.precision @ p.y) for p, t in zip(problems, traces))
    square, product = np.asarray(square), np.asarray(product)
    safe = np.where(square > 0, square, 1.0)
    strength = np.where(square > 0, product / safe, 0.0)
    return strength, 0.5 * strength * product, np.sqrt(np.maximum(square, 0.0))


def _bounded(kind: EffectType, variant: Effect, multiple: float) -> float:
    """The multiple of a variant's strength within the bounds of the strength."""
    value = float(np.clip(variant.strength * multiple, kind.primary.lower, kind.primary.upper))
    return value / variant.strength


def collinear(a: Screened, b: Screened) -> float:
    """cos² of two whitened traces: the share of what an effect explains that the other one explains as well."""
    norm = float(a.whitened @ a.whitened) * float(b.whitened @ b.whitened)
    return float(a.whitened @ b.whitened) ** 2 / norm if norm else 0.0
