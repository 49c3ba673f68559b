"""What might be wrong: every effect of the catalogue, and every plain "it depends on …", as traces in this very story.

A named candidate's traces are what its effect, planted weakly, would have changed in each reading; one trace for
each combination of its other parameters. A generic candidate is a smooth function of one variable, added to
position or felt as temperature. All compete by the same measure. Knows no data and takes no decision.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.drive_statistics import drive_statistics
from smarig.diagnosis.refit.refit import Refit
from smarig.plant import Effect, EffectType, Parameter
from smarig.replay import PlantModel, Prediction, Timeline, predict

Array = NDArray[np.float64]
WEAK_SHARE = 0.25  # of the typical strength: where a trace is still in proportion
MAX_EXTRAPOLATION = 3.0  # times a strength that was tried
EXPECTED_SHARE = 0.01  # of output and of input range: what may depend on any variable
DETECTION_SD = 4.0  # standard deviations that the largest strength must stand out by


@dataclass(frozen=True, eq=False)
class Candidate:
    """Whitened traces (N, v) of one explanation.

    ``kind`` with ``variants`` (v) for a named one: each trace by itself, ``signed`` when strength may be negative.
    ``depends_on`` for a generic one: the traces together, an orthonormal basis. ``size`` (v,): whitened length per
    unit of strength.
    """

    name: str
    traces: Array
    kind: EffectType | None = None
    variants: tuple[Effect, ...] = ()
    depends_on: str = ""
    size: Array = field(default_factory=lambda: np.empty(0))

    @property
    def typical(self) -> list[Array]:
        """Raw traces as large as one would expect, those together that go together: each (N, k)."""
        if self.kind is None:
            return [self.traces]
        typical = abs(self.kind.primary.typical)
        return [t[:, None] * (typical / abs(p.strength)) for t, p in zip(self.traces.T, self.variants)]

    @property
    def generic(self) -> bool:
        """Whether it names a variable instead of a cause."""
        return self.kind is None

    @property
    def signed(self) -> bool:
        """Whether the strength may be negative."""
        return self.kind is not None and self.kind.primary.lower < 0

    def explained_share(self, data: Array) -> Array:
        """Share of the squares of whitened data (N,) or (N, m) that the candidate takes up, best variant, (m,)."""
        y = data[:, None] if data.ndim == 1 else data
        total = np.sum(y**2, axis=0)
        if not self.traces.shape[1]:
            return np.zeros(y.shape[1])
        projection = self.traces.T @ y
        if self.generic:
            return np.sum(projection**2, axis=0) / total
        if not self.signed:
            projection = np.maximum(projection, 0.0)
        return np.max(projection**2, axis=0) / total

    def best(self, data: Array) -> tuple[Effect, float]:
        """The variant that takes up most of whitened data (N,), at the strength that does."""
        projection = self.traces.T @ data
        score = np.abs(projection) if self.signed else projection
        k = int(np.argmax(score))
        kind, variants = self.kind, self.variants[k]
        assert kind is not None  # noqa: S101 - only named candidates have variants
        primary = kind.primary
        strength = float(np.sign(variants.strength) * projection[k] / self.size[k])
        if primary.tries:  # not in proportion: no farther from the trace than it is true
            strength = float(
                np.clip(
                    strength, variants.strength / MAX_EXTRAPOLATION, variants.strength * MAX_EXTRAPOLATION
                )
            )
        values = {**variants.values, primary.name: min(max(strength, primary.lower), primary.upper)}
        return kind(**values), float(score[k])

    def gain(self, data: Array) -> Array:
        """½ N log(1/(1 − share)): the log likelihood ratio with the noise's size refitted, (m,)."""
        return -0.5 * data.shape[0] * np.log1p(-np.minimum(self.explained_share(data), 1 - 1e-12))


