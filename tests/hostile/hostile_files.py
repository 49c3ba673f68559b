"""The corpus: every hostile file by kind and name, and the commands that read a file of each kind."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from hostile.configurations import CONFIGURATIONS
from hostile.hdf5_files import HDF5
from hostile.material import Material
from hostile.matlab_files import MATLAB
from hostile.model_files import MODELS
from hostile.run_contents import CONTENTS
from hostile.run_numbers import NUMBERS
from hostile.run_structures import STRUCTURES, Maker
from hostile.tables import TABLES

Words = Callable[
    [Material, Path, Path], list[object]
]  # the honest files, the hostile file, a folder for outputs

_ENDINGS = {
    "run": ".run.sqlite",
    "table": ".csv",
    "toml": ".toml",
    "model": ".model.json",
    "matlab": ".mat",
    "hdf5": ".h5",
    "numbers": ".run.sqlite",
}
CORPUS: dict[str, dict[str, Maker]] = {
    "run": STRUCTURES | CONTENTS,
    "table": TABLES,
    "toml": CONFIGURATIONS,
    "model": MODELS,
    "matlab": MATLAB,
    "hdf5": HDF5,
    "numbers": NUMBERS,
}
COMMANDS: dict[str, dict[str, Words]] = {
    "run": {
        "report": lambda m, f, o: ["report", f, "-o", o / "page.html"],
        "report of a folder": lambda m, f, o: ["report", f.parent],
        "export csv": lambda m, f, o: ["export", f, "--to", "csv", "-o", o / "out.csv"],
        "export mat": lambda m, f, o: ["export", f, "--to", "mat", "-o", o / "out.mat"],
        "export parquet": lambda m, f, o: ["export", f, "--to", "parquet", "-o", o / "out.parquet"],
        "verify": lambda m, f, o: ["verify", m.model, f],
        "identify": lambda m, f, o: ["identify", f, "--surface", "constant", "-o", o / "m.model.json"],
        "calibrate": lambda m, f, o: ["calibrate", f],
        "certify": lambda m, f, o: ["certify", m.model, "--run", f],
        "diagnose": lambda m, f, o: [
            *("diagnose", m.model, "--train", m.whole, "--held-out", f, "--nulls", "40", "-o", o / "found"),
        ],
        "simulate": lambda m, f, o: ["simulate", m.model, "--along", f, "-o", o / "s.run.sqlite"],
        "import": lambda m, f, o: ["import", f, "--format", "csv", "-o", o / "i.run.sqlite"],
        "view": lambda m, f, o: ["view", f, "--model", m.model, "--save", o / "v.rrd"],
        "resume": lambda m, f, o: ["resume", f, "--quiet"],
        "check": lambda m, f, o: ["check", f],
        "replace": lambda m, f, o: [
            *("simulate", m.model, "--along", m.whole, "-o", f, "--force"),
        ],
    },
    "table": {
        "import csv": lambda m, f, o: ["import", f, "--format", "csv", "-o", o / "i.run.sqlite"],
        "import forc": lambda m, f, o: ["import", f, "--format", "forc", "-o", o / "i.run.sqlite"],
        "import mat": lambda m, f, o: [
            *("import", f, "--format", "mat", "--map", m.folder / "mat.toml", "-o", o / "i.run.sqlite"),
        ],
        "import with a mapping": lambda m, f, o: [
            *("import", f, "--format", "csv", "--map", m.folder / "map.toml", "-o", o / "i.run.sqlite"),
        ],
        "import with a rig": lambda m, f, o: [
            *("import", f, "--format", "csv", "--rig", "one_wire_twin", "--repair", "-o", o / "i.run.sqlite"),
        ],
        "profile": lambda m, f, o: [
            *("run", "step_currents", "--rig", "one_wire_twin", "--set", f"file={f}", "--dry-run"),
        ],
        "reference": lambda m, f, o: [
            *("track", m.model, "--reference", f, "--rig", "one_wire_twin", "-o", o / "t.run.sqlite"),
            "--dry-run",
        ],
    },
    "toml": {
        "check": lambda m, f, o: ["check", f, "--protocol", "initialise"],
        "run": lambda m, f, o: ["run", "initialise", "--rig", f, "--dry-run"],
        "campaign": lambda m, f, o: ["run", f, "--rig", "one_wire_twin", "--dry-run"],
        "import": lambda m, f, o: [
            *("import", m.folder / "good.csv", "--format", "csv", "--map", f, "-o", o / "i.run.sqlite"),
        ],
        "import with a rig": lambda m, f, o: [
            *("import", m.folder / "good.csv", "--format", "csv", "--rig", f, "-o", o / "i.run.sqlite"),
        ],
        "calibrate": lambda m, f, o: ["calibrate", m.whole, "--actuator", f],
    },
    "model": {
        "verify": lambda m, f, o: ["verify", f, m.whole],
        "simulate along": lambda m, f, o: ["simulate", f, "--along", m.whole, "-o", o / "s.run.sqlite"],
        "simulate": lambda m, f, o: [
            *("simulate", f, "--protocol", "initialise", "--rig", "one_wire_twin", "-o", o / "s.run.sqlite"),
        ],
        "simulate on its rig": lambda m, f, o: [
            *("simulate", f, "--protocol", "initialise", "-o", o / "s.run.sqlite"),
        ],
        "certify": lambda m, f, o: ["certify", f, "-o", o / "c.html"],
        "calibrate": lambda m, f, o: ["calibrate", m.whole, "--model", f],
        "diagnose": lambda m, f, o: [
            *("diagnose", f, "--train", m.whole, "--held-out", m.killed, "--nulls", "40", "-o", o / "found"),
        ],
        "report": lambda m, f, o: ["report", m.whole, "--model", f, "-o", o / "page.html"],
        "view": lambda m, f, o: ["view", m.whole, "--model", f, "--save", o / "v.rrd"],
        "regulate": lambda m, f, o: [
            *("regulate", f, "--setpoint", "5", "--rig", "one_wire_twin", "-o", o / "t.run.sqlite"),
            "--dry-run",
        ],
        "track": lambda m, f, o: [
            *("track", f, "--reference", m.folder / "reference.csv", "--rig", "one_wire_twin"),
            *("-o", o / "t.run.sqlite", "--dry-run"),
        ],
    },
    "matlab": {
        "import mat": lambda m, f, o: [
            *("import", f, "--format", "mat", "--map", m.folder / "mat.toml", "-o", o / "i.run.sqlite"),
        ],
        "import csv": lambda m, f, o: ["import", f, "--format", "csv", "-o", o / "i.run.sqlite"],
        "import forc": lambda m, f, o: ["import", f, "--format", "forc", "-o", o / "i.run.sqlite"],
    },
    "numbers": {
        "report": lambda m, f, o: ["report", f, "-o", o / "page.html"],
        "report of a model": lambda m, f, o: ["report", f, "--model", m.model, "-o", o / "page.html"],
        "identify": lambda m, f, o: ["identify", f, "--surface", "best", "-o", o / "m.model.json"],
        "identify a table": lambda m, f, o: ["identify", f, "--surface", "table", "-o", o / "m.model.json"],
        "identify positive": lambda m, f, o: [
            "identify",
            f,
            "--surface",
            "positive",
            "-o",
            o / "m.model.json",
        ],
        "verify": lambda m, f, o: ["verify", m.model, f],
        "transformation": lambda m, f, o: ["transformation", f],
        "calibrate": lambda m, f, o: ["calibrate", f],
        "simulate": lambda m, f, o: ["simulate", m.model, "--along", f, "-o", o / "s.run.sqlite"],
        "diagnose": lambda m, f, o: [
            *("diagnose", m.model, "--train", m.whole, "--held-out", f, "--nulls", "40", "-o", o / "found"),
        ],
        "diagnose trained on it": lambda m, f, o: [
            *("diagnose", m.model, "--train", f, "--held-out", m.whole, "--nulls", "40", "-o", o / "found"),
        ],
    },
    "hdf5": {
        "import hdf5": lambda m, f, o: [
            *("import", f, "--format", "hdf5", "--map", m.folder / "hdf5.toml", "-o", o / "i.run.sqlite"),
        ],
        "study": lambda m, f, o: ["study", f, "-o", o / "study", "--yes"],
        "import csv": lambda m, f, o: ["import", f, "--format", "csv", "-o", o / "i.run.sqlite"],
    },
}


@dataclass(frozen=True)
class Case:
    """One hostile file before one command."""

    kind: str
    file: str
    command: str

    def __str__(self) -> str:
        return f"{self.kind} '{self.file}': {self.command}"

    def make(self, m: Material, folder: Path) -> Path:
        """Write the hostile file into a folder of its own."""
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / (re.sub(r"\W+", "_", self.file) + _ENDINGS[self.kind])
        CORPUS[self.kind][self.file](m, path)
        return path

    def words(self, m: Material, path: Path, out: Path) -> list[str]:
        """The command line."""
        return [str(word) for word in COMMANDS[self.kind][self.command](m, path, out)]


def cases() -> Iterator[Case]:
    """Every file before every command that reads its kind."""
    for kind, files in CORPUS.items():
        yield from (Case(kind, file, command) for file in files for command in COMMANDS[kind])
