"""Short sessions on a twin: real run files, with a fine encoder where quantisation would hide the tested
property."""

from pathlib import Path
from tempfile import mkdtemp

import computed_once
from smarig.config import locate
from smarig.plant.actuator import Actuator
from smarig.plant.effect_catalogue import effects_from_pairs
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.record import Run, load_run
from smarig.replay import PlantModel
from smarig.rig.twin import TwinSettings
from smarig.runner.session import Session

EXCURSIONS = (0.0, 60.0, 90.0, 50.0, 10.0, 80.0, 40.0, 100.0)
LONG = ("validation", {"points": 8})
LISTED = ("step_currents", {"temperatures_K": EXCURSIONS})
RIG = "one_wire_twin"
FINER = 100  # times the encoder's counts
MOST_ASKED = (LONG, LISTED, LONG)  # many tests need this session, or its beginning


def session_runs(folder, *protocols, rig=RIG, **settings) -> list[Run]:
    """Runs of one session in order; protocols are (name, settings).

    Many tests need ``MOST_ASKED`` or its beginning, which is made once, in a folder of all workers.
    """
    if rig != RIG or settings or protocols != MOST_ASKED[: len(protocols)]:
        return _made(folder, *protocols, rig=rig, **settings)
    return [load_run(path) for path in _most_asked()[: len(protocols)]]


@computed_once.computed_once
def _most_asked() -> list[Path]:
    return [run.path for run in _made(Path(mkdtemp(dir=computed_once.folder())), *MOST_ASKED)]


def _made(folder, *protocols, rig=RIG, effects=(), seed=1, noise=True, fine=False):
    if fine:
        coarse = locate("rigs", rig).read_text(encoding="utf-8")
        rig = str(folder / "fine.toml")
        text = coarse.replace("counts_per_rev = 2000", f"counts_per_rev = {2000 * FINER}")
        (folder / "fine.toml").write_text(text, encoding="utf-8")
    twin = TwinSettings(seed=seed, noise=noise, effects=effects_from_pairs(effects))
    with Session(rig, twin=twin) as rig_session:
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
