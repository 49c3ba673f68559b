"""What a diagnosis says of noise: the table of readings and draughts, their sum, the error of the time steps.

Knows nothing of figures.
"""

from collections.abc import Iterator

import numpy as np

from smarig.diagnosis.critique import Critique
from smarig.diagnosis.diagnose import Diagnosis
from smarig.diagnosis.spreads import FINEST_MARK
from smarig.report.conditions import count_size, exact_unit
from smarig.report.diagnosed import noise_of, slopes
from smarig.report.html import Html, paragraph, table
from smarig.report.numbers import number


def noise_words(d: Diagnosis) -> Iterator[Html]:
    """A table and two sentences."""
    size = count_size(d.story.runs[0])
    unit, u = exact_unit(d.story.unit), exact_unit(d.story.runs[0].input_unit)
    critics = [d.first, *[level.critique for level in d.levels[-1:]]]
    whole = noise_of(d, "settled")[1]
    rows = [
        ("Settled position, σ of a reading", *(number(c.refitted.noise.settled) for c in critics), unit),
        *_in_counts(critics, size),
        (
            "Draughts, σ of the input",
            *(number(c.refitted.noise.temperature_K) for c in critics),
            u,
        ),
        ("Draughts, correlation time", *(number(c.refitted.noise.correlation_s) for c in critics), "s"),
        ("Draughts × rms slope ∂y/∂u", *(number(v) for v in _draughts(d, critics)), unit),
    ]
    header = ("Noise", "Base model", *(["With the effects"] if len(critics) > 1 else []), "Unit")
    yield table(
        header,
        rows,
        "Noise of largest likelihood beside any smooth density, the likeliest suspects set aside.",
    )
    yield paragraph(
        f"Together, with draughts as the hysteresis remembers them until they are wiped out: "
        f"{number(whole, 2)} {unit} rms at a settled point{_counts(whole, size, unit)}."
    )
    if size and critics[-1].refitted.noise.settled <= 1.001 * FINEST_MARK * size:
        yield paragraph(
            f"σ of a reading stands at the least that is allowed, {FINEST_MARK:g} counts: the scatter is no larger."
        )
    yield paragraph(
        f"The critic's own time steps: settled points move by at most {number(d.numerics, 2)} {unit} when every "
        f"step is divided by four, {_beside(d.numerics, d.error.noise_floor)}."
    )


def _in_counts(critics: list[Critique], size: float) -> Iterator[tuple[str, ...]]:
    if size:
        yield (
            "The same in encoder counts",
            *(number(c.refitted.noise.settled / size, 2) for c in critics),
            "counts",
        )


def _counts(value: float, size: float, unit: str) -> str:
    return f", {number(value / size, 2)} counts of {number(size)} {unit}" if size else ""


def _draughts(d: Diagnosis, critics: list[Critique]) -> list[float]:
    slope = float(np.sqrt(np.mean(slopes(d) ** 2)))
    return [c.refitted.noise.temperature_K * slope for c in critics]


def _beside(numerics: float, floor: float) -> str:
    if numerics < 1e-3 * floor:
        return "nothing beside the noise"
    return f"{numerics / floor:.2g} of the noise floor"
