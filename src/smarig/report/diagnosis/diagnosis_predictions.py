"""Data of a diagnosis for its figures: predictions of both models, residuals, noise and slopes; caption texts."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.diagnosis import CommandedDiagnosis, memory_covariance, memory_slopes
from smarig.preisach import sensitivities
from smarig.replay import OUTPUT_DEPENDENT_KINDS, Prediction, ReadingSeries, Timeline, plant_model_of, predict
from smarig.report.components.numbers import number
from smarig.report.components.run_description import protocol_name
from smarig.report.components.style import INK, MODEL


@dataclass(frozen=True, eq=False)
class DiagnosisPredictions:
    """The predictions of the base model and of the extended model (None without one)."""

    d: CommandedDiagnosis
    base: Prediction
    extended: Prediction | None

    @classmethod
    def of(cls, d: CommandedDiagnosis) -> "DiagnosisPredictions":
        """The predictions of a diagnosis; those of an extended model are computed here."""
        after = predict(d.timeline, plant_model_of(d.model, d.timeline.runs[0])) if d.extended else None
        return cls(d, predict(d.timeline, d.base), after)

    @property
    def labelled(self) -> tuple[tuple[Prediction, str, str], ...]:
        """(prediction, name of its residuals, colour) of each model."""
        first = (self.base, "measured − base model", INK)
        return (first, (self.extended, "measured − extended model", MODEL)) if self.extended else (first,)

    def residuals(self, prediction: Prediction, kind: str) -> Array:
        """Measured − predicted (n,) of one kind of reading, with the free zero removed (currents have none)."""
        timeline = self.d.timeline
        error = readings(timeline, kind).value - prediction.values[kind]
        if kind == "current":
            return error
        return error - error.mean()


def readings(timeline: Timeline, kind: str) -> ReadingSeries:
    """The readings of one kind."""
    return next(r for r in timeline.all_readings if r.kind == kind)


def rms_noise(d: CommandedDiagnosis, kind: str) -> tuple[float, float]:
    """Rms noise of one kind of reading: by itself, and with that of the temperature in the state of the hysteresis."""
    model, before = d.fitted, 0
    fitted = model.refitted
    for r in d.timeline.all_readings[: [r.kind for r in d.timeline.all_readings].index(kind)]:
        before += len(r)
    here = slice(before, before + len(readings(d.timeline, kind)))
    if kind not in OUTPUT_DEPENDENT_KINDS:
        own = root_mean_square(fitted.scale[here])
        return own, own
    J, times = memory_slopes(model.plant_model.hysteresis, model.prediction)
    share = (
        np.diag(memory_covariance(J, times, fitted.noise.correlation_s))[here]
        * model.prediction.output_slope[here] ** 2
    )
    own = root_mean_square(fitted.noise.white[here])
    return own, float(np.hypot(own, fitted.noise.temperature_K * np.sqrt(share.mean())))


def input_slopes(d: CommandedDiagnosis) -> Array:
    """Slope ∂y/∂u of the base model with respect to the input (k,) at the settled points."""
    base = d.subject.base
    states = base.prediction.states[: len(d.timeline.settled)]
    return np.array([s[-1] for s in sensitivities(base.plant_model.hysteresis, states)])


def models_text(predictions: DiagnosisPredictions, half_ranges: Sequence[float]) -> str:
    """The colour of each model, and the ratio of their axes (base, extended)."""
    if predictions.extended is None:
        return ""
    finer = half_ranges[0] / half_ranges[-1]
    where = "on the same axes" if finer == 1 else f"on an axis {number(finer, 2)} times finer"
    return f" (black: base model; green: extended model, {where})"


def diagnosis_caption(d: CommandedDiagnosis, *, dotted: bool = False) -> tuple[str, ...]:
    """The last sentence of a caption: the training runs; ``dotted`` if dotted lines show the starts of runs."""
    protocols = ", ".join(dict.fromkeys(map(protocol_name, d.timeline.runs)))
    parts = [
        f"{len(d.timeline.runs)} training run{'s' if len(d.timeline.runs) > 1 else ''} ({protocols}"
        + ("; dotted lines: starts of runs)" if dotted and len(d.timeline.runs) > 1 else ")"),
    ]
    return ("; ".join(part for part in parts if part) + ".",)
