"""Short sessions on a twin: real run files, with a fine encoder where quantisation would hide the tested
property."""

from smarig.config import locate
from smarig.plant.actuator import Actuator
from smarig.plant.effect_catalogue import effects_from_pairs
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.record import load_run
from smarig.replay import PlantModel
from smarig.rig.twin import TwinSettings
from smarig.runner.session import Session

EXCURSIONS = (0.0, 60.0, 90.0, 50.0, 10.0, 80.0, 40.0, 100.0)
LONG = ("validation", {"points": 8})
LISTED = ("step_currents", {"temperatures_K": EXCURSIONS})
FINER = 100  # times the encoder's counts


def session_runs(folder, *protocols, rig="one_wire_twin", effects=(), seed=1, noise=True, fine=False):
    """Runs of one session in order; protocols are (name, settings)."""
    if fine:
        coarse = locate("rigs", rig).read_text(encoding="utf-8")
        rig = str(folder / "fine.toml")
        text = coarse.replace("counts_per_rev = 2000", f"counts_per_rev = {2000 * FINER}")
        (folder / "fine.toml").write_text(text, encoding="utf-8")
    settings = TwinSettings(seed=seed, noise=noise, effects=effects_from_pairs(effects))
    with Session(rig, twin=settings) as rig_session:
        paths = [
            rig_session.run(name, settings_of_run, folder / f"{k}.run.sqlite")
            for k, (name, settings_of_run) in enumerate(protocols)
        ]
    return [load_run(path) for path in paths]


def twin_plant_model(effects=(), wire="gorbet_one_wire"):
    """The wire as the twin has it: (subject, output per count of the ordinary encoder)."""
    actuator = Actuator.named(wire)
    hysteresis = actuator.file.hysteresis
    per_count = actuator.position_per_count(2000)
    plant_model = PlantModel(
        actuator,
        thesis_surface(hysteresis.surface),
        hysteresis.initial,
        effects_from_pairs(effects),
        per_count,
    )
    return plant_model, per_count
