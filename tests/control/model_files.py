"""Model files of the thesis's surfaces, written as if identified, so that tests of loops need no run."""

from pathlib import Path

from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.replay import Model, NoiseRecord
from smarig.replay.model_file import ActuatorRecord, Provenance, SignalDescription

RIGS = {"one": ("mm", "gorbet_one_wire"), "two": ("deg", "gorbet_two_wire")}


def model_of(name: str, **other) -> Model:
    """one_e, two_p and the like; ``other`` replaces fields."""
    arrangement = name.partition("_")[0]
    unit, actuator = RIGS[arrangement]
    rig = f"{arrangement}_wire_twin"
    fields = {
        "name": name,
        "hysteresis": thesis_surface(name),
        "rig": rig,
        "actuator": ActuatorRecord(name=actuator, parameters={}),
        "arrangement": f"{arrangement}_wire",
        "input": SignalDescription(quantity="temperature", unit="K"),
        "output": SignalDescription(quantity="position", unit=unit),
        "mirrored": False,
        "fit": {},
        "noise_floor": NoiseRecord(value=None, unit=unit, source=""),
        "provenance": (
            Provenance(run="f.run.sqlite", sha256="0" * 64, protocol="made", source="twin", rows=7),
        ),
        "twin": True,
        "created": "2026-01-01T00:00:00",
    }
    return Model(**(fields | other))


def model_file(folder: Path, name: str, **other) -> Path:
    """The same in a file."""
    return model_of(name, **other).save(folder / f"{name}.model.json", force=True)
