"""A constitutive model of the material from runs: parameters with intervals, what is not determined, errors."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from smarig.core import Array, UsageError, root_mean_square
from smarig.identification.interval_estimate import Estimate, variance_inflation
from smarig.identification.material.law import MaterialLaw, transformation_strain
from smarig.identification.material.material_covariance import covariance, half_width
from smarig.identification.material.material_fit import MaterialFit, fit_material, law_at
from smarig.identification.material.material_path import strain_along
from smarig.identification.material.material_records import MaterialRecord, material_records
from smarig.identification.material.material_text import material_text, value_text
from smarig.identification.material.measured_latent_heat import latent_heat
from smarig.identification.material.parameters import choose, distinct_levels
from smarig.identification.material.twin_material import TwinMaterial, twin_material
from smarig.plant import Actuator, Material
from smarig.record import Run, check_no_copies, load_run
from smarig.replay import recorded_actuator

SOURCE = "constitutive fit"
FEWEST_LOADS_LEFT_OUT = 3
RESOLUTION = 1e-6  # of strain: no extensometer shows less
_HOT = 0.9  # quantile of the temperature: a record with its own zero is aligned there


@dataclass(frozen=True, eq=False)
class RecordFit:
    """A record with the strain of the model (n,), and that of a model of the other loads, None without one.

    Both contain ``zero``, from which the strain of the record counts.
    """

    record: MaterialRecord
    strain: Array
    zero: float
    left_out: Array | None = None

    @property
    def rms(self) -> float:
        """The rms error of the strain."""
        return root_mean_square(self.record.strain - self.strain)

    @property
    def left_out_rms(self) -> float | None:
        """The rms error of the prediction from the other loads."""
        return None if self.left_out is None else root_mean_square(self.record.strain - self.left_out)


@dataclass(frozen=True, eq=False)
class MaterialIdentification:
    """The result of ``identify_material``.

    ``parameters`` by the names of the actuator file; ``not_determined``: why the others are not known.
    ``strains``: ε_L at the stress of each load, with ``strain_is_sum`` if elastic strain cannot be told from it.
    ``latent_heat`` is measured, or a sentence why not. ``twin`` are the constants of a thermomechanical twin, or a
    sentence why there are none; None without an actuator.
    """

    law: MaterialLaw
    parameters: dict[str, Estimate]
    not_determined: dict[str, str]
    strains: tuple[tuple[float, Estimate], ...]
    strain_is_sum: bool
    records: tuple[RecordFit, ...]
    two_parts: bool
    own_zeros: bool
    rms: float
    latent_heat: Estimate | str
    twin: TwinMaterial | str | None

    @property
    def n(self) -> int:
        """The number of readings."""
        return sum(r.record.strain.size for r in self.records)

    def write_actuator(self, path: str | Path, *, force: bool = False) -> Path:
        """Write an actuator file with the material; returns the path. Raises UsageError if there is none to write."""
        if self.twin is None:
            raise UsageError(
                "An actuator file needs a parameter set to start from, with the size of the wire. Name one with "
                "--actuator."
            )
        if isinstance(self.twin, str):
            raise UsageError(self.twin)
        return self.twin.write(Path(path), force=force)

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the command line."""
        return {
            "parameters": {n: e.to_json() for n, e in self.parameters.items()},
            "not_determined": dict(self.not_determined),
            "law": asdict(self.law),
            "transformation_strain": [
                {"stress_MPa": stress, **e.to_json(), "with_elastic_change": self.strain_is_sum}
                for stress, e in self.strains
            ],
            "two_parts": self.two_parts,
            "own_zeros": self.own_zeros,
            "records": [_record_json(r) for r in self.records],
            "rms": self.rms,
            "n": self.n,
            "latent_heat": self.latent_heat.to_json() if isinstance(self.latent_heat, Estimate) else None,
            "latent_heat_reason": None if isinstance(self.latent_heat, Estimate) else self.latent_heat,
            "twin": self.twin.to_json() if isinstance(self.twin, TwinMaterial) else None,
            "twin_reason": self.twin if isinstance(self.twin, str) else None,
        }

    def __str__(self) -> str:
        return material_text(self)


