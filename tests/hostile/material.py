"""Honest files that hostile ones are made from: runs, a model, a table, a mapping, a rig, a MATLAB file.

Beside them lie a secret, which no command may show, and a Python file that no command may execute.
"""

import contextlib
import json
import shutil
import sqlite3
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from scipy.io import savemat

import smarig
from runner.interrupted import cut
from smarig.identification import identify
from smarig.record import load_run

SECRET = "hunter2-correct-horse"
PARTITION_K = (0, 40, 80, 120, 170)
CSV = "time_s,current_command_A,position_mm\n" + "".join(
    f"{k / 10},{0.0 if k < 30 else 0.5},{0.001 * (k % 7) + (k >= 30)}\n" for k in range(60)
)
MAPPING = """name = "m"
summary = "s"
source = "t"
[columns]
input = { column = "H", unit = "A/m" }
position = { column = "B", unit = "T" }
[input]
channel = "input"
quantity = "magnetic field"
unit = "A/m"
[output]
quantity = "flux density"
unit = "T"
"""
HDF5_MAPPING = MAPPING.replace("[columns]", "[hdf5]\n[columns]")
MAT_MAPPING = MAPPING.replace("[columns]", "[mat]\n[columns]")
PROTOCOL = """from pathlib import Path
Path({mark!r}).write_text("executed")
def evil(setup, *, points: int = 2):
    yield None
"""


@dataclass(frozen=True)
class Material:
    """Paths of the honest files in one folder."""

    folder: Path

    @property
    def whole(self) -> Path:
        """A finished run of first-order curves."""
        return self.folder / "whole.run.sqlite"

    @property
    def killed(self) -> Path:
        """The same run as a kill leaves it: ``identify`` and ``resume`` both accept it."""
        return self.folder / "killed.run.sqlite"

    @property
    def model(self) -> Path:
        """The model of the whole run."""
        return self.folder / "m.model.json"

    @property
    def secret(self) -> Path:
        """A file whose first line is the secret."""
        return self.folder / "secret.toml"

    @property
    def precious(self) -> Path:
        """A file that no command may change or delete."""
        return self.folder / "thesis.txt"

    @property
    def evil(self) -> Path:
        """A Python file that leaves a mark when it is executed."""
        return self.folder / "evil.py"

    @property
    def executed(self) -> bool:
        """Whether the Python file was executed."""
        return (self.folder / "mark").exists()

    def text(self, name: str) -> str:
        """The text of an honest file."""
        return (self.folder / name).read_text(encoding="utf-8")


def make_material(folder: Path) -> Material:
    """Make all of it in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    m = Material(folder)
    settings = {"partition_K": ",".join(map(str, PARTITION_K))}
    smarig.run("first_order_descending", rig="one_wire_twin", out=m.whole, **settings)
    run = load_run(m.whole)
    cut(m.whole, m.killed, int(run["tick"][len(run) * 3 // 4]))
    with contextlib.closing(sqlite3.connect(m.killed)) as db, db:  # a day later: the clocks must not overlap
        db.execute("UPDATE run SET value = value + 86400 WHERE key = 'start_epoch'")
        db.execute("DELETE FROM run WHERE key = 'recorder_pid'")  # this process: it runs on
    identify(run, "constant").model.save(m.model)
    m.secret.write_text(f'{SECRET} = "{SECRET}"\n', encoding="utf-8")
    m.precious.write_text("years of work\n" * 10, encoding="utf-8")
    m.evil.write_text(PROTOCOL.format(mark=str(folder / "mark")), encoding="utf-8")
    (folder / "good.csv").write_text(CSV, encoding="utf-8")
    (folder / "map.toml").write_text(MAPPING, encoding="utf-8")
    (folder / "hdf5.toml").write_text(HDF5_MAPPING, encoding="utf-8")
    (folder / "mat.toml").write_text(MAT_MAPPING, encoding="utf-8")
    rig = Path(smarig.__file__).parents[2] / "configs" / "rigs" / "one_wire_twin.toml"
    shutil.copy(rig, folder / "rig.toml")
    shutil.copy(rig.parents[1] / "actuators" / "gorbet_one_wire.toml", folder / "actuator.toml")
    (folder / "reference.csv").write_text("time_s,position_mm\n0,1\n5,2\n", encoding="utf-8")
    loop = np.sin(np.linspace(0, 6, 50))
    savemat(folder / "good.mat", {"H": 100 * loop, "B": 0.1 * loop})
    if find_spec("h5py"):
        import h5py

        with h5py.File(folder / "good.h5", "w") as file:
            file["H"], file["B"] = 100 * loop, 0.1 * loop
    return m


def model_data(m: Material) -> dict:
    """The model file as plain values."""
    return json.loads(m.model.read_text(encoding="utf-8"))
