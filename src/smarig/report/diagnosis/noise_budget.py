"""The noise in a diagnosis: a table of readings and ambient fluctuations, their sum, and the time step error."""

from collections.abc import Iterator

import numpy as np

from smarig.diagnosis import MIN_COUNT_SD, POINT_NOISE, Critique, Diagnosis
from smarig.report.components.html import Html, paragraph, table
from smarig.report.components.numbers import number
from smarig.report.components.run_description import count_size, display_unit
from smarig.report.diagnosis.diagnosis_predictions import input_slopes, rms_noise


def noise_budget(d: Diagnosis) -> Iterator[Html]:
    """The table and its sentences."""
    size = count_size(d.timeline.runs[0])
    unit, u = display_unit(d.timeline.unit), display_unit(d.timeline.runs[0].input_unit)
    critiques = [d.first, *[level.critique for level in d.levels[-1:]]]
    whole = rms_noise(d, "settled")[1]
    rows = [
        ("Settled position, σ of a reading", *(number(c.refitted.noise.settled) for c in critiques), unit),
        *_count_row(critiques, size),
        (
            "Ambient fluctuation, σ of the input",
            *(number(c.refitted.noise.temperature_K) for c in critiques),
            u,
        ),
        (
            "Ambient fluctuation, correlation time",
            *(number(c.refitted.noise.correlation_s) for c in critiques),
            "s",
        ),
        (
            "Ambient fluctuation × rms slope ∂y/∂u",
            *(number(v) for v in _fluctuation_effect(d, critiques)),
            unit,
        ),
    ]
    header = ("Noise", "Base model", *(["With the effects"] if len(critiques) > 1 else []), "Unit")
    yield table(
        header,
        rows,
        "Maximum-likelihood noise, jointly with a smooth density and the most likely effects.",
    )
    yield paragraph(
        f"Together, the {POINT_NOISE}: {number(whole, 2)} {unit} rms{_counts_text(whole, size, unit)}. It includes "
        "past ambient fluctuations that remain in the state of the hysteresis until they are wiped out."
    )
    if d.noise_is_least_assumed:
        yield paragraph(
            f"σ of a reading is at its lower bound of {MIN_COUNT_SD:g} counts: the scatter is not larger."
        )
    yield paragraph(
        f"Error of the time steps: settled points change by at most {number(d.numerics, 2)} {unit} if each step is "
        f"divided by four, {_relative_to_noise(d.numerics, d.error.noise_floor)}."
    )


def _count_row(critiques: list[Critique], size: float) -> Iterator[tuple[str, ...]]:
    if size:
        yield (
            "The same in encoder counts",
            *(number(c.refitted.noise.settled / size, 2) for c in critiques),
            "counts",
        )


def _counts_text(value: float, size: float, unit: str) -> str:
    return f", {number(value / size, 2)} counts of {number(size)} {unit}" if size else ""


def _fluctuation_effect(d: Diagnosis, critiques: list[Critique]) -> list[float]:
    slope = float(np.sqrt(np.mean(input_slopes(d) ** 2)))
    return [c.refitted.noise.temperature_K * slope for c in critiques]


def _relative_to_noise(numerics: float, floor: float) -> str:
    if numerics < 1e-3 * floor:
        return "which is negligible compared with the noise"
    return f"{numerics / floor:.2g} of the {POINT_NOISE}"