def identify_material(
    runs: Run | str | Path | Sequence[Run | str | Path],
    actuator: Actuator | None = None,
    *,
    leave_out: bool = True,
    progress: Callable[[str], None] = lambda _: None,
) -> MaterialIdentification:
    """Fit the law of Lagoudas et al. (2012) to isobaric and isothermal records (runs, or their paths).

    ``actuator`` gives the constants that the records do not determine, and the rest of an actuator file; None: that
    of the runs, if they state one. ``leave_out``: predict each load from the others, too. Raises UsageError or
    DataError, in one sentence, for records that cannot serve.
    """
    given = [runs] if isinstance(runs, Run | str | Path) else list(runs)
    loaded = [r if isinstance(r, Run) else load_run(r) for r in given]
    check_no_copies(loaded)
    records = material_records(loaded)
    actuator = actuator or _recorded(loaded)
    known = _known(actuator)
    progress(f"fitting {len(records)} records")
    fit, two_parts = _best(records, known)
    left_out: list[Array | None] = [None] * len(records)
    if leave_out and len(distinct_levels(records, isobaric=True)) >= FEWEST_LOADS_LEFT_OUT:
        progress("predicting each load from the others")
        left_out = _left_out(records, known, fit.law, two_parts=two_parts)
    spread = covariance(records, fit)
    n = fit.residuals.size
    parameters, reasons = _estimates(fit, spread, n)
    strains = _strains(records, fit, spread, n)
    heat = latent_heat(records, fit.law, actuator)
    twin = None if actuator is None else twin_material(fit.law, parameters, records, actuator, heat)
    return MaterialIdentification(
        law=fit.law,
        parameters=parameters,
        not_determined=reasons,
        strains=strains,
        strain_is_sum="modulus_martensite" in reasons,
        records=tuple(
            RecordFit(r, fit.strain(r, zero), float(fit.zeros[zero]), out)
            for r, zero, out in zip(records, fit.choice.zeros, left_out)
        ),
        two_parts=two_parts,
        own_zeros=fit.choice.n_zeros > 1,
        rms=root_mean_square(fit.residuals),
        latent_heat=heat,
        twin=twin,
    )


def _recorded(runs: Sequence[Run]) -> Actuator | None:
    """The actuator that the first run states, if any."""
    with suppress(UsageError):
        return recorded_actuator(runs[0])
    return None


def _known(actuator: Actuator | None) -> dict[str, float]:
    """The constants of an actuator file with a thermomechanical wire."""
    if actuator is None or actuator.file.thermomechanical is None:
        return {}
    m = Material.of(actuator.file)
    return {
        "modulus_austenite": m.austenite_MPa,
        "modulus_martensite": m.martensite_MPa,
        "slope_austenite": m.austenite_slope,
        "slope_martensite": m.martensite_slope,
        "expansion_austenite": m.austenite_expansion,
        "expansion_martensite": m.martensite_expansion,
    }


def _best(records: Sequence[MaterialRecord], known: dict[str, float]) -> tuple[MaterialFit, bool]:
    """The law with one width of transformation, or with two where they pay for their parameters.

    By the criterion of Schwarz, −2 log L + p log n, with readings that hang together counted once.
    """
    one = fit_material(records, choose(records, known))
    two = fit_material(records, choose(records, known, two_parts=True))
    n = one.residuals.size / variance_inflation(_by_branch(records, one.residuals))
    errors = [np.hypot(root_mean_square(fit.residuals), RESOLUTION) for fit in (one, two)]
    gain = 2.0 * n * np.log(errors[0] / errors[1])
    more = len(two.choice.free) - len(one.choice.free)
    return (two, True) if gain > more * np.log(n) else (one, False)


def _by_branch(records: Sequence[MaterialRecord], residuals: Array) -> list[Array]:
    found, first = [], 0
    for r in records:
        found += [residuals[first + b.first : first + b.stop] for b in r.branches]
        first += r.strain.size
    return found


