"""The commands that open a file of each kind."""

from collections.abc import Callable
from pathlib import Path

from hostile.hostile_files import COMMANDS as HOSTILE
from hostile.material import Material

Words = Callable[[Material, Path, Path], list[object]]
ENDINGS = {
    "run": ".run.sqlite",
    "model": ".model.json",
    "campaign": ".toml",
    "mapping": ".toml",
    "rig": ".toml",
    "folder": "",
    "table": ".csv",
    "workbook": ".xlsx",
}
COMMANDS: dict[str, dict[str, Words]] = {
    "run": {
        **HOSTILE["run"],
        "transformation": lambda m, f, o: ["transformation", f],
        "salvage": lambda m, f, o: ["check", f, "-o", o / "saved.run.sqlite"],
        "study": lambda m, f, o: ["study", f, "-o", o / "study"],
        "resume live": lambda m, f, o: ["resume", f, "--json"],
        "simulate on it": lambda m, f, o: [
            *("simulate", m.model, "--protocol", "initialise", "--rig", f, "-o", o / "s.run.sqlite"),
        ],
    },
    "model": {
        **HOSTILE["model"],
        "export c": lambda m, f, o: ["export", f, "--to", "c", "-o", o / "c_code"],
        "propose": lambda m, f, o: [
            *("diagnose", f, "--train", m.whole, "--held-out", m.killed, "--nulls", "40", "-o", o / "found"),
            *("--propose", o / "next.toml"),
        ],
    },
    "campaign": {
        "run": lambda m, f, o: ["run", f, "--rig", "one_wire_twin", "-o", o / "runs", "--dry-run"],
        "run for real": lambda m, f, o: ["run", f, "--rig", "one_wire_twin", "-o", o / "runs", "--quiet"],
        "characterise": lambda m, f, o: [
            *("characterise", "--rig", "one_wire_twin", "--campaign", f, "--out", o / "all"),
        ],
    },
    "mapping": {
        "import": lambda m, f, o: [
            *("import", m.folder / "good.mat", "--format", "mat", "--map", f, "-o", o / "i.run.sqlite"),
        ],
    },
    "rig": {
        "check": lambda m, f, o: ["check", f, "--protocol", "initialise"],
        "run": lambda m, f, o: ["run", "initialise", "--rig", f, "-o", o / "r.run.sqlite", "--quiet"],
    },
    "folder": {
        "report": lambda m, f, o: ["report", f],
        "report by force": lambda m, f, o: ["report", f, "--force"],
        "study": lambda m, f, o: ["study", f, "-o", o / "study"],
        "list": lambda m, f, o: ["check", f],
    },
    "table": HOSTILE["table"],
    "workbook": {"study": lambda m, f, o: ["study", f, "-o", o / "study"]},
}
FAST = {  # of each kind, those that take less than a fifth of a second
    "run": ("export csv", "verify", "simulate", "check", "transformation", "import", "replace"),
    "model": ("verify", "simulate along", "simulate on its rig", "export c"),
    "folder": ("report", "report by force"),
    "campaign": ("run", "run for real"),
}
