"""The constants of a thermomechanical twin that follows the identified material at the load of its actuator.

The strips of transformation, their slopes and ε_L are those of the law at this stress (``twin_strips``).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from smarig.config import ActuatorFile, Quantity
from smarig.core import Array, root_mean_square
from smarig.identification.calibration.calibrate import write
from smarig.identification.interval_estimate import Estimate
from smarig.identification.material.law import MaterialLaw, transformation_strain
from smarig.identification.material.material_records import ZERO_DEGC_K, MaterialRecord
from smarig.identification.material.twin_strips import (
    TwinStrips,
    as_they_are,
    narrowed,
    parallel,
    strip_values,
    twin_strips,
)
from smarig.plant import Actuator, Material, isobaric_loop

_KEPT = (
    *(f"resistivity_{x}" for x in ("austenite", "martensite", "slope_austenite", "slope_martensite")),
    "reference_temperature",
    "heat_loss",
    "pre_strain",
    "shaft_torque",
)
_OF_LAW = (
    "identified: a quarter and three quarters of the transformation as in the law of Lagoudas et al. (2012)"
)


@dataclass(frozen=True, eq=False)
class TwinMaterial:
    """The actuator file, the stress at which it follows the material, and its rms error over the isobaric records.

    ``changed``: how its strips differ from those of the law, in words.
    """

    file: ActuatorFile
    stress_MPa: float
    errors: tuple[tuple[float, float], ...]
    changed: str = ""

    @property
    def sentence(self) -> str:
        """How far the twin's own law is from the records."""
        each = ", ".join(f"{100 * e:.2f} % at {level:.4g} MPa" for level, e in self.errors)
        far = f" Its cosines leave an error of {each}." if each else ""
        changed = f" ({self.changed})" if self.changed else ""
        return (
            f"The twin of the actuator file follows the material at {self.stress_MPa:.4g} MPa{changed}.{far}"
        )

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        t = self.file.thermomechanical
        values = {} if t is None else {k: q.value for k, q in t if isinstance(q, Quantity)}
        errors = [{"stress_MPa": level, "rms": e} for level, e in self.errors]
        return {
            "stress_MPa": self.stress_MPa,
            "thermomechanical": values,
            "errors": errors,
            "changed": self.changed or None,
        }

    def write(self, path: Path, *, force: bool) -> Path:
        """Write the actuator file, named after its path."""
        return write(path, self.file.model_copy(update={"name": path.stem}), force=force)


def twin_material(
    law: MaterialLaw,
    parameters: dict[str, Estimate],
    records: Sequence[MaterialRecord],
    base: Actuator,
    heat: Estimate | str,
) -> TwinMaterial | str:
    """The base with the identified material, or in one sentence why it cannot have it."""
    file = base.file
    if base.two_wire and file.thermomechanical is None:
        return f"The actuator {base.name} has two wires and no [thermomechanical], so their pre-strain is not known."
    section_mm2 = math.pi / 4 * file.wire.diameter.value**2
    force = file.thermomechanical.force if file.thermomechanical else None
    stress = force.value / section_mm2 if force else law.reference_stress
    reason = ""
    for change in (as_they_are, parallel, narrowed):
        strips = change(twin_strips(law, stress))
        if strips is None:
            continue
        section = {
            **_electrical(file),
            **_elastic(law, parameters, file, stress),
            **_strip_quantities(strips),
            **_latent(law, file, heat),
        }
        if not base.two_wire:
            section["force"] = force or _quantity(
                law.reference_stress * section_mm2, "N", "the middle of the stresses of the records"
            )
        try:
            new = ActuatorFile.model_validate(
                {**file.model_dump(), "thermomechanical": _dumped(section, file)}
            )
        except ValidationError as error:
            reason = str(error.errors()[0]["msg"]).removeprefix("Value error, ")
            continue
        return TwinMaterial(_sourced(new, base), stress, tuple(_errors(new, records)), strips.changed)
    return f"The actuator file cannot hold this material: {reason or 'its branches cross'}."


def _strip_quantities(strips: TwinStrips) -> dict[str, Quantity]:
    note = f"; {strips.changed}" if strips.changed else ""
    source = f"{_OF_LAW}, at {strips.stress_MPa:.4g} MPa{note}"
    return {key: _quantity(value, unit, source) for key, (value, unit) in strip_values(strips).items()}


