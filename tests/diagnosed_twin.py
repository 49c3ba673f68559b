"""``smarig diagnose`` of a twin that walks, as a command, run once for all workers of a session."""

import contextlib
import io
import json
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

import computed_once
import smarig
from smarig.cli import run as cli
from smarig.diagnosis import CommandedDiagnosis
from smarig.plant.effect_catalogue import effect_types, effects_from_pairs
from smarig.rig.twin import TwinSettings
from smarig.runner.session import Session

WALKING = 0.4  # %/cycle
TRAIN = {  # fewer points than by default
    "congruency": {"points_per_branch": 2},
    "first_order_descending": {"partition_K": (0, 60, 100, 174.1)},
}
HELD_OUT = {"validation": {"points": 10}}
# The effects that compete; the others are tested in tests/diagnosis.
RIVALS = ("ambient_drift", "creep", "eccentricity", "slip", "walking")
WITHOUT = [part for k in effect_types() if k.name not in RIVALS for part in ("--without", k.name)]


@dataclass(frozen=True)
class DiagnosedTwin:
    """The folder with the runs, the model and, in ``out``, the results: for reading only. What the command printed as
    JSON, and the diagnosis.
    """

    folder: Path
    printed: dict[str, Any]
    diagnosis: CommandedDiagnosis


def command(folder, *more):
    """The words of the command in a folder with the runs and the model."""
    train = [str(folder / f"{name}.run.sqlite") for name in TRAIN]
    held_out = str(folder / "validation.run.sqlite")
    return ["diagnose", str(folder / "wire.model.json"), "--train", *train, "--held-out", held_out, *more]


@computed_once.computed_once
def diagnosed_twin() -> DiagnosedTwin:
    """The runs, the model identified from them, and their diagnosis."""
    folder = computed_once.folder() / "walking"
    folder.mkdir()
    effects = effects_from_pairs([f"walking={WALKING}"])
    with Session("one_wire_twin", twin=TwinSettings(seed=2, effects=effects)) as session:
        for name, settings in (TRAIN | HELD_OUT).items():
            session.run(name, settings, folder / f"{name}.run.sqlite")
    model = smarig.identify([folder / f"{name}.run.sqlite" for name in TRAIN], surface="positive").model
    model.save(folder / "wire.model.json")
    return DiagnosedTwin(folder, *_run(command(folder, "-o", str(folder / "out"), "--nulls", "40", "--json")))


def _run(words: list[str]) -> tuple[dict[str, Any], CommandedDiagnosis]:
    """What the command prints, and what it found."""
    package, said, kept = import_module("smarig.diagnosis"), io.StringIO(), []
    diagnose = package.diagnose

    def keeping(*given, **more):
        kept.append(diagnose(*given, **more))
        return kept[-1]

    with contextlib.redirect_stdout(said), pytest.MonkeyPatch.context() as patched:
        patched.setattr(package, "diagnose", keeping)
        assert cli([*words, *WITHOUT]) == 0
    return json.loads(said.getvalue()), kept[0]
