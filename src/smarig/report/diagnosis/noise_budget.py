"""The noise in a diagnosis: a table of readings and of the wire's temperature, their sum, and the time step error."""

from collections.abc import Iterator

from smarig.core import root_mean_square
from smarig.diagnosis import MIN_COUNT_SD, POINT_NOISE, WIRE_NOISE, CommandedDiagnosis, NoiseEstimate
from smarig.report.components.html import Html, paragraph, table
from smarig.report.components.numbers import number
from smarig.report.components.run_description import count_size, display_unit
from smarig.report.diagnosis.diagnosis_predictions import input_slopes, rms_noise


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
