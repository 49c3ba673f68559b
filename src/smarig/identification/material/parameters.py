"""The parameters of the law, the range that wires have, and which of them the kinds of records can determine."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from smarig.core import Array, UsageError
from smarig.identification.material.law import MaterialLaw
from smarig.identification.material.material_records import MaterialRecord

SAME_LEVEL = 0.02  # of the largest: levels that differ by less are one
STIFFEST_MPA, SOFTEST_AUSTENITE_MPA, SOFTEST_MPA = 3e5, 1e4, 2e3
MANY_LOADS = 4  # as many show more of ε_L(σ) than an exponential from no stress on
USUAL_MODULUS_MPA, USUAL_RATIO = 7e4, 0.5  # E_A and E_M/E_A of NiTi, where nothing determines them
_LARGEST_LOG = 700.0  # of a float
RATIO_SD = 0.35  # of log E_M/E_A: from a quarter to one
BY_RATIO = 0.0  # in place of E_M: it follows from E_A by the ratio


class MaterialParameter(NamedTuple):
    """A constant of the law: its symbol, unit, the range that wires have, and whether it is fitted by its logarithm."""

    symbol: str
    unit: str
    low: float
    high: float
    by_log: bool = False

    def inner(self, value: float) -> float:
        """The value as it is fitted."""
        return float(np.log(value)) if self.by_log else value

    def outer(self, inner: float) -> float:
        """The value of one that was fitted."""
        return float(np.exp(np.clip(inner, -_LARGEST_LOG, _LARGEST_LOG))) if self.by_log else inner


PARAMETERS = {
    "modulus_austenite": MaterialParameter("E_A", "MPa", SOFTEST_MPA, STIFFEST_MPA, True),
    "modulus_martensite": MaterialParameter("E_M", "MPa", SOFTEST_MPA, STIFFEST_MPA, True),
    "strain_least": MaterialParameter("H_min", "1", -3.0, 0.15),
    "strain_saturated": MaterialParameter("H_sat", "1", 1e-4, 0.2),
    "strain_rate": MaterialParameter("k", "1/MPa", 1e-4, 0.5, True),
    "strain_stress": MaterialParameter("σ_crit", "MPa", 0.0, 500.0),
    "austenite_start": MaterialParameter("A_s", "degC", -250.0, 1000.0),
    "austenite_finish": MaterialParameter("A_f", "degC", -250.0, 1000.0),
    "martensite_start": MaterialParameter("M_s", "degC", -250.0, 1000.0),
    "martensite_finish": MaterialParameter("M_f", "degC", -250.0, 1000.0),
    "slope_austenite": MaterialParameter("C_A", "MPa/K", 0.5, 100.0, True),
    "slope_martensite": MaterialParameter("C_M", "MPa/K", 0.5, 100.0, True),
    "exponent_cooling_start": MaterialParameter("n₁", "1", 0.05, 1.0),
    "exponent_cooling_finish": MaterialParameter("n₂", "1", 0.05, 1.0),
    "exponent_heating_finish": MaterialParameter("n₃", "1", 0.05, 1.0),
    "exponent_heating_start": MaterialParameter("n₄", "1", 0.05, 1.0),
    "expansion_austenite": MaterialParameter("α_A", "1/K", -5e-5, 5e-5),
    "expansion_martensite": MaterialParameter("α_M", "1/K", -5e-5, 5e-5),
    "wide_share": MaterialParameter("w", "1", 0.0, 0.9),
    "wide_factor": MaterialParameter("q", "1", 1.0, 50.0, True),
}
ZERO = MaterialParameter("ε_0", "1", -10.0, 10.0)  # of strain


@dataclass(frozen=True)
class Choice:
    """What is fitted: ``free`` parameters; values of the others; why each of the others is not known.

    ``constant_strain``: ε_L does not depend on the stress. ``shows_start``: there are loads enough to show that it
    begins at a stress. ``zeros`` (one per record) is the number of its zero. ``log_ratio`` is log E_M/E_A, where that
    is assumed.
    """

    free: tuple[str, ...]
    fixed: dict[str, float]
    reasons: dict[str, str]
    constant_strain: bool
    zeros: tuple[int, ...]
    reference_stress: float
    log_ratio: float
    shows_start: bool

    @property
    def n_zeros(self) -> int:
        """The number of zeros of strain."""
        return max(self.zeros) + 1

    def range_of(self, name: str) -> MaterialParameter:
        """The range of a parameter."""
        p = PARAMETERS[name]
        return p._replace(low=0.0) if name == "strain_least" and not self.shows_start else p

    def inner_bounds(self) -> tuple[Array, Array]:
        """The ranges of parameters and zeros as they are fitted."""
        every = [*map(self.range_of, self.free), *[ZERO] * self.n_zeros]
        return np.array([p.inner(p.low) for p in every]), np.array([p.inner(p.high) for p in every])

    @property
    def assumes_ratio(self) -> bool:
        """Whether E_M is that of a usual ratio E_M/E_A, which is not known."""
        return self.fixed.get("modulus_martensite") == BY_RATIO

    def law(self, values: dict[str, float], log_ratio: float | None = None) -> MaterialLaw:
        """The law with these values of the free parameters, and of log E_M/E_A if it is assumed."""
        every = {**self.fixed, **values}
        if self.assumes_ratio:
            ratio = np.exp(self.log_ratio if log_ratio is None else log_ratio)
            every["modulus_martensite"] = every["modulus_austenite"] * float(ratio)
        if self.constant_strain:
            every["strain_least"] = every["strain_saturated"]
        every |= _least_strain(every["strain_least"], every["strain_saturated"], every["strain_rate"])
        return MaterialLaw(**every, reference_stress=self.reference_stress)


def _least_strain(at_zero: float, saturated: float, rate: float) -> dict[str, float]:
    """H_min and σ_crit of the exponential that has the value ``at_zero`` at no stress.

    Above σ_crit only one combination of both acts. So either σ_crit is 0, or, where the exponential would begin below
    zero, H_min is 0 and σ_crit is where it becomes positive: ln(1 − H_0/H_sat)/k.
    """
    if at_zero >= 0.0:
        return {"strain_least": at_zero, "strain_stress": 0.0}
    return {"strain_least": 0.0, "strain_stress": float(np.log1p(-at_zero / saturated)) / rate}


def distinct_levels(records: Sequence[MaterialRecord], *, isobaric: bool) -> list[float]:
    """The levels of the records of a kind that count as different, rising."""
    levels = sorted(r.level for r in records if r.isobaric == isobaric)
    span = max(map(abs, levels), default=0.0)
    found: list[float] = []
    for level in levels:
        if not found or level - found[-1] > SAME_LEVEL * span:
            found.append(level)
    return found


def choose(records: Sequence[MaterialRecord], known: dict[str, float], *, two_parts: bool = False) -> Choice:
    """What these records determine; ``known`` are constants of an actuator file, for the rest.

    Raises UsageError where a constant is needed that neither gives.
    """
    loads = distinct_levels(records, isobaric=True)
    isothermal = [r for r in records if not r.isobaric]
    own_zeros = _zeros(records)
    fixed = {"strain_stress": 0.0}
    reasons: dict[str, str] = {}
    _moduli(len(loads), bool(isothermal), own_zeros, known, fixed, reasons)
    _slopes(loads, isothermal, known, fixed, reasons)
    if not two_parts:
        fixed |= {"wide_share": 0.0, "wide_factor": 1.0}
    levels = len(loads) + len(isothermal)
    constant = _strain_law(levels, fixed, reasons)
    if not loads:
        _expansions(known, fixed, reasons)
    free = tuple(name for name in PARAMETERS if name not in fixed)
    zeros = tuple(range(len(records))) if own_zeros else (0,) * len(records)
    ratio = known["modulus_martensite"] / known["modulus_austenite"] if known else USUAL_RATIO
    return Choice(
        free=free,
        fixed=fixed,
        reasons=reasons,
        constant_strain=constant,
        zeros=zeros,
        reference_stress=_reference(records),
        log_ratio=float(np.log(ratio)),
        shows_start=levels >= MANY_LOADS,
    )


def _reference(records: Sequence[MaterialRecord]) -> float:
    """σ*: the middle of the stresses."""
    return float(np.mean([np.ptp(r.stress_MPa) / 2 + r.stress_MPa.min() for r in records]))


def _zeros(records: Sequence[MaterialRecord]) -> bool:
    """Whether each record counts its strain from a zero of its own.

    With one zero, the hot wire is longer under each larger load, by what an elastic austenite gives.
    """
    if any(r.own_zero for r in records):
        return True
    isobaric = sorted((r for r in records if r.isobaric), key=lambda r: r.level)
    levels = np.array(distinct_levels(records, isobaric=True))
    if levels.size < 2:
        return len(isobaric) != len(records) or not isobaric
    hot = [
        np.mean([_hot(r) for r in isobaric if np.argmin(np.abs(levels - r.level)) == k])
        for k in range(levels.size)
    ]
    slopes = np.diff(hot) / np.diff(levels)
    return not bool(np.all((slopes >= 1.0 / STIFFEST_MPA) & (slopes <= 1.0 / SOFTEST_AUSTENITE_MPA)))


def _hot(record: MaterialRecord) -> float:
    """The strain at the hottest tenth of the readings."""
    hot = record.temperature_degC >= np.quantile(record.temperature_degC, 0.9)
    return float(np.mean(record.strain[hot]))


def _moduli(
    loads: int,
    isothermal: bool,
    own_zeros: bool,
    known: dict[str, float],
    fixed: dict[str, float],
    reasons: dict[str, str],
) -> None:
    if isothermal:
        return
    if own_zeros or loads < 2:
        why = (
            "each record counts its strain from a zero of its own"
            if own_zeros
            else "all records have one load"
        )
        reasons["modulus_austenite"] = (
            f"{why}, so the elastic strain of the austenite is not in the data; add an isothermal record"
        )
        fixed["modulus_austenite"] = known.get("modulus_austenite", USUAL_MODULUS_MPA)
    why = (
        "each record holds its stress, so only the sum of elastic and transformation strain, σ ΔS + ε_L(σ), is in the "
        "data; add an isothermal record"
    )
    reasons["modulus_martensite"] = why
    if loads < MANY_LOADS:
        fixed["modulus_martensite"] = BY_RATIO
    else:
        reasons |= {"strain_saturated": why, "strain_rate": why}


def _slopes(
    loads: Sequence[float],
    isothermal: Sequence[MaterialRecord],
    known: dict[str, float],
    fixed: dict[str, float],
    reasons: dict[str, str],
) -> None:
    temperatures = distinct_levels(isothermal, isobaric=False)
    if len(loads) + len(temperatures) >= 2:
        return
    held = f"under {loads[0]:.4g} MPa" if loads else f"at {temperatures[0]:.4g} °C"
    missing = "load" if loads else "temperature"
    if not {"slope_austenite", "slope_martensite"} <= known.keys():
        raise UsageError(
            f"All records were made {held}, so they cannot determine C_A and C_M, nor the transformation temperatures "
            f"without stress. Add records of another {missing}, or give --actuator, whose C_A and C_M are then used."
        )
    for name in ("slope_austenite", "slope_martensite"):
        fixed[name] = known[name]
        reasons[name] = f"all records were made {held}; add records of another {missing}"


def _strain_law(levels: int, fixed: dict[str, float], reasons: dict[str, str]) -> bool:
    """As many constants of ε_L(σ) as there are levels, at most three; whether ε_L is one constant."""
    needed = {"strain_rate": 2, "strain_least": 3}
    for name, fewest in needed.items():
        if levels < fewest:
            fixed[name] = 0.01 if name == "strain_rate" else 0.0
            reasons[name] = f"that takes {fewest} loads or temperatures, or more; the records have {levels}"
    return levels == 1


def _expansions(known: dict[str, float], fixed: dict[str, float], reasons: dict[str, str]) -> None:
    for name in ("expansion_austenite", "expansion_martensite"):
        fixed[name] = known.get(name, 0.0)
        reasons[name] = "each record holds its temperature; add an isobaric record"
