"""The fit of all parameters of an explanation's effects to all readings, by Levenberg–Marquardt.

    minimise ‖L⁻¹ (y − f(θ))‖² over θ within its bounds;  f(θ): prediction; density deviations are free in C

f(θ) is the prediction of the timeline; C contains free deviations of the density. So nothing is linearised in the
strength, and the interval of θ includes what the density could explain instead.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from smarig.core import Array
from smarig.diagnosis.refit.refit import Refit
from smarig.plant import Effect, Parameter
from smarig.preisach import Everett
from smarig.replay import PlantModel, Timeline, predict, with_hysteresis

MAX_ITERATIONS = 10
JUMP_MIN_TRIES = 6  # tries of a time in the record: the effect of the time is a jump
_MAX_SCANS = 4
_EDGE_SHARE = 0.04  # of the record, at its start and end
_DIFFERENCE_STEP = 0.02  # of a parameter's typical size, for derivatives
_CONVERGED_NATS = 0.2  # nats: gain at convergence
_MAX_DAMPING = 1.0  # damping at which the fit stops


@dataclass(frozen=True, eq=False)
class ParameterFit:
    """Effects with their values, the density of the fit, and standard deviations by (effect, parameter).

    ``conditional_spread``: the standard deviations if all other parameters were known. ``residual`` (N,) is the
    whitened residual. ``moved`` is the largest change of a parameter from its start, in standard deviations.
    """

    effects: tuple[Effect, ...]
    spread: dict[tuple[str, str], float]
    conditional_spread: dict[tuple[str, str], float]
    residual: Array
    plant_model: PlantModel
    moved: float

    @property
    def misfit(self) -> float:
        """χ²: the residual in units of the noise."""
        return float(self.residual @ self.residual)

    @property
    def extended(self) -> PlantModel:
        """The plant model with these effects."""
        return replace(self.plant_model, effects=self.effects)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects, in order."""
        return tuple(sorted(p.kind.name for p in self.effects))


def fit_parameters(
    start: Sequence[Effect],
    timeline: Timeline,
    plant_model: PlantModel,
    refitted: Refit,
    centre: Everett,
    output: Array | float = 0.0,
) -> ParameterFit:
    """Fit the parameters of effects by least squares, from a start and within bounds.

    The density of the plant model determines the prediction. ``centre`` is the output from which density deviations
    in C are counted; it is the same for all explanations that are compared. ``output`` (N,) is added to the residual:
    that of the centre if deviations are counted from zero, so that what a density has taken up holds no parameter.
    """
    fit = _FreeParameters(tuple(start), timeline.duration_h)
    data = np.concatenate([r.value for r in timeline.all_readings])

    def residual(x: Array) -> Array:
        prediction = predict(timeline, replace(plant_model, effects=()), fit.at(x))
        return refitted.centred(
            data - with_hysteresis(prediction, plant_model, centre).stacked(timeline) + output, timeline
        )

    x, r, J = _levenberg_marquardt(residual, fit)
    for _ in range(_MAX_SCANS):
        moved = _scan_jumps(residual, fit, timeline, x, r)
        if moved is None:
            break
        fit.x = moved
        x, r, J = _levenberg_marquardt(residual, fit)
    variance = max(float(r @ r) / r.size, 1.0)
    spread, conditional_spread = (
        _standard_errors(J, variance),
        np.sqrt(variance / np.maximum(np.sum(J**2, axis=0), 1e-300)),
    )
    start_values = np.array([p.values[q] for p in start for q in p.values if (p.kind.name, q) in fit.names])
    moved = float(np.max(np.abs(x - start_values) / np.maximum(spread, 1e-300), initial=0.0))
    named, named_conditional = (dict(zip(fit.names, sd.tolist())) for sd in (spread, conditional_spread))
    return ParameterFit(fit.at(x), named, named_conditional, r, plant_model, moved)


