"""Starting values from each record: where its branches are a tenth, a half and nine tenths through."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from smarig.core import Array
from smarig.identification.material.law import REFERENCE_DEGC
from smarig.identification.material.material_path import MaterialBranch
from smarig.identification.material.material_records import MaterialRecord
from smarig.identification.material.parameters import PARAMETERS, Choice

USUAL_SLOPE = 7.0  # MPa/K, of NiTi
USUAL_MODULUS = 6e4  # MPa
EXPONENTS = (0.6, 0.25)  # of the starts: a slightly and a strongly rounded transformation
# k in 1/MPa and H_min/H_sat: the strain saturates beyond the loads, or below them; or most of it is there at no stress
STRAIN_LAWS = ((0.003, 0.0), (0.02, 0.0), (0.02, 0.7))
_TENTHS = (0.1, 0.5, 0.9)
_WEAK = 0.15  # of the largest stroke: below it, thermal expansion hides the transformation
_END = 0.1  # of the readings of a branch


class _Passage(NamedTuple):
    """A full branch: stress, stroke, and the temperatures without stress (3,) at a tenth, a half, nine tenths of ξ."""

    cooling: bool
    stress_MPa: float
    stroke: float
    through: Array


def starting_values(
    records: Sequence[MaterialRecord], choice: Choice, exponents: Sequence[float] = EXPONENTS
) -> Iterator[dict[str, float]]:
    """One set of values for each combination of exponents and strain law."""
    passages = [p for r in records for p in _passages(r)]
    strongest = max(p.stroke for p in passages)
    passages = [p for p in passages if p.stroke >= _WEAK * strongest]
    for exponent in exponents:
        for rate, least in STRAIN_LAWS[
            : 1 + ("strain_rate" in choice.free) + ("strain_least" in choice.free)
        ]:
            yield bounded(_values(records, passages, choice, exponent, (rate, least)))


def _values(
    records: Sequence[MaterialRecord],
    passages: Sequence[_Passage],
    choice: Choice,
    exponent: float,
    strain_law: tuple[float, float],
) -> dict[str, float]:
    rate, least = strain_law
    stiff = _stiffness(records)
    saturated = _saturated(passages, rate, constant=choice.constant_strain or least > 0)
    found = {
        "modulus_austenite": stiff,
        "modulus_martensite": 0.7 * stiff,
        "strain_least": least * saturated,
        "strain_saturated": saturated,
        "strain_rate": rate,
        "strain_stress": 0.0,
        "expansion_austenite": 1e-5,
        "expansion_martensite": 7e-6,
        "wide_share": 0.4,
        "wide_factor": 4.0,
        **dict.fromkeys([n for n in PARAMETERS if n.startswith("exponent")], exponent),
    }
    names = {True: ("martensite", "start", "finish"), False: ("austenite", "finish", "start")}
    tenth = 0.5 * (1.0 + 0.1**exponent - 0.9**exponent)
    for cooling, (phase, near, far) in names.items():
        slope, (first, middle, last) = _line([p for p in passages if p.cooling == cooling])
        slope = choice.fixed.get(f"slope_{phase}", slope)
        half = 0.5 * max(first - last, 0.5) / (1.0 - 2.0 * tenth)
        found |= {f"slope_{phase}": slope, f"{phase}_{near}": middle + half, f"{phase}_{far}": middle - half}
    return {name: found[name] for name in choice.free}


def bounded(values: dict[str, float]) -> dict[str, float]:
    """The values, moved off the ends of their ranges."""
    found = {}
    for name, value in values.items():
        p = PARAMETERS[name]
        margin = 1e-4 * (p.inner(p.high) - p.inner(p.low))
        inner = np.clip(p.inner(max(value, p.low)), p.inner(p.low) + margin, p.inner(p.high) - margin)
        found[name] = p.outer(float(inner))
    return found


def _passages(record: MaterialRecord) -> Iterator[_Passage]:
    full = 0.7 * float(np.ptp(record.changing))
    for b in record.branches:
        rows = slice(b.first, b.stop)
        if float(np.ptp(record.changing[rows])) >= full and b.stop - b.first >= 5:
            yield _passage(record, b)


def _passage(record: MaterialRecord, b: MaterialBranch) -> _Passage:
    rows = slice(b.first, b.stop)
    T, stress, strain = record.temperature_degC[rows], record.stress_MPa[rows], record.strain[rows]
    if not record.isobaric:
        strain = strain - stress / _stiffness([record])
    ends = max(1, int(_END * T.size))
    first, last = float(np.median(strain[:ends])), float(np.median(strain[-ends:]))
    share = np.maximum.accumulate((strain - first) / (last - first if last != first else 1.0))
    at = np.interp(_TENTHS, share, np.arange(T.size))
    at_T, at_stress = np.interp(at, np.arange(T.size), T), np.interp(at, np.arange(T.size), stress)
    through = at_T - (0.0 if record.isobaric else 1.0) * at_stress / USUAL_SLOPE
    if not b.cooling:
        through = through[::-1]
    return _Passage(b.cooling, float(at_stress[1]) if record.isobaric else 0.0, abs(last - first), through)


def _line(passages: Sequence[_Passage]) -> tuple[float, Array]:
    """C in MPa/K, and the three temperatures (3,) without stress."""
    stress = np.array([p.stress_MPa for p in passages])
    through = np.array([p.through for p in passages])
    slope = USUAL_SLOPE
    if np.ptp(stress) > 0:
        slope = float(np.clip(1.0 / max(np.polyfit(stress, through[:, 1], 1)[0], 1e-3), 2.0, 40.0))
    return slope, np.mean(through - (stress / slope)[:, None], axis=0)


def _saturated(passages: Sequence[_Passage], rate: float, *, constant: bool) -> float:
    """H_sat that gives the stroke of the largest load."""
    most = max(passages, key=lambda p: p.stroke)
    return (
        most.stroke
        if constant or most.stress_MPa == 0
        else most.stroke / -float(np.expm1(-rate * most.stress_MPa))
    )


def _stiffness(records: Sequence[MaterialRecord]) -> float:
    """The slope of the first tenth of loading of the first isothermal record; a usual modulus without one."""
    for record in records:
        if not record.isobaric:
            b = record.branches[0]
            rows = slice(b.first, b.first + max(3, int(_END * (b.stop - b.first))))
            slope = float(np.polyfit(record.strain[rows], record.stress_MPa[rows], 1)[0])
            return float(np.clip(slope, 1e4, 1.5e5))
    return USUAL_MODULUS


def starting_zeros(records: Sequence[MaterialRecord], choice: Choice, modulus: float) -> Array:
    """The zeros of strain, from the hottest readings: ε − σ/E_A − α (T − T_ref)."""
    zeros = np.zeros(choice.n_zeros)
    for number in range(choice.n_zeros):
        own = [r for r, n in zip(records, choice.zeros) if n == number]
        zeros[number] = np.mean([_zero(r, modulus) for r in own])
    return zeros


def _zero(record: MaterialRecord, modulus: float) -> float:
    k = int(np.argmax(record.temperature_degC - record.stress_MPa / USUAL_SLOPE))
    expansion = 1e-5 * (float(record.temperature_degC[k]) - REFERENCE_DEGC)
    return float(record.strain[k]) - float(record.stress_MPa[k]) / modulus - expansion
