"""The wire's own constants out of whatever channels the runs have, with 95 % intervals.

    R_M, R_A    voltage, current, position                              (``resistance``)
    tau         wire temperature after a step of the drive, or position with a known hysteresis
    dead_time   the same temperature, where a delay shows               (``thermal_transient``, ``replay``)
    R_over_hA   steady wire temperature and current                     (``heat_loss``)
    hA          the same with voltage

What the data cannot give is said in a sentence, never guessed. Knows runs and the actuator to start from.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarig.config import ActuatorFile, Quantity
from smarig.core import UsageError, atomic_file
from smarig.identification.calibration.heat_loss import heat_loss
from smarig.identification.calibration.position_transient import tau_from_position
from smarig.identification.calibration.resistance import resistances
from smarig.identification.calibration.thermal_transient import tau_from_temperature
from smarig.identification.interval_estimate import Estimate
from smarig.plant import Actuator
from smarig.preisach import Everett
from smarig.record import Run


@dataclass(frozen=True)
class Calibration:
    """Constants by name (R_M, R_A, R_over_hA, hA, tau, dead_time), and for the others why not."""

    parameters: dict[str, Estimate]
    not_available: dict[str, str]

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        found = {name: estimate.to_json() for name, estimate in self.parameters.items()}
        return {"parameters": found, "not_available": dict(self.not_available)}

    def write_actuator(self, path: str | Path, base: Actuator | None, *, force: bool = False) -> Path:
        """Write an actuator file: ``base`` with what was found in place of its constants; returns the path.

        R/hA sets the steady temperature at the base's reference current; τ sets the specific heat,
        c_p = τ hA/(ρ V). UsageError without a base, when nothing was found, or when the file exists.
        """
        if base is None:
            raise UsageError(
                "An actuator file needs a parameter set to start from: name one with --actuator."
            )
        if not self.parameters:
            raise UsageError(
                "Nothing was found that an actuator file could hold; see what the data cannot give."
            )
        return write(Path(path), calibrated(base.file, self.parameters, Path(path).stem), force=force)

    def __str__(self) -> str:
        lines = [f"{name} = {estimate}" for name, estimate in self.parameters.items()]
        return "\n".join([*lines, *(f"{name}: {why}" for name, why in self.not_available.items())])


def calibrate(
    runs: Sequence[Run], actuator: Actuator | None = None, hysteresis: Everett | None = None
) -> Calibration:
    """Estimate what the runs can tell of the wire; the rest gets a sentence.

    ``hysteresis`` (an identified model's), with ``actuator``, lets τ be found from position transients
    where no wire temperature was measured. UsageError without runs.
    """
    if not runs:
        raise UsageError("No run was given to calibrate from.")
    thermal = tau_from_temperature(runs)
    if isinstance(thermal["tau"], str):
        thermal["tau"] = _tau_without_temperature(thermal["tau"], runs, actuator, hysteresis)
    tau = thermal["tau"]
    found = resistances(runs) | heat_loss(runs, tau if isinstance(tau, Estimate) else None) | thermal
    return Calibration(
        {name: x for name, x in found.items() if isinstance(x, Estimate)},
        {name: x for name, x in found.items() if isinstance(x, str)},
    )


def _tau_without_temperature(
    why: str, runs: Sequence[Run], actuator: Actuator | None, hysteresis: Everett | None
) -> Estimate | str:
    if actuator is not None and hysteresis is not None:
        found = tau_from_position(runs, actuator, hysteresis)
        return found if isinstance(found, Estimate) else f"{why} {found}"
    return (
        f"{why} It cannot be given from position alone without a model: the hysteresis shapes a transient as "
        "much as the heating does."
    )


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
