"""The description of a run for its record: protocol, rig, state, and everything needed to resume it."""

import json
import math
import platform
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from smarig.config import RigFile, shipped_names
from smarig.core import Interrupted, SmarigError, catalogue_names
from smarig.plant import EFFECTS, Actuator, Effect, Load, effects_to_pairs
from smarig.rig import ForceStatistics, TwinSettings

LAUNCH_ARGS = "begun_with"  # key of the arguments needed to resume a run
LOAD = "load"  # key of the load of a run
LOAD_TIMES = 1001  # at which a load that changes is evaluated
CLOSED_LOOP = "closed_loop"  # key of runs whose protocol is not in the catalogue


def twin_source(file: RigFile, twin: TwinSettings) -> str:
    """The source of the data: "bench", "twin" or "simulation"; simulated devices are a twin too."""
    if twin.hysteresis is not None:
        return "simulation"
    return "bench" if file.kind == "bench" and file.simulator is None else "twin"


def outlives_session(file: RigFile) -> bool:
    """Whether the devices exist before and after the session: hardware, or simulated devices started elsewhere."""
    return file.kind == "bench" and (file.simulator is None or not file.simulator.start)


def experiment_metadata(
    actuator: Actuator, twin: TwinSettings, per_count: float, protocol: str, settings: Mapping[str, Any]
) -> dict[str, Any]:
    """Experiment, units and versions."""
    unit = actuator.unit
    one_wire_text = "wire temperature above ambient"
    return {
        "protocol": protocol,
        "settings": {k: str(v) for k, v in settings.items()},
        "actuator": actuator.name,
        "seed": twin.seed,
        "effects": [repr(e) for e in twin.effects],
        "input": {
            "quantity": "wire temperature difference T₁ − T₂" if actuator.two_wire else one_wire_text,
            "unit": "K",
            "from": "heating model along the measured current",
        },
        "output": {
            "quantity": "shaft angle" if unit == "deg" else "displacement",
            "unit": unit,
            "per_count": per_count,
        },
        "versions": {name: version(name) for name in ("smarig", "numpy", "scipy")}
        | {"python": platform.python_version()},
    }


def load_metadata(load: Load | None, t_s: tuple[float, float] = (0.0, 0.0)) -> dict[str, Any]:
    """The load of a run, and its force and stress as conditions: mean, least and largest between two times in s."""
    if load is None:
        return {}
    stress_MPa = load.stress_MPa(np.linspace(*t_s, LOAD_TIMES) if load.changes else [0.0])
    values = {"load": ("N", stress_MPa * load.section_mm2), "stress": ("MPa", stress_MPa)}
    conditions = {
        name: {"unit": unit, "mean": float(x.mean()), "min": float(x.min()), "max": float(x.max())}
        for name, (unit, x) in values.items()
    }
    return {LOAD: load.to_json(), "conditions": conditions}


def measured_load(force: ForceStatistics, actuator: Actuator) -> dict[str, Any]:
    """The conditions of a run from the readings of a load cell: force, and stress = force/(π d²/4) of one wire."""
    section_mm2 = math.pi / 4 * actuator.file.wire.diameter.value**2
    force_N = {"mean": force.mean_N, "min": force.least_N, "max": force.largest_N}
    return {
        "load": {"unit": "N", **force_N},
        "stress": {"unit": "MPa", **{name: value / section_mm2 for name, value in force_N.items()}},
    }


def launch_args(
    rig: str,
    wire: str,
    speed: float | None,
    twin: TwinSettings,
    settings: Mapping[str, Any],
    load: str = "",
) -> dict:
    """The arguments from which `smarig resume` rebuilds the run: rig file, its wire, effects of the twin, settings.

    ``load``: that given in place of the rig file's, "" for none.
    """
    with_type = [e for e in twin.effects if isinstance(e, Effect) and e.kind.name in catalogue_names(EFFECTS)]
    return {
        "rig": rig if rig in shipped_names("rigs") else str(Path(rig).resolve()),
        "rig_wire": wire,
        "speed": speed,
        "effects": effects_to_pairs(with_type) if len(with_type) == len(twin.effects) else None,
        "noise": twin.noise,
        **({LOAD: load} if load else {}),
        "settings": json.loads(json.dumps(dict(settings), default=_to_json)),
    }


def _to_json(value: Any) -> Any:
    """JSON for values that Python callers may give: groups of settings, arrays."""
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    tolist = getattr(value, "tolist", None)
    return tolist() if tolist else str(value)


def cause_of(error: BaseException) -> str:
    """The cause of a run's end, for its record."""
    if isinstance(error, Interrupted):
        return str(error)
    if isinstance(error, KeyboardInterrupt):
        return "interrupted at once (Ctrl-C twice, or a protocol that did not return)"
    if isinstance(error, SmarigError):
        return f"stopped: {error}"
    return f"failed: {type(error).__name__}: {error}"
