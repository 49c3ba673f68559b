"""Thermomechanical wires for comparisons: those of the project, and random variations of them as files in a folder.

A variation has another diameter (0.8 to 1.25 times, at the same stress), latent heat (0.6 to 1.3 times), specific heat
(within 10 %) and transformation temperatures (shifted by up to 6 K). Its table [heating], which the record knows,
follows the diameter.
"""

import math
from pathlib import Path
from typing import Any

import numpy as np

from smarig.config import load_rig
from smarig.plant import Actuator, free_convection_W_per_m2_K
from smarig.protocols import Setup

NAMED = ("one_wire_thermomechanical", "flexinol_015", "flexinol_031")
_TEMPERATURES = ("martensite_finish", "martensite_start", "austenite_start", "austenite_finish")
_AMBIENT_DEGC = 22.0


def random_wire(seed: int, folder: Path) -> str:
    """The rig file, as a path, of a random variation of one of the wires. A seed always gives the same wire."""
    rng = np.random.default_rng([seed, 2028])
    base = load_rig(NAMED[seed % len(NAMED)])
    values = Actuator.named(base.actuator).file.model_dump(mode="json", exclude_none=True)
    diameter, latent, specific = rng.uniform(0.8, 1.25), rng.uniform(0.6, 1.3), rng.uniform(0.9, 1.1)
    shift, name = rng.uniform(-6, 6), f"varied_{seed}"
    actuator = folder / f"{name}.toml"
    values["name"] = str(actuator)  # a record finds its actuator by this name
    alloy, heating = values["thermomechanical"], values["heating"]
    values["wire"]["diameter"]["value"] *= diameter
    values["wire"]["specific_heat"]["value"] *= specific
    alloy["latent_heat"]["value"] *= latent
    alloy["force"]["value"] *= diameter**2
    for key in _TEMPERATURES:
        alloy[key]["value"] += shift
    for key in ("resistance_martensite", "resistance_austenite"):
        heating[key]["value"] /= diameter**2
    scale = (
        diameter**1.5
    )  # of currents for one temperature, with h A independent of the diameter by (5.3) and R/d²
    heating["reference_current"]["value"] *= scale
    actuator.write_text(_toml(values))
    limits = base.limits
    rig = folder / f"{name}_rig.toml"
    rig.write_text(
        f'name = "{name}"\nbase = "one_wire_twin"\nkind = "twin"\nactuator = "{actuator}"\nwire = "{name}"\n'
        f"period_s = {base.period_s}\n\n[limits]\ncurrent_max_A = {limits.current_max_A * scale}\n"
        f"temperature_max_K = {limits.temperature_max_K}\n\n[amplifier]\nsaturation_A = {2 * scale}\n"
    )
    return str(rig)


def middle_tau_s(rig: str) -> float:
    """m c/(h A) without transformation, at the temperature that half the largest input holds."""
    setup = Setup.of(rig)
    actuator, wire = setup.actuator, setup.actuator.file.wire
    d, length = wire.diameter.value / 1000, wire.active_length.value / 1000
    power_W = setup.upper_K / 2 / actuator.gain_K_per_A2 * actuator.resistance_ohm

    def loss_W_per_K(theta: float) -> float:
        return free_convection_W_per_m2_K(d, _AMBIENT_DEGC + theta, _AMBIENT_DEGC) * math.pi * d * length

    rises_K = np.linspace(0.1, 1000.0, 5000)
    theta = float(np.interp(power_W, [loss_W_per_K(x) * x for x in rises_K.tolist()], rises_K))
    heat = wire.density.value * wire.specific_heat.value * math.pi / 4 * d**2 * length
    return heat / loss_W_per_K(theta)


def _toml(values: dict[str, Any]) -> str:
    plain = {k: v for k, v in values.items() if not isinstance(v, dict)}
    lines = [f"{k} = {_value(v)}" for k, v in plain.items()]
    for table in (k for k in values if isinstance(values[k], dict)):
        lines += ["", f"[{table}]", *(f"{k} = {_value(v)}" for k, v in values[table].items())]
    return "\n".join(lines) + "\n"


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {_value(v)}" for k, v in value.items()) + " }"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return str(value).lower() if isinstance(value, bool) else repr(value)