def named(
    timeline: Timeline, plant_model: PlantModel, base: Prediction, kinds: Sequence[EffectType]
) -> Iterator[Candidate]:
    """A candidate for each kind, with raw traces: what it would have changed, planted weakly."""
    zero = base.stacked(timeline)
    for kind in kinds:
        variants = tuple(_variants(kind, timeline))
        traces = np.column_stack(
            [predict(timeline, plant_model, [p]).stacked(timeline) - zero for p in variants]
        )
        yield Candidate(kind.name, traces, kind, variants)


def whitened(candidate: Candidate, refitted: Refit) -> Candidate:
    """Traces of unit length where nothing else explains them; those that cannot be seen here are left out.

    A trace is seen when the largest strength its bounds allow would stand out of the noise.
    """
    white = refitted.whitened(candidate.traces)
    if candidate.kind is None:
        q, r = np.linalg.qr(white)
        size = np.abs(np.diag(r))
        return replace(candidate, traces=q[:, size > 1e-6 * max(size.max(), 1e-300)])
    size = np.sqrt(np.sum(white**2, axis=0))
    largest = max(candidate.kind.primary.upper, -candidate.kind.primary.lower)
    strength = np.array([abs(p.strength) for p in candidate.variants])
    detectable = size * largest / strength > DETECTION_SD
    kept = tuple(p for p, s in zip(candidate.variants, detectable) if s)
    return replace(
        candidate,
        traces=white[:, detectable] / size[detectable],
        variants=kept,
        size=size[detectable] / strength[detectable],
    )


def _variants(kind: EffectType, timeline: Timeline) -> Iterator[Effect]:
    duration_h = timeline.duration_h
    others = kind.parameters[1:]
    for strength in kind.primary.tries or (WEAK_SHARE * kind.primary.typical,):
        for values in product(*[_tries(p, duration_h) for p in others]):
            yield kind(strength, **{p.name: v for p, v in zip(others, values)})


def _tries(parameter: Parameter, duration_h: float) -> tuple[float, ...]:
    unit = duration_h if parameter.of_record else 1.0
    tries = parameter.tries or (parameter.typical,)
    return tuple(float(np.clip(t * unit, parameter.lower, parameter.upper)) for t in tries)


def generic(
    timeline: Timeline, plant_model: PlantModel, base: Prediction, slope: Array
) -> Iterator[Candidate]:
    """ "It depends on z", for each z the story knows: added or felt, five smooth functions each; raw traces.

    Other channels may depend on time and level by themselves.
    """
    total, h = sum(len(r) for r in timeline.all_readings), plant_model.hysteresis
    output_change, input_change = EXPECTED_SHARE * plant_model.stroke, EXPECTED_SHARE * (h.upper - h.lower)
    at = 0
    for r in timeline.all_readings:
        if r.kind not in ("settled", "moving"):
            for name, z in {"time": r.t_s, "level": timeline.target_K[r.step]}.items():
                traces = np.zeros((total, min(5, np.unique(z).size - 1)))
                traces[at : at + len(r)] = EXPECTED_SHARE * (float(np.ptp(r.value)) or 1.0) * _smooth(z)
                yield Candidate(f"?{name} of {r.kind}", traces, depends_on=name)
        at += len(r)
    statistics = drive_statistics(timeline)
    for name, z in statistics.variables(base).items():
        basis = _smooth(z)
        if not basis.shape[1]:
            continue
        both = np.column_stack([output_change * basis, input_change * basis * slope[: z.size, None]])
        traces = np.zeros((total, both.shape[1]))
        traces[: z.size] = both
        yield Candidate(f"?{name}", traces, depends_on=name)
    for name, traces in statistics.rate_traces(base, output_change, input_change * slope):
        yield Candidate(f"?{name}", traces, depends_on=name)


def _smooth(z: Array, functions: int = 5) -> Array:
    """Cosines over the ranks of z, (n, up to 5): smooth in z wherever its values lie."""
    values, where = np.unique(np.round(z, 9), return_inverse=True)
    if values.size < 2:
        return np.empty((z.size, 0))
    rank = (np.arange(values.size) + 0.5) / values.size
    waves = np.arange(1, min(functions, values.size - 1) + 1)
    return np.cos(np.pi * rank[:, None] * waves[None, :])[where]
