"""The traces of the effects of the catalogue: the changes of each reading by a weak effect.

There is one trace for each combination of an effect's other parameters, and one of the usual strength beside a density
that is moved with the input: what a density takes up is no trace.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from smarig.core import Array
from smarig.diagnosis.comparison.commanded.recorded_period import recorded_period_h
from smarig.diagnosis.refit.moved_density import with_moved_density
from smarig.plant import Effect, EffectType, Parameter
from smarig.replay import PlantModel, Prediction, Timeline, predict

WEAK_SHARE = 0.25  # of the typical strength: here a trace is proportional to the strength
DETECTION_SD = 4.0  # standard deviations by which the largest strength must exceed the noise


@dataclass(frozen=True, eq=False)
class Candidate:
    """The ``traces`` (N, v) of an effect type in the readings' units; ``variants`` (v) are the weak effects."""

    kind: EffectType
    traces: Array
    variants: tuple[Effect, ...]

    @property
    def name(self) -> str:
        """The name of the effect."""
        return self.kind.name

    def with_trace(self, variant: Effect, trace: Array) -> "Candidate":
        """The same with one more variant and its trace (N,)."""
        traces = np.column_stack([self.traces, trace])
        return replace(self, traces=traces, variants=(*self.variants, variant))


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
        yield Candidate(kind, traces, variants).with_trace(*_usual(timeline, plant_model, zero, variants))


def _usual(
    timeline: Timeline, plant_model: PlantModel, zero: Array, variants: Sequence[Effect]
) -> tuple[Effect, Array]:
    """An effect of the usual strength, with its trace (N,) beside a density that is moved with the input."""
    variant = variants[len(variants) // 2]
    usual = variant.at(variant.kind.primary.typical)
    model = replace(plant_model, effects=(*plant_model.effects, usual))
    moved = with_moved_density(timeline, model, plant_model.hysteresis)
    return usual, predict(timeline, moved).stacked(timeline) - zero


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