def _left_out(
    records: Sequence[MaterialRecord], known: dict[str, float], near: MaterialLaw, *, two_parts: bool
) -> list[Array | None]:
    """For each isobaric record, the strain that a model of the other loads predicts."""
    levels = distinct_levels(records, isobaric=True)
    found: list[Array | None] = [None] * len(records)
    for level in levels:
        own = [k for k, r in enumerate(records) if r.isobaric and _nearest(levels, r.level) == level]
        others = [r for k, r in enumerate(records) if k not in own]
        fit = fit_material(others, choose(others, known, two_parts=two_parts), near)
        for k in own:
            found[k] = predicted_strain(fit, records[k])
    return found


def _nearest(levels: Sequence[float], level: float) -> float:
    return min(levels, key=lambda x: abs(x - level))


def predicted_strain(fit: MaterialFit, record: MaterialRecord) -> Array:
    """Strain (n,) of a record that was not fitted; one with its own zero is aligned at its hottest readings."""
    strain = strain_along(fit.law, record.temperature_degC, record.acting_MPa, record.branches)
    if fit.choice.n_zeros == 1:
        return strain + fit.zeros[0]
    hot = record.temperature_degC >= np.quantile(record.temperature_degC, _HOT)
    return strain + float(np.mean((record.strain - strain)[hot]))


def _estimates(fit: MaterialFit, spread: Array, n: int) -> tuple[dict[str, Estimate], dict[str, str]]:
    """The parameters that the records determine, and the reasons for the others."""
    reasons = dict(fit.choice.reasons)
    found: dict[str, Estimate] = {}
    for k, name in enumerate(fit.choice.free):
        p = fit.choice.range_of(name)
        half = half_width(lambda inner, k=k: float(inner[k]), fit, spread)
        low, high = (float(np.clip(p.outer(fit.inner[k] + x), p.low, p.high)) for x in (-half, half))
        if name in fit.at_bound:
            end = (
                p.low if abs(fit.inner[k] - p.inner(p.low)) < abs(fit.inner[k] - p.inner(p.high)) else p.high
            )
            reasons.setdefault(name, f"the fit ends at {value_text(name, end)}, the end of its range")
        elif low <= p.low and high >= p.high:
            reasons.setdefault(name, "the interval is as wide as the range that wires have")
        elif name not in reasons:
            found[name] = Estimate(p.outer(float(fit.inner[k])), (low, high), p.unit, SOURCE, n)
    return _with_least_strain(found, fit.law), reasons


def _with_least_strain(found: dict[str, Estimate], law: MaterialLaw) -> dict[str, Estimate]:
    """H_min, or where it is 0, σ_crit in its place."""
    least = found.get("strain_least")
    if least is None or least.value >= 0:
        return found
    ends = [np.log1p(max(-x, 0.0) / law.strain_saturated) / law.strain_rate for x in least.ci95]
    start = Estimate(law.strain_stress, (float(ends[1]), float(ends[0])), "MPa", least.source, least.n)
    return {**{name: e for name, e in found.items() if name != "strain_least"}, "strain_stress": start}


def _strains(
    records: Sequence[MaterialRecord], fit: MaterialFit, spread: Array, n: int
) -> tuple[tuple[float, Estimate], ...]:
    """ε_L at each load; where E_M is not known, with σ ΔS, which is then in the data too."""
    whole = "modulus_martensite" in fit.choice.reasons
    levels = distinct_levels(records, isobaric=True) or [fit.choice.reference_stress]

    def at(stress: float) -> Callable[[Array], float]:
        def value(inner: Array) -> float:
            law = law_at(fit.choice, inner)
            elastic = stress * law.compliance_change if whole else 0.0
            return float(transformation_strain(law, stress)) + elastic

        return value

    found = []
    for stress in levels:
        value, half = at(stress)(fit.inner), half_width(at(stress), fit, spread)
        found.append((stress, Estimate(value, (value - half, value + half), "1", SOURCE, n)))
    return tuple(found)


def _record_json(r: RecordFit) -> dict[str, Any]:
    kind = "isobaric" if r.record.isobaric else "isothermal"
    return {
        "run": r.record.name,
        "kind": kind,
        "level": r.record.level,
        "unit": "MPa" if r.record.isobaric else "degC",
        "n": int(r.record.strain.size),
        "rms": r.rms,
        "left_out_rms": r.left_out_rms,
    }
