"""Figures of an identified material: each loop with the model, the phase diagram, the transformation strain."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from smarig.core import Array
from smarig.identification import (
    Estimate,
    MaterialIdentification,
    MaterialLaw,
    RecordFit,
    cooled_fraction,
    heated_fraction,
    heating_finish,
    transformation_strain,
)
from smarig.report.components.figure import Figure, Panel, Trace, axis, dots, error_bars, line
from smarig.report.components.run_description import source_label
from smarig.report.components.style import COMPARED, COOLING, EXTENDED, HEATING, INK, MEASURED, MODEL

TEMPERATURE, STRESS, STRAIN = "Temperature (°C)", "Stress (MPa)", "Strain (%)"
PERCENT = 100.0
_CURVE = 60  # points of a computed curve
_FINE = 4000
_NAME, _MARGIN = 0.11, 0.03  # of the range of an axis
_QUARTERS = (0.25, 0.5, 0.75)
_MIDDLE, _OUTER = {"width": 2.0}, {"width": 1.0, "dash": "dot"}


def all_loops(found: MaterialIdentification) -> Figure:
    """All loops of a kind in one plot, with the model."""
    panels = [
        Panel(
            list(_together(records)),
            {"xaxis": axis(title, range=_with_room(records)), "yaxis": axis(STRAIN)},
            480,
            wide=True,
            explore=True,
        )
        for title, records in _kinds(found)
    ]
    return Figure(
        panels,
        "All loops with the model.",
        [
            "Grey: readings. Green: one model for all of them.",
            _aligned(found),
        ],
        _label(found),
    )


def _kinds(found: MaterialIdentification) -> Iterator[tuple[str, list[RecordFit]]]:
    for isobaric, title in ((True, TEMPERATURE), (False, STRESS)):
        records = [r for r in found.records if r.record.isobaric == isobaric]
        if records:
            yield title, records


def _aligned(found: MaterialIdentification) -> str:
    """What the strain counts from, of records with zeros of their own."""
    return "The zero of strain is that of the model in each record." if found.own_zeros else ""


def _percent(r: RecordFit, strain: Array) -> Array:
    """Strain (n,) in % from the zero of the model."""
    return PERCENT * (strain - r.zero)


def _with_room(records: Sequence[RecordFit]) -> list[float]:
    """The range of an axis, with room for the names of the loads at the cold ends, or of the temperatures."""
    low = min(float(r.record.changing.min()) for r in records)
    high = max(float(r.record.changing.max()) for r in records)
    left = _NAME if records[0].record.isobaric else _MARGIN
    return [low - left * (high - low), high + _MARGIN * (high - low)]


def _together(records: Sequence[RecordFit]) -> Iterator[Trace]:
    for k, r in enumerate(records):
        first = k == 0
        x = r.record.changing
        yield line(
            x,
            _percent(r, r.record.strain),
            "readings" if first else "",
            MEASURED,
            width=3.2,
            showlegend=first,
        )
        yield line(x, _percent(r, r.strain), "model" if first else "", MODEL, width=1.3, showlegend=first)
    for r in records:
        k = int(np.argmin(r.record.changing) if r.record.isobaric else np.argmax(r.record.changing))
        yield dots(
            [r.record.changing[k]],
            [_percent(r, r.record.strain)[k]],
            "",
            INK,
            size=1,
            mode="markers+text",
            text=[r.record.condition],
            textposition="middle left" if r.record.isobaric else "top left",
            showlegend=False,
        )


def each_loop(found: MaterialIdentification) -> Figure:
    """A panel for each record: readings, model, and the prediction from the other loads."""
    panels = [
        Panel(
            list(_one(r)),
            {
                "xaxis": axis(TEMPERATURE if r.record.isobaric else STRESS),
                "yaxis": axis(STRAIN),
                "title": {"text": r.record.condition},
            },
            360,
        )
        for r in found.records
    ]
    predicted = any(r.left_out is not None for r in found.records)
    return Figure(
        panels,
        "Each loop with the model.",
        [
            "Grey: readings. Green: the model of all records.",
            "Dashed: the prediction of a model of the other loads, which has not seen this one."
            if predicted
            else "",
            _aligned(found),
        ],
        _label(found),
    )


def _one(r: RecordFit) -> Iterator[Trace]:
    x = r.record.changing
    yield line(x, _percent(r, r.record.strain), "readings", MEASURED, width=3.2)
    yield line(x, _percent(r, r.strain), "model", MODEL, width=1.4)
    if r.left_out is not None:
        yield line(x, _percent(r, r.left_out), "from the other loads", EXTENDED, width=1.4, dash="dash")


def phase_diagram(found: MaterialIdentification) -> Figure:
    """Where a quarter, a half and three quarters are transformed, and the transformation strain with its intervals."""
    stress = np.linspace(0.0, _most_stress(found), _CURVE)
    boundaries = [
        trace
        for fraction, name, colour in (
            (cooled_fraction, "cooling", COOLING),
            (heated_fraction, "heating", HEATING),
        )
        for trace in _boundary(found.law, stress, fraction, name, colour)
    ]
    strain = [
        line(stress, PERCENT * _strain(found, stress), "model", MODEL, width=1.6),
        _points(found.strains),
    ]
    what = "Transformation strain and elastic change" if found.strain_is_sum else "Transformation strain"
    return Figure(
        [
            Panel(boundaries, {"xaxis": axis(TEMPERATURE), "yaxis": axis(STRESS)}, 430),
            Panel(strain, {"xaxis": axis(STRESS), "yaxis": axis(f"{what} (%)")}, 430),
        ],
        "Phase diagram and transformation strain.",
        [
            "Left: where a half of the material is transformed (solid), a quarter and three quarters (dotted). "
            f"Right: {what.lower()} over the stress; bars: 95 % intervals."
        ],
        _label(found),
    )


def _boundary(
    law: MaterialLaw, stress: Array, fraction: Callable[..., Array], name: str, colour: str
) -> Iterator[Trace]:
    """The temperatures at which the fraction of martensite has a value, over stress."""
    width = (law.austenite_finish - law.martensite_finish) * law.wide_factor
    rise = float(heating_finish(law, stress[-1:])[0]) - law.austenite_finish
    at = np.linspace(law.martensite_finish - width, law.austenite_finish + width + rise, _FINE)
    for share in _QUARTERS:
        T = [float(np.interp(-share, -fraction(law, at, np.full(at.size, s)), at)) for s in stress]
        style = _MIDDLE if share == 0.5 else _OUTER
        yield line(T, stress, name if share == 0.5 else "", colour, showlegend=share == 0.5, **style)


def _strain(found: MaterialIdentification, stress: Array) -> Array:
    elastic = stress * found.law.compliance_change if found.strain_is_sum else 0.0
    return transformation_strain(found.law, stress) + elastic


def _points(strains: Sequence[tuple[float, Estimate]]) -> Trace:
    value = PERCENT * np.array([e.value for _, e in strains])
    low, high = (PERCENT * np.array([e.ci95[k] for _, e in strains]) for k in (0, 1))
    bars = error_bars(value, low, high, color=COMPARED[6], thickness=1.4, width=4)
    return dots([s for s, _ in strains], value, "at the loads", COMPARED[6], error_y=bars)


def _most_stress(found: MaterialIdentification) -> float:
    return max(float(r.record.stress_MPa.max()) for r in found.records) * 1.05


def _label(found: MaterialIdentification) -> str:
    return source_label(*(r.record.run for r in found.records))
