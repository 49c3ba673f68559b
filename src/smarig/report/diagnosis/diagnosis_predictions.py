"""A diagnosis as its figures see it: the story lived by both models, what each misses, noise, slopes.

Also the words that captions share. Knows the diagnosis; refuses to know figures and HTML.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.diagnosis import Diagnosis, drive_statistics, memory_covariance, memory_slopes
from smarig.preisach import sensitivities
from smarig.replay import OUTPUT_DEPENDENT_KINDS, Prediction, ReadingSeries, Timeline, plant_model_of, predict
from smarig.report.components.numbers import number
from smarig.report.components.run_description import protocol_name, source_label
from smarig.report.components.style import INK, MODEL

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DiagnosisPredictions:
    """The story as the base model tells it, and as the extended one does (None without one)."""

    d: Diagnosis
    base: Prediction
    extended: Prediction | None

    @classmethod
    def of(cls, d: Diagnosis) -> "DiagnosisPredictions":
        """Predicted once more where there is an extended model."""
        after = predict(d.timeline, plant_model_of(d.model, d.timeline.runs[0])) if d.extended else None
        return cls(d, predict(d.timeline, d.base), after)

    @property
    def labelled(self) -> tuple[tuple[Prediction, str, str], ...]:
        """(prediction, name of its residuals, colour)."""
        first = (self.base, "measured − base model", INK)
        return (first, (self.extended, "measured − extended model", MODEL)) if self.extended else (first,)

    def residuals(self, prediction: Prediction, kind: str) -> Array:
        """Measured minus predicted (n,) of one kind of reading; its free zero removed (currents have none)."""
        timeline = self.d.timeline
        error = readings(timeline, kind).value - prediction.values[kind]
        if kind == "current":
            return error
        zero = drive_statistics(timeline).residual_zeros(readings(timeline, kind))
        return error - np.array([error[zero == z].mean() for z in zero])


def readings(timeline: Timeline, kind: str) -> ReadingSeries:
    """The readings of one kind."""
    return next(r for r in timeline.all_readings if r.kind == kind)


def rms_noise(d: Diagnosis, kind: str) -> tuple[float, float]:
    """Rms noise of one kind of reading: its own, and with the draughts that the hysteresis remembers."""
    critique = d.levels[-1].critique if d.levels else d.first
    fitted, before = critique.refitted, 0
    for r in d.timeline.all_readings[: [r.kind for r in d.timeline.all_readings].index(kind)]:
        before += len(r)
    here = slice(before, before + len(readings(d.timeline, kind)))
    if kind not in OUTPUT_DEPENDENT_KINDS:
        own = rms(fitted.scale[here])
        return own, own
    J, times = memory_slopes(critique.plant_model.hysteresis, critique.prediction)
    share = (
        np.diag(memory_covariance(J, times, fitted.noise.correlation_s))[here]
        * critique.prediction.output_slope[here] ** 2
    )
    own = rms(fitted.noise.white[here])
    return own, float(np.hypot(own, fitted.noise.temperature_K * np.sqrt(share.mean())))


def input_slopes(d: Diagnosis) -> Array:
    """∂y/∂u to the input (k,) of the base model at the settled points."""
    states = d.first.prediction.states[: len(d.timeline.settled)]
    return np.array([s[-1] for s in sensitivities(d.first.plant_model.hysteresis, states)])


def models_text(predictions: DiagnosisPredictions, half_ranges: Sequence[float]) -> str:
    """Which colour is which model, and how far its axis reaches (base, extended)."""
    if predictions.extended is None:
        return ""
    finer = half_ranges[0] / half_ranges[-1]
    where = "on the same axes" if finer == 1 else f"on an axis {number(finer, 2)} times finer"
    return f" (black: base model; green: extended model, {where})"


def diagnosis_caption(d: Diagnosis, *, dotted: bool = False) -> tuple[str, ...]:
    """The caption's last sentence: which runs, on what rig; ``dotted`` where a line shows their beginnings."""
    protocols = ", ".join(dict.fromkeys(map(protocol_name, d.timeline.runs)))
    parts = [
        f"{len(d.timeline.runs)} training run{'s' if len(d.timeline.runs) > 1 else ''} ({protocols}"
        + ("; a dotted line where the next begins)" if dotted and len(d.timeline.runs) > 1 else ")"),
        *rig_text(d),
    ]
    return ("; ".join(part for part in parts if part) + ".",)


def rig_text(d: Diagnosis) -> tuple[str, ...]:
    """Rig, wire and seed, as far as known."""
    run = d.timeline.runs[0]
    rig, wire, seed = run.info.rig, run.info.wire, run.info.seed
    known = (
        f"rig {rig}" if rig else "",
        f"wire {wire}" if wire else "",
        f"seed {seed}" if source_label(run) and seed is not None else "",
    )
    return tuple(part for part in known if part)


def rms(values: ArrayLike, weight: Array | None = None) -> float:
    """Root of the mean square, weighted if asked for."""
    return float(np.sqrt(np.average(np.asarray(values, dtype=float) ** 2, weights=weight)))
