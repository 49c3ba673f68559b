"""The candidates: every effect of the catalogue and every dependence on a variable, as traces in the timeline.

The traces of a named candidate are the changes of each reading by its weak effect, one trace for each combination
of its other parameters. A generic candidate is a smooth function of one variable, added to the position or to the
temperature. All candidates are compared by the same measure.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.critique.recorded_period import recorded_period_h
from smarig.diagnosis.drive_statistics import DriveStatistics
from smarig.diagnosis.refit.refit import Refit
from smarig.plant import Effect, EffectType, Parameter
from smarig.replay import PlantModel, Prediction, Timeline, predict

Array = NDArray[np.float64]
WEAK_SHARE = 0.25  # of the typical strength: here a trace is proportional to the strength
MAX_EXTRAPOLATION = 3.0  # times a strength that was tried: limit of extrapolation
EXPECTED_SHARE = 0.01  # of output and of input range: expected size of a dependence on a variable
DETECTION_SD = 4.0  # standard deviations by which the largest strength must exceed the noise


@dataclass(frozen=True, eq=False)
class Candidate:
    """Whitened traces (N, v) of one explanation.

    A named candidate has ``kind`` and ``variants`` (v), each with one trace; ``signed`` if its strength may be
    negative. A generic candidate has ``depends_on``, and its traces together are an orthonormal basis. ``size``
    (v,) is the whitened length per unit of strength.
    """

    name: str
    traces: Array
    kind: EffectType | None = None
    variants: tuple[Effect, ...] = ()
    depends_on: str = ""
    size: Array = field(default_factory=lambda: np.empty(0))

    @property
    def typical(self) -> list[Array]:
        """Raw traces of expected size, in sets that belong together: each (N, k)."""
        if self.kind is None:
            return [self.traces]
        typical = abs(self.kind.primary.typical)
        return [t[:, None] * (typical / abs(p.strength)) for t, p in zip(self.traces.T, self.variants)]

    @property
    def generic(self) -> bool:
        """Whether the candidate is a variable instead of an effect."""
        return self.kind is None

    @property
    def signed(self) -> bool:
        """Whether the strength may be negative."""
        return self.kind is not None and self.kind.primary.lower < 0

    def explained_share(self, data: Array) -> Array:
        """Share (m,) of the squares of whitened data (N,) or (N, m) that the best variant explains."""
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
        """The variant that explains most of whitened data (N,), at its best strength."""
        projection = self.traces.T @ data
        score = np.abs(projection) if self.signed else projection
        k = int(np.argmax(score))
        kind, variants = self.kind, self.variants[k]
        assert kind is not None  # noqa: S101 - only named candidates have variants
        primary = kind.primary
        strength = float(np.sign(variants.strength) * projection[k] / self.size[k])
        if primary.tries:  # not proportional to the strength: stay where the trace is valid
            strength = float(
                np.clip(
                    strength, variants.strength / MAX_EXTRAPOLATION, variants.strength * MAX_EXTRAPOLATION
                )
            )
        values = {**variants.values, primary.name: min(max(strength, primary.lower), primary.upper)}
        return kind(**values), float(score[k])

    def gain(self, data: Array) -> Array:
        """½ N log(1/(1 − share)), (m,): the log likelihood ratio with the size of the noise refitted."""
        return -0.5 * data.shape[0] * np.log1p(-np.minimum(self.explained_share(data), 1 - 1e-12))


def named(
    timeline: Timeline, plant_model: PlantModel, base: Prediction, kinds: Sequence[EffectType]
) -> Iterator[Candidate]:
    """A candidate for each effect type, with raw traces: the changes by its weak effect."""
    zero = base.stacked(timeline)
    for kind in kinds:
        variants = tuple(_variants(kind, timeline))
        traces = np.column_stack(
            [predict(timeline, plant_model, [p]).stacked(timeline) - zero for p in variants]
        )
        yield Candidate(kind.name, traces, kind, variants)


def whitened(candidate: Candidate, refitted: Refit) -> Candidate:
    """The candidate with traces whitened to unit length, without those that cannot be seen in these data.

    A trace is visible if the largest strength within its bounds would exceed the noise.
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
    others = kind.parameters[1:]
    for strength in kind.primary.tries or (WEAK_SHARE * kind.primary.typical,):
        for values in product(*[_tries(p, timeline) for p in others]):
            yield kind(strength, **{p.name: v for p, v in zip(others, values)})


def _tries(parameter: Parameter, timeline: Timeline) -> tuple[float, ...]:
    unit = timeline.duration_h if parameter.of_record else 1.0
    tries = [t * unit for t in parameter.tries or (parameter.typical,)]
    period_h = recorded_period_h(timeline, parameter.period_of) if parameter.period_of else None
    tries += [period_h] if period_h else []
    return tuple(float(np.clip(t, parameter.lower, parameter.upper)) for t in tries)


def generic(
    timeline: Timeline, plant_model: PlantModel, base: Prediction, slope: Array
) -> Iterator[Candidate]:
    """Generic candidates for each variable z of the timeline: five smooth functions each, added to output or input;
    raw traces.

    Other channels may depend on time and level on their own.
    """
    total, h = sum(len(r) for r in timeline.all_readings), plant_model.hysteresis
    output_change, input_change = (
        EXPECTED_SHARE * abs(plant_model.stroke),
        EXPECTED_SHARE * (h.upper - h.lower),
    )
    at = 0
    for r in timeline.all_readings:
        if r.kind not in ("settled", "moving"):
            for name, z in {"time": r.t_s, "level": timeline.target_K[r.step]}.items():
                traces = np.zeros((total, min(5, np.unique(z).size - 1)))
                traces[at : at + len(r)] = EXPECTED_SHARE * (float(np.ptp(r.value)) or 1.0) * _smooth(z)
                yield Candidate(f"?{name} of {r.kind}", traces, depends_on=name)
        at += len(r)
    statistics = DriveStatistics(timeline)
    for name, z in statistics.variables(base).items():
        basis = _smooth(z)
        if not basis.shape[1]:
            continue
        both = np.column_stack([output_change * basis, input_change * basis * slope[: z.size, None]])
        traces = np.zeros((total, both.shape[1]))
        traces[: z.size] = both
        yield Candidate(f"?{name}", traces, depends_on=name)


def _smooth(z: Array, functions: int = 5) -> Array:
    """Cosines over the ranks of z, (n, up to 5): smooth in z for any distribution of its values."""
    values, where = np.unique(np.round(z, 9), return_inverse=True)
    if values.size < 2:
        return np.empty((z.size, 0))
    rank = (np.arange(values.size) + 0.5) / values.size
    waves = np.arange(1, min(functions, values.size - 1) + 1)
    return np.cos(np.pi * rank[:, None] * waves[None, :])[where]
