"""An explanation at its best: all parameters of its effects fitted to everything at once, by Levenberg–Marquardt.

    minimise ‖L⁻¹ (y − f(θ))‖² over θ within its bounds;  f(θ): the story retold, density deviations are free in C

so nothing is linear in the strength here, and the interval of θ carries what the density could do instead. Knows
neither which effects are worth it nor what is decided.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.refit import Refit
from smarig.model.effect import Parameter, Planted
from smarig.preisach.everett import Everett
from smarig.story.retelling import about, retold
from smarig.story.subject import Subject
from smarig.story.told import Story

Array = NDArray[np.float64]
ROUNDS = 10
MANY = 6  # tries of a time of the record: it acts in a jump, not smoothly
_SCANS = 4
_WITHIN = 0.04  # of the record
_STEP = 0.02  # of a parameter's typical size, for slopes
_DONE = 0.2  # nats
_STUBBORN = 1.0  # damping beyond which nothing helps any more


@dataclass(frozen=True, eq=False)
class Refined:
    """Effects with their values, beside the density they were fitted with; standard deviations by (effect, parameter).

    ``alone``: the same if all others were known; ``rest`` (N,) is what is left, whitened; ``moved`` how far any
    parameter went from its start, in standard deviations.
    """

    effects: tuple[Planted, ...]
    spread: dict[tuple[str, str], float]
    alone: dict[tuple[str, str], float]
    rest: Array
    subject: Subject
    moved: float

    @property
    def misfit(self) -> float:
        """χ²: what is left, in units of the noise."""
        return float(self.rest @ self.rest)

    @property
    def extended(self) -> Subject:
        """The wire with these effects."""
        return replace(self.subject, effects=self.effects)

    @property
    def names(self) -> tuple[str, ...]:
        """Of the effects, in order."""
        return tuple(sorted(p.kind.name for p in self.effects))

    def beyond(self, start: Sequence[Planted], far: float) -> tuple[Planted, ...]:
        """The effects ``far`` times as far from a start, within their bounds."""
        return tuple(_farther(a, b, far) for a, b in zip(start, self.effects))


def _farther(start: Planted, end: Planted, far: float) -> Planted:
    values = {
        p.name: float(
            np.clip(
                start.values[p.name] + far * (end.values[p.name] - start.values[p.name]), p.lower, p.upper
            )
        )
        for p in end.kind.parameters
    }
    return end.kind(**values)


def refined(
    start: Sequence[Planted], story: Story, subject: Subject, refitted: Refit, centre: Everett
) -> Refined:
    """Effects at the parameters of least squares, from a start; bounds hold.

    The subject's own density says what the wire lived through; ``centre`` is what density deviations in C are
    deviations from, the same for all explanations that are compared.
    """
    fit = _Fit(tuple(start), story.hours)
    data = np.concatenate([r.value for r in story.kinds])

    def rest(x: Array) -> Array:
        told = retold(story, replace(subject, effects=()), fit.at(x))
        return refitted.centred(data - about(told, subject, centre).stacked(story), story)

    x, r, J = _descend(rest, fit)
    for _ in range(_SCANS):
        moved = _scanned(rest, fit, story, x, r)
        if moved is None:
            break
        fit.x = moved
        x, r, J = _descend(rest, fit)
    variance = max(float(r @ r) / r.size, 1.0)
    spread, alone = _spread(J, variance), np.sqrt(variance / np.maximum(np.sum(J**2, axis=0), 1e-300))
    began = np.array([p.values[q] for p in start for q in p.values if (p.kind.name, q) in fit.names])
    moved = float(np.max(np.abs(x - began) / np.maximum(spread, 1e-300), initial=0.0))
    named, named_alone = (dict(zip(fit.names, sd.tolist())) for sd in (spread, alone))
    return Refined(fit.at(x), named, named_alone, r, subject, moved)


def _scanned(rest: Callable[[Array], Array], fit: "_Fit", story: Story, x: Array, r: Array) -> Array | None:
    """Better values of parameters that act in jumps (a time of the record), None if there are none."""
    best, found = float(r @ r) - 2 * _DONE, None
    step = story.hours / max(len(story.settled), 1)
    for k in np.flatnonzero(fit.jumps):
        for away in (-16, -8, -4, -2, -1, 1, 2, 4, 8, 16):
            trial = x.copy()
            trial[k] = np.clip(x[k] + away * step, fit.low[k], fit.high[k])
            new = rest(trial)
            if float(new @ new) < best:
                best, found = float(new @ new), trial
    return found


class _Fit:
    """Which parameters move: strengths, and whatever the critic tries several values of."""

    def __init__(self, start: tuple[Planted, ...], hours: float) -> None:
        self.start = start
        moved = [(p.kind.name, q) for p in start for q in p.kind.parameters if _moves(p, q)]
        self.names = [(name, q.name) for name, q in moved]
        self.x = np.array([p.values[q.name] for p in start for q in p.kind.parameters if _moves(p, q)])
        self.low = np.array([q.lower for _, q in moved])
        self.high = np.array([q.upper for _, q in moved])
        self.jumps = np.array([q.of_record and q.unit == "h" and len(q.tries) > MANY for _, q in moved])
        self.low[self.jumps] = _WITHIN * hours  # a jump at the very beginning or end is none
        self.high[self.jumps] = (1 - _WITHIN) * hours
        self.size = np.array([abs(q.typical) or 0.1 * (q.upper - q.lower) for _, q in moved])

    def at(self, x: Array) -> tuple[Planted, ...]:
        """The effects at parameters x (p,)."""
        values = dict(zip(self.names, x.tolist()))
        return tuple(
            p.kind(**{q: values.get((p.kind.name, q), v) for q, v in p.values.items()}) for p in self.start
        )


def _moves(planted: Planted, parameter: Parameter) -> bool:
    return parameter is planted.kind.primary or len(parameter.tries) > 1


def _descend(rest: Callable[[Array], Array], fit: _Fit) -> tuple[Array, Array, Array]:
    """Levenberg–Marquardt with clipped steps and Broyden's updates: (x, residual, Jacobian) where it ends.

    What acts in jumps stays where it is: across a jump a slope says nothing, and would spoil the others.
    """
    x: Array = np.clip(fit.x, fit.low, fit.high)
    r = rest(x)
    J, fresh, damping = _jacobian(rest, x, r, fit), True, 1e-3
    smooth = ~fit.jumps
    for _ in range(ROUNDS):
        normal = J.T @ J
        step = np.zeros(x.size)
        damped = normal + damping * np.diag(np.diag(normal) + 1e-12)
        step[smooth] = np.linalg.lstsq(damped[np.ix_(smooth, smooth)], -(J.T @ r)[smooth], rcond=None)[0]
        trial: Array = np.clip(x + step, fit.low, fit.high).astype(float)
        new, moved = rest(trial), trial - x
        better = float(r @ r - new @ new)
        if better <= 0 and fresh:
            damping *= 30
        elif better <= 0:
            J, fresh = _jacobian(rest, x, r, fit), True
            continue
        else:
            J = J + np.outer(new - r - J @ moved, moved) / max(float(moved @ moved), 1e-300)
            x, r, fresh, damping = trial, new, False, damping / 5
        if better < 2 * _DONE and (better > 0 or damping > _STUBBORN):
            break
    return x, r, J


def _jacobian(rest: Callable[[Array], Array], x: Array, r: Array, fit: _Fit) -> Array:
    columns = []
    for k in range(x.size):
        step = np.zeros(x.size)
        step[k] = _STEP * fit.size[k]
        if x[k] + step[k] > fit.high[k]:
            step[k] = -step[k]
        columns.append((rest(x + step) - r) / step[k])
    return np.column_stack(columns)


def _spread(J: Array, variance: float) -> Array:
    return np.sqrt(np.maximum(np.diag(np.linalg.pinv(J.T @ J)) * variance, 0.0))
