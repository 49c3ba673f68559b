"""Predictions of a model along the samples of a run, one at a time, in the encoder's zero.

A predictor that missed part of the history returns NaN until saturation has wiped out the missed part. The zero is the
mean difference between model and data over the first samples after the encoder was zeroed.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from smarig.core import Array, Sample
from smarig.plant import Actuator, Plant, SupportsHooks
from smarig.preisach import Everett, Initial, Preisach, State

NAN = float("nan")
OFFSET_SAMPLES = 50


class SamplePredictor(Protocol):
    """Predicts the output after each sample of a run."""

    def after(self, s: Sample, input_value: float) -> float:
        """Output after a sample, in its own zero; NaN if unknown."""
        ...

    def invalidate(self) -> None:
        """Called after missed samples."""
        ...


class HysteresisPredictor:
    """The hysteresis alone, along the input; with ``initial`` None its memory is unknown at first."""

    def __init__(self, hysteresis: Everett, initial: Initial | None) -> None:
        self.operator = Preisach(hysteresis, initial or "negative")
        self._lower, self._upper = hysteresis.lower, hysteresis.upper
        self._known = initial is not None

    def after(self, s: Sample, input_value: float) -> float:
        """The operator's output at the input."""
        del s
        if not math.isfinite(input_value):
            return NAN
        y = self.operator.step(input_value)
        if not self._known and not self._lower < input_value < self._upper:
            self._known = True
        return y if self._known else NAN

    def invalidate(self) -> None:
        """Return NaN until saturation."""
        self._known = False

    @property
    def state(self) -> State | None:
        """The memory, None while unknown."""
        return self.operator.state if self._known else None


class PlantPredictor:
    """A complete plant with effects, along the measured current."""

    def __init__(
        self,
        actuator: Actuator,
        hysteresis: Everett,
        initial: Initial,
        dt_s: float,
        effects: Sequence[SupportsHooks],
    ) -> None:
        self._plant = Plant(actuator, hysteresis, initial, dt_s, effects)
        self._invalid = False

    def after(self, s: Sample, input_value: float) -> float:
        """The plant's position after a tick at the measured current."""
        del input_value
        y = self._plant.step(s.current_A) if math.isfinite(s.current_A) else NAN
        return NAN if self._invalid else y

    def invalidate(self) -> None:
        """Return NaN from now on, because the thermal state after a gap is unknown."""
        self._invalid = True


class PrecomputedPredictor:
    """Outputs that were computed before, one per sample."""

    def __init__(self, outputs: Array) -> None:
        self._outputs = iter(outputs.tolist())

    def after(self, s: Sample, input_value: float) -> float:
        """The next output."""
        del s, input_value
        return next(self._outputs, NAN)

    def invalidate(self) -> None:
        """No effect: every output was computed before."""


@dataclass(frozen=True)
class NamedPredictor:
    """A predictor with its name in the legend."""

    name: str
    predictor: SamplePredictor


class ZeroedPredictor:
    """A predictor in the encoder's zero."""

    def __init__(self, predictor: SamplePredictor) -> None:
        self._predictor = predictor
        self.zeroed()

    def zeroed(self) -> None:
        """The encoder was zeroed: restart the mean difference."""
        self._sum, self._n, self._offset = 0.0, 0, NAN

    def after(self, s: Sample, input_value: float) -> float:
        """Output after a sample, comparable with its position."""
        y = self._predictor.after(s, input_value)
        if self._n < OFFSET_SAMPLES and y == y and s.position == s.position:
            self._sum += y - s.position
            self._n += 1
            self._offset = self._sum / self._n
        return y - self._offset

    def invalidate(self) -> None:
        """Called after missed samples."""
        self._predictor.invalidate()
