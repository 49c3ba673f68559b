"""Predictions of both models of a diagnosis, their residuals, and the noise: data for its figures, and a table."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from smarig.core import Array, root_mean_square
from smarig.diagnosis import (
    MIN_COUNT_SD,
    POINT_NOISE,
    WIRE_NOISE,
    CommandedDiagnosis,
    NoiseEstimate,
    memory_covariance,
    memory_slopes,
)
from smarig.preisach import sensitivities
from smarig.replay import OUTPUT_DEPENDENT_KINDS, Prediction, ReadingSeries, Timeline, plant_model_of, predict
from smarig.report.components.html import Html, paragraph, table
from smarig.report.components.numbers import number
from smarig.report.components.run_description import count_size, display_unit, protocol_name
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


def noise_budget(d: CommandedDiagnosis) -> Iterator[Html]:
    """The table and its sentences."""
    size = count_size(d.timeline.runs[0])
    unit, u = display_unit(d.timeline.unit), display_unit(d.timeline.runs[0].input_unit)
    noises = [d.subject.base.refitted.noise, *([d.noise] if d.extended else [])]
    whole = rms_noise(d, "settled")[1]
    rows = [
        ("Settled position, σ of a reading", *(number(n.settled) for n in noises), unit),
        *_count_row(noises, size),
        (
            f"{WIRE_NOISE.capitalize()}, σ of the input",
            *(number(n.temperature_K) for n in noises),
            u,
        ),
        (
            f"{WIRE_NOISE.capitalize()}, correlation time",
            *(number(n.correlation_s) for n in noises),
            "s",
        ),
        (
            f"{WIRE_NOISE.capitalize()} × rms slope ∂y/∂u",
            *(number(v) for v in _effect_of_wire_noise(d, noises)),
            unit,
        ),
    ]
    header = ("Noise", "Base model", *(["Extended model"] if len(noises) > 1 else []), "Unit")
    yield table(
        header,
        rows,
        "Maximum-likelihood noise, jointly with a smooth density.",
    )
    yield paragraph(
        f"Together, the {POINT_NOISE}: {number(whole, 2)} {unit} rms{_counts_text(whole, size, unit)}. It includes "
        f"the {WIRE_NOISE}, which is what the readings scatter along the input: the room, the readings of the current "
        "and the heating model contribute. Its past remains in the state of the hysteresis until it is wiped out."
    )
    if d.noise.settled <= 1.001 * MIN_COUNT_SD * abs(d.base.per_count):
        yield paragraph(
            f"σ of a reading is at its lower bound of {MIN_COUNT_SD:g} counts: the scatter is not larger."
        )
    yield paragraph(
        f"Error of the time steps: settled points change by at most {number(d.numerics, 2)} {unit} if each step is "
        f"divided by four, {_relative_to_noise(d.numerics, d.error.noise_floor)}."
    )


def _count_row(noises: list[NoiseEstimate], size: float) -> Iterator[tuple[str, ...]]:
    if size:
        yield (
            "The same in encoder counts",
            *(number(n.settled / size, 2) for n in noises),
            "counts",
        )


def _counts_text(value: float, size: float, unit: str) -> str:
    return f", {number(value / size, 2)} counts of {number(size)} {unit}" if size else ""


def _effect_of_wire_noise(d: CommandedDiagnosis, noises: list[NoiseEstimate]) -> list[float]:
    slope = root_mean_square(input_slopes(d))
    return [n.temperature_K * slope for n in noises]


def _relative_to_noise(numerics: float, floor: float) -> str:
    if numerics < 1e-3 * floor:
        return "which is negligible compared with the noise"
    return f"{numerics / floor:.2g} of the {POINT_NOISE}"
