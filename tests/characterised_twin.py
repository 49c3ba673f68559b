"""``smarig characterise`` of the one-wire twin, the README's first command, run once for all workers of a session.

As a program it runs the command in a process of its own, whose memory ends with it, and keeps what it printed and the
evidence.
"""

import contextlib
import io
import os
import pickle
import shutil
import subprocess
import sys
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import pytest

from computed_once import alone, write_whole
from shared_previews import SharedPreviews
from smarig.report import Evidence

OUT = "first_wire"
WORDS = ("characterise", "--rig", "one_wire_twin", "--out", OUT)
PRINTED, EVIDENCE, LOCK = "printed.txt", "evidence.pickle", "lock"


@dataclass(frozen=True)
class CharacterisedTwin:
    """The folder in which the command ran; its files are for reading only."""

    folder: Path

    @property
    def printed(self) -> str:
        """What the command printed, both streams."""
        return (self.folder / PRINTED).read_text(encoding="utf-8")

    def copied(self, folder: Path) -> Path:
        """The folder of the characterisation, copied into another one."""
        return Path(shutil.copytree(self.folder / OUT, folder / OUT))

    def evidence(self) -> Evidence:
        """The evidence. Its paths are relative to the folder in which the command ran."""
        with (self.folder / EVIDENCE).open("rb") as file:  # its bytes take as much memory as what they hold
            return pickle.load(file)


def characterised_twin(folder: Path) -> CharacterisedTwin:
    """The characterisation in a folder that all workers share; the first to come runs the command."""
    folder.mkdir(exist_ok=True)
    with alone(folder / LOCK):
        if not (folder / EVIDENCE).is_file():
            private = {
                "SMARIG_LOCK_DIR": str(folder / ".locks"),
                "SMARIG_HISTORY_DIR": str(folder / ".wires"),
            }
            subprocess.run(
                [sys.executable, __file__, str(folder.parent / "previews")],
                cwd=folder,
                env=os.environ | private | {"COLUMNS": "120"},
                check=True,
            )
    return CharacterisedTwin(folder)


def run_command(previews: Path) -> None:
    """The command in the present folder."""
    from smarig.cli import run

    module, printed, evidence = import_module("smarig.app.characterise"), io.StringIO(), []
    analyse = module.analyse

    def kept(**given: object) -> Evidence:
        evidence.append(analyse(**given))
        return evidence[0]

    with (
        pytest.MonkeyPatch.context() as patch,
        contextlib.redirect_stdout(printed),
        contextlib.redirect_stderr(printed),
    ):
        patch.setattr(import_module("smarig.runner.preview"), "_computed", SharedPreviews(previews))
        patch.setattr(module, "analyse", kept)
        status = run(list(WORDS))
    if status:
        sys.exit(printed.getvalue())
    Path(PRINTED).write_text(printed.getvalue(), encoding="utf-8")
    write_whole(Path(EVIDENCE), evidence[0])  # last


if __name__ == "__main__":  # by its name, under which pickles are read
    import_module("characterised_twin").run_command(Path(sys.argv[1]))