def _scan_jumps(
    residual: Callable[[Array], Array], fit: "_FreeParameters", timeline: Timeline, x: Array, r: Array
) -> Array | None:
    """Better values of parameters that act in jumps (a time in the record), or None."""
    best, found = float(r @ r) - 2 * _CONVERGED_NATS, None
    step = timeline.duration_h / max(len(timeline.settled), 1)
    for k in np.flatnonzero(fit.jumps):
        for offset in (-16, -8, -4, -2, -1, 1, 2, 4, 8, 16):
            trial = x.copy()
            trial[k] = np.clip(x[k] + offset * step, fit.low[k], fit.high[k])
            new = residual(trial)
            if float(new @ new) < best:
                best, found = float(new @ new), trial
    return found


class _FreeParameters:
    """The free parameters: strengths, and those for which several values are tried."""

    def __init__(self, start: tuple[Effect, ...], hours: float) -> None:
        self.start = start
        moved = [(p.kind.name, q) for p in start for q in p.kind.parameters if _is_free(p, q)]
        self.names = [(name, q.name) for name, q in moved]
        self.x = np.array([p.values[q.name] for p in start for q in p.kind.parameters if _is_free(p, q)])
        self.low = np.array([q.lower for _, q in moved])
        self.high = np.array([q.upper for _, q in moved])
        self.jumps = np.array(
            [q.of_record and q.unit == "h" and len(q.tries) > JUMP_MIN_TRIES for _, q in moved]
        )
        self.low[self.jumps] = _EDGE_SHARE * hours  # a jump at the start or end of the record has no effect
        self.high[self.jumps] = (1 - _EDGE_SHARE) * hours
        self.size = np.array([abs(q.typical) or 0.1 * (q.upper - q.lower) for _, q in moved])

    def at(self, x: Array) -> tuple[Effect, ...]:
        """The effects at parameters x (p,)."""
        values = dict(zip(self.names, x.tolist()))
        return tuple(
            p.kind(**{q: values.get((p.kind.name, q), v) for q, v in p.values.items()}) for p in self.start
        )


def _is_free(effect: Effect, parameter: Parameter) -> bool:
    return parameter is effect.kind.primary or len(parameter.tries) > 1


def _levenberg_marquardt(
    residual: Callable[[Array], Array], fit: _FreeParameters
) -> tuple[Array, Array, Array]:
    """Levenberg–Marquardt with clipped steps and Broyden's updates: (x, residual, Jacobian) at the end.

    Parameters that act in jumps stay fixed: the derivative across a jump is meaningless and would spoil the others.
    """
    x: Array = np.clip(fit.x, fit.low, fit.high)
    r = residual(x)
    J, is_fresh_jacobian, damping = _jacobian(residual, x, r, fit), True, 1e-3
    smooth = ~fit.jumps
    for _ in range(MAX_ITERATIONS if J.any() else 0):  # else no parameter changes these readings
        normal = J.T @ J
        step = np.zeros(x.size)
        damped = normal + damping * np.diag(np.diag(normal) + 1e-12)
        step[smooth] = np.linalg.lstsq(damped[np.ix_(smooth, smooth)], -(J.T @ r)[smooth], rcond=None)[0]
        trial: Array = np.clip(x + step, fit.low, fit.high).astype(float)
        new, moved = residual(trial), trial - x
        improvement = float(r @ r - new @ new)
        if improvement <= 0 and is_fresh_jacobian:
            damping *= 30
        elif improvement <= 0:
            J, is_fresh_jacobian = _jacobian(residual, x, r, fit), True
            continue
        else:
            J = J + np.outer(new - r - J @ moved, moved) / max(float(moved @ moved), 1e-300)
            x, r, is_fresh_jacobian, damping = trial, new, False, damping / 5
        if improvement < 2 * _CONVERGED_NATS and (improvement > 0 or damping > _MAX_DAMPING):
            break
    return x, r, J


def _jacobian(residual: Callable[[Array], Array], x: Array, r: Array, fit: _FreeParameters) -> Array:
    columns = []
    for k in range(x.size):
        step = np.zeros(x.size)
        step[k] = _DIFFERENCE_STEP * fit.size[k]
        if x[k] + step[k] > fit.high[k]:
            step[k] = -step[k]
        columns.append((residual(x + step) - r) / step[k])
    return np.column_stack(columns)


def _standard_errors(J: Array, variance: float) -> Array:
    return np.sqrt(np.maximum(np.diag(np.linalg.pinv(J.T @ J)) * variance, 0.0))
