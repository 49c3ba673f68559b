"""Calibration of the wire's constants from all available channels, with 95 % intervals.

    R_M, R_A    voltage, current, position                              (``resistance``)
                of two wires: voltage and current of cold and hot wires (``two_wire_resistances``)
    tau         wire temperature after a step of the drive, or position with a known hysteresis
    dead_time   the same temperature, if it shows a delay               (``thermal_transient``, ``replay``)
    R_over_hA   steady wire temperature and current                     (``heat_loss``)
    hA          the same with voltage

For each constant that the data do not determine, a sentence states the reason.
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
from smarig.preisach import Everett, dump_hysteresis
from smarig.record import Run

USUAL_TAU_S = 5.0  # of a wire of 0.3 mm in air, if nothing is known


@dataclass(frozen=True)
class Calibration:
    """Constants by name (R_M, R_A, R_over_hA, hA, tau, dead_time), and the reasons for those not determined."""

    parameters: dict[str, Estimate]
    not_available: dict[str, str]

    def to_json(self) -> dict[str, Any]:
        """The calibration as a JSON object."""
        found = {name: estimate.to_json() for name, estimate in self.parameters.items()}
        return {"parameters": found, "not_available": dict(self.not_available)}

    def write_actuator(
        self,
        path: str | Path,
        base: Actuator | None,
        *,
        hysteresis: Everett | None = None,
        force: bool = False,
    ) -> Path:
        """Write an actuator file: ``base`` with the calibrated constants; returns the path.

        R/hA sets the steady temperature at the base's reference current. τ sets the specific heat, c_p = τ hA/(ρ
        V). ``hysteresis`` (of an identified model, kelvin to the base's unit) takes the place of the base's. Raises
        UsageError without a base, if there is nothing to write, or if the file exists; ConfigError for the hysteresis
        of another rig.
        """
        if base is None:
            raise UsageError(
                "An actuator file needs a parameter set to start from. Name one with --actuator."
            )
        if not self.parameters and hysteresis is None:
            raise UsageError(
                "The data determine no constant of an actuator file. See the reason that is given for each constant."
            )
        file = calibrated(base.file, self.parameters, Path(path).stem)
        if hysteresis is not None:
            file = with_hysteresis(file, hysteresis)
        return write(Path(path), file, force=force)

    def __str__(self) -> str:
        lines = [f"{name} = {estimate}" for name, estimate in self.parameters.items()]
        return "\n".join([*lines, *(f"{name}: {why}" for name, why in self.not_available.items())])


def calibrate(
    runs: Sequence[Run], actuator: Actuator | None = None, hysteresis: Everett | None = None
) -> Calibration:
    """Estimate the constants that the runs determine; each of the others gets a sentence.

    With ``hysteresis`` (of an identified model) and ``actuator``, τ can be found from position transients if no
    wire temperature was measured. Raises UsageError without runs.
    """
    if not runs:
        raise UsageError("No run was given to calibrate from. Give at least one.")
    thermal = tau_from_temperature(runs)
    if isinstance(thermal["tau"], str):
        thermal["tau"] = _tau_without_temperature(thermal["tau"], runs, actuator, hysteresis)
    tau = thermal["tau"]
    tau_s = tau.value if isinstance(tau, Estimate) else actuator.tau_s if actuator else USUAL_TAU_S
    found = resistances(runs, tau_s) | heat_loss(runs, tau if isinstance(tau, Estimate) else None) | thermal
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
        f"{why} It cannot be determined from position alone without a model: the hysteresis shapes a transient as "
        "much as the heating does."
    )


def calibrated(base: ActuatorFile, found: Mapping[str, Estimate], name: str) -> ActuatorFile:
    """The base with R_M, R_A, R_over_hA and tau as calibrated; every source states value, interval and origin.

    τ is not a constant of the file but ρ c_p V/(hA): it sets c_p, with the new hA = R/(R/hA).
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


def with_hysteresis(file: ActuatorFile, hysteresis: Everett) -> ActuatorFile:
    """The actuator with the hysteresis of an identified model. Raises ConfigError for that of another rig."""
    section = file.hysteresis.model_copy(update={"surface": None, "model": dump_hysteresis(hysteresis)})
    source = f"{file.source}; hysteresis of an identified model"
    found = file.model_copy(update={"hysteresis": section, "source": source})
    _ = Actuator(found).hysteresis  # read as the rig will
    return found


def _quantity(value: float, unit: str, estimate: Estimate, prefix: str = "") -> Quantity:
    if value <= 0:
        raise UsageError(f"The estimate {estimate} is not positive, so it cannot go into an actuator file.")
    return Quantity(value=float(f"{value:.6g}"), unit=unit, source=f"{prefix}{estimate}: {estimate.source}")


def write(path: Path, actuator: ActuatorFile, *, force: bool) -> Path:
    """Write the whole file or nothing; UsageError if it exists and ``force`` is not given."""
    if path.suffix != ".toml":
        raise UsageError(f"An actuator file is TOML. Give a name that ends in .toml, not {path.name}.")
    with atomic_file(path, force=force) as part:
        part.write_text(_toml(actuator), encoding="utf-8")
    return path


def _toml(actuator: ActuatorFile) -> str:
    data = actuator.model_dump(exclude_none=True)
    lines = [f"{key} = {_text(value)}" for key, value in data.items() if not isinstance(value, dict)]
    for table, content in data.items():
        if isinstance(content, dict):
            model = content.pop("model", {})
            lines += ["", f"[{table}]", *_lines(content)]
            lines += ["", f"[{table}.model]", *_lines(model)] if model else []
    return "\n".join(lines) + "\n"


def _lines(table: dict[str, Any]) -> list[str]:
    return [f"{key} = {_text(value)}" for key, value in table.items()]


def _text(value: Any) -> str:
    """A TOML value; strings written as in JSON are TOML basic strings."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_text(v)}" for key, v in value.items()) + " }"
    if isinstance(value, list):
        return f"[{', '.join(map(_text, value))}]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)
