"""The rigs of a console: those that come with smarig, and the rig files of its folder."""

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from smarig.config import RigFile, load_rig, shipped_names
from smarig.core import SmarigError
from smarig.rig import inconsistencies

_LARGEST_BYTES = 100_000  # a larger file is no rig


@dataclass(frozen=True)
class RigEntry:
    """A rig: its ``name`` for ``--rig``, and its file; without one, ``problems`` says why it cannot be used."""

    name: str
    file: RigFile | None
    problems: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        """What it drives, in words."""
        if self.file is None:
            return ""
        if self.file.kind == "twin":
            return "Twin"
        return "Bench with simulated devices" if self.file.simulator else "Bench: real current"

    @property
    def is_template(self) -> bool:
        """Whether only the addresses of its devices are missing."""
        return bool(self.problems) and all("placeholder" in problem for problem in self.problems)

    @property
    def is_bench(self) -> bool:
        """Whether it has devices, real or simulated."""
        return self.file is not None and self.file.kind == "bench"

    @property
    def is_real(self) -> bool:
        """Whether real current flows."""
        return self.file is not None and self.is_bench and self.file.simulator is None


def rigs_of(folder: Path) -> list[RigEntry]:
    """Every rig, those of the folder first."""
    return [rig_entry(name, folder) for name in rig_names(folder)]


def rig_names(folder: Path) -> list[str]:
    """The names of every rig, those of the folder first."""
    return [*_own_names(folder), *shipped_names("rigs")]


def rig_entry(name: str, folder: Path) -> RigEntry:
    """A rig by name, or by a file's path from the folder."""
    try:
        file = load_rig(str(folder / name) if name.endswith(".toml") else name)
    except SmarigError as error:
        return RigEntry(name, None, (str(error),))
    return RigEntry(name, file, tuple(inconsistencies(file)))


def _own_names(folder: Path) -> Iterator[str]:
    """The files of the folder that describe a rig."""
    for path in sorted(folder.glob("*.toml")):
        try:
            if path.stat().st_size > _LARGEST_BYTES:
                continue
            table = tomllib.loads(path.read_text("utf-8"))
        except (OSError, ValueError, RecursionError):
            continue  # no table, or not TOML: nothing says that it is a rig
        if {"actuator", "base", "links"} & table.keys():
            yield path.name
