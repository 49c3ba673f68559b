"""A calibrated actuator as configs/actuators/NAME.toml: the base's constants, replaced where measured.

Knows the actuator's schema and which constant sets which key. Refuses to know how it was measured.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from smarig.config import ActuatorFile, Quantity
from smarig.core.atomic_file import atomic_file
from smarig.core.errors import UsageError
from smarig.identification.interval_estimate import Estimate
from smarig.plant.actuator import Actuator


def calibrated(base: ActuatorFile, found: Mapping[str, Estimate], name: str) -> ActuatorFile:
    """The base with R_M, R_A, R_over_hA and tau as found; every source names value, interval and origin.

    τ is no constant of the file but ρ c_p V/(hA): it sets c_p, with the new hA = R/(R/hA).
    """
    heating = base.heating
    changes: dict[str, Quantity] = {}
    for constant, key in (("R_M", "resistance_martensite"), ("R_A", "resistance_austenite")):
        if constant in found:
            changes[key] = _quantity(found[constant].value, "ohm", found[constant])
    if "R_over_hA" in found:
        steady = found["R_over_hA"].value * heating.reference_current.value**2
        changes["reference_temperature"] = _quantity(steady, "K", found["R_over_hA"])
    new = base.model_copy(update={"name": name, "heating": heating.model_copy(update=changes)})
    if "tau" in found:
        # tau_s is proportional to c_p, so one ratio sets it.
        specific_heat = base.wire.specific_heat.value * found["tau"].value / Actuator(new).tau_s
        heat = _quantity(specific_heat, "J/(kg K)", found["tau"], "set so that tau = rho c_p V/(hA) is ")
        new = new.model_copy(update={"wire": base.wire.model_copy(update={"specific_heat": heat})})
    return new.model_copy(update={"source": f"calibrated, starting from {base.name} ({base.source})"})


def _quantity(value: float, unit: str, estimate: Estimate, prefix: str = "") -> Quantity:
    if value <= 0:
        raise UsageError(f"The estimate {estimate} is not positive, so it cannot go into an actuator file.")
    return Quantity(value=float(f"{value:.6g}"), unit=unit, source=f"{prefix}{estimate}: {estimate.source}")


def write(path: Path, actuator: ActuatorFile, *, force: bool) -> Path:
    """Write the file, all of it or nothing; UsageError when it exists and ``force`` is not given."""
    if path.suffix != ".toml":
        raise UsageError(f"An actuator file is TOML: give a name that ends in .toml, not {path.name}.")
    with atomic_file(path, force=force) as part:
        part.write_text(_toml(actuator), encoding="utf-8")
    return path


def _toml(actuator: ActuatorFile) -> str:
    data = actuator.model_dump()
    lines = [f"{key} = {_text(value)}" for key, value in data.items() if not isinstance(value, dict)]
    for table, content in data.items():
        if isinstance(content, dict):
            lines += ["", f"[{table}]", *(f"{key} = {_text(value)}" for key, value in content.items())]
    return "\n".join(lines) + "\n"


def _text(value: Any) -> str:
    """A TOML value; strings as JSON writes them are TOML basic strings."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_text(v)}" for key, v in value.items()) + " }"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)