def _elastic(
    law: MaterialLaw, parameters: dict[str, Estimate], file: ActuatorFile, stress: float
) -> dict[str, Quantity]:
    """Moduli, expansions and ε_L; a modulus that is not identified is that of the base, and ε_L makes up for it."""
    old = file.thermomechanical
    found: dict[str, Quantity] = {}
    for name, usual in (("modulus_austenite", 75000.0), ("modulus_martensite", 28000.0)):
        if name in parameters:
            found[name] = _identified(parameters[name])
        elif old is not None:
            found[name] = getattr(old, name)
        else:
            found[name] = _quantity(usual, "MPa", "typical NiTi; the records do not determine it")
    for name, usual in (("expansion_austenite", 11e-6), ("expansion_martensite", 6.6e-6)):
        if name in parameters and parameters[name].value >= 0:
            found[name] = _identified(parameters[name])
        elif old is not None:
            found[name] = getattr(old, name)
        else:
            found[name] = _quantity(usual, "1/K", "typical NiTi; the records do not determine it")
    strain = _recoverable(law, stress)
    elastic = stress * (1.0 / found["modulus_martensite"].value - 1.0 / found["modulus_austenite"].value)
    known = "modulus_martensite" in parameters
    why = "" if known else " less the elastic change of the moduli of this file"
    found["residual_strain"] = _quantity(
        strain - elastic, "1", f"identified: epsilon_L at {stress:.4g} MPa{why}"
    )
    return found


def _recoverable(law: MaterialLaw, stress: float) -> float:
    """ε_L + σ ΔS: what a loop under this stress recovers."""
    return float(transformation_strain(law, stress)) + stress * law.compliance_change


def _latent(law: MaterialLaw, file: ActuatorFile, heat: Estimate | str) -> dict[str, Quantity]:
    """The measured latent heat, that of the base, or −Δs₀ T₀/ρ of the law (Clausius and Clapeyron)."""
    if isinstance(heat, Estimate):
        return {"latent_heat": _identified(heat)}
    if file.thermomechanical is not None:
        return {"latent_heat": file.thermomechanical.latent_heat}
    middle_K = 0.5 * (law.martensite_start + law.austenite_finish) + ZERO_DEGC_K
    value = 1e6 * law.entropy * middle_K / file.wire.density.value
    return {"latent_heat": _quantity(value, "J/kg", "Clausius and Clapeyron with the identified slopes")}


def _electrical(file: ActuatorFile) -> dict[str, Any]:
    """What no record of strain contains: resistivities, heat loss, pre-strain; from the base."""
    old = file.thermomechanical
    if old is not None:
        return {name: getattr(old, name) for name in _KEPT}
    per_ohm = math.pi / 4 * file.wire.diameter.value**2 / file.wire.active_length.value * 1e-3
    found: dict[str, Any] = {"heat_loss": "constant"}
    for phase in ("austenite", "martensite"):
        ohm = getattr(file.heating, f"resistance_{phase}").value
        found[f"resistivity_{phase}"] = _quantity(ohm * per_ohm, "ohm m", f"of heating.resistance_{phase}")
        found[f"resistivity_slope_{phase}"] = _quantity(0.0, "1/K", "assumed: not measured")
    found["reference_temperature"] = _quantity(22.0, "degC", "that of the law's thermal expansion")
    return found


def _errors(file: ActuatorFile, records: Sequence[MaterialRecord]) -> list[tuple[float, float]]:
    """The rms error of the twin's wire along each isobaric record, with the best zero of strain."""
    material = Material.of(file)
    found = []
    for r in records:
        if r.isobaric and r.level >= 0:
            error: Array = isobaric_loop(material, r.level, r.temperature_degC) - r.strain
            found.append((r.level, root_mean_square(error - error.mean())))
    return found


def _quantity(value: float, unit: str, source: str) -> Quantity:
    return Quantity(value=float(f"{value:.6g}"), unit=unit, source=source)


def _identified(e: Estimate) -> Quantity:
    return _quantity(e.value, e.unit, f"identified: {e}")


def _dumped(section: dict[str, Any], file: ActuatorFile) -> dict[str, Any]:
    if file.arrangement == "one_wire":
        section = {k: v for k, v in section.items() if k not in ("pre_strain", "shaft_torque")}
    return {k: v.model_dump() if isinstance(v, Quantity) else v for k, v in section.items() if v is not None}


def _sourced(file: ActuatorFile, base: Actuator) -> ActuatorFile:
    source = f"material identified from records; the rest is that of {base.name} ({file.source})"
    return file.model_copy(update={"source": source})
