"""The rigs of a console: those that come with smarig, and the rig files of its folder."""

import hashlib
import re
from collections.abc import Container, Iterator
from dataclasses import dataclass
from pathlib import Path

from smarig.config import RigFile, led_out, load_rig, shipped_names
from smarig.core import (
    NotPassed,
    SmarigError,
    is_path,
    offers_of_name,
    opened_file,
    parsed_toml,
    passed,
    place_inside,
    shown,
)
from smarig.rig import DRIVERS, inconsistencies

_LONGEST_NAME = 255  # bytes of a file's name, at the most
_LARGEST_BYTES = 100_000  # a larger file is no rig
_KEYS = {"actuator", "base", "links"}  # that only rig files have
_RIG_LINE = re.compile(rb"^[ \t]*(actuator|base)[ \t]*=|^[ \t]*\[[ \t]*links\b", re.MULTILINE)


@dataclass(frozen=True)
class RigEntry:
    """A rig: its ``name`` for ``--rig``, and its file; without one, ``problems`` says why it cannot be used.

    ``closed``: a sentence on each thing outside of the folder that it names and nobody has opened by a click. Such a
    rig is not judged, and has no file if its base is among them. ``is_opened``: somebody has.
    """

    name: str
    file: RigFile | None
    problems: tuple[str, ...] = ()
    closed: tuple[str, ...] = ()
    is_opened: bool = False

    @property
    def closed_mark(self) -> str:
        """A text that differs whenever the rig or what is closed does; "" for nothing."""
        parts = repr((self.name, self.closed)).encode("utf-8", "replace")
        return hashlib.sha256(parts).hexdigest() if self.closed else ""

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
    def has_own_driver(self) -> bool:
        """Whether a file of the user's or a plug-in drives a device, so that only a check can say if it is in order."""
        return self.file is not None and _has_own_driver(self.file)

    @property
    def is_bench(self) -> bool:
        """Whether it has devices, real or simulated."""
        return self.file is not None and self.file.kind == "bench"

    @property
    def is_real(self) -> bool:
        """Whether real current flows."""
        return self.file is not None and self.is_bench and self.file.simulator is None


def rigs_of(folder: Path, opened: Container[str] = ()) -> list[RigEntry]:
    """Every rig, those of the folder first."""
    return [rig_entry(name, folder, opened) for name in rig_names(folder)]


def rig_names(folder: Path) -> list[str]:
    """The names of every rig, those of the folder first."""
    return [*_own_names(folder), *shipped_names("rigs")]


def rig_entry(name: str, folder: Path, opened: Container[str] = ()) -> RigEntry:
    """A rig by name, or by a file's path from the folder. ``opened`` has the ``closed_mark`` of those opened.

    Until then it came with its folder, and leads to nothing outside. Drivers of its own are code, which may do anything
    and never end: only the process of a check imports them.
    """
    path = name if name in shipped_names("rigs") else str(folder / name)
    if path != name and len(name) > _LONGEST_NAME:
        return RigEntry(name, None, (f"No rig {shown(name)}.",))
    entry = _entry(name, path, folder)
    return _entry(name, path, None) if entry.closed and entry.closed_mark in opened else entry


def _entry(name: str, path: str, came_with: Path | None) -> RigEntry:
    is_opened = came_with is None
    try:
        file = load_rig(path, came_with)
        closed = tuple(str(_refusal(text)) for text in led_out(file).values())
        if closed or _has_own_driver(file):
            return RigEntry(name, file, closed=closed, is_opened=is_opened)
        return RigEntry(name, file, tuple(inconsistencies(file)), is_opened=is_opened)
    except NotPassed as refusal:
        return RigEntry(name, None, closed=(str(refusal),))
    except SmarigError as error:
        return RigEntry(name, None, (str(error),))
    except (OSError, ValueError, RecursionError):
        return RigEntry(name, None, ("It is no rig file that can be read.",))


def _refusal(text: str) -> NotPassed | None:
    try:
        passed(text)
    except NotPassed as refusal:
        return refusal
    return None


def _has_own_driver(file: RigFile) -> bool:
    links = (
        [] if file.links is None else [getattr(file.links, role) for role in type(file.links).model_fields]
    )
    return any(
        link is not None and (is_path(link.driver) or offers_of_name(DRIVERS, link.driver)) for link in links
    )


def _own_names(folder: Path) -> Iterator[str]:
    """The files of the folder that describe a rig."""
    for path in sorted(folder.glob("*.toml")):
        try:
            path.name.encode()  # a name that no address can hold is left out
            if place_inside(path, folder) is None:  # a link that leads out, which is not followed
                continue
            content = _content(path)
        except (SmarigError, OSError, ValueError):
            continue
        if _describes_rig(content):
            yield path.name


def _describes_rig(content: bytes) -> bool:
    """Whether a file is that of a rig. One that is not valid TOML is known by its lines, so that its error is shown."""
    try:
        return bool(_KEYS & parsed_toml(content.decode()).keys())
    except ValueError:
        return _RIG_LINE.search(content) is not None


def _content(path: Path) -> bytes:
    """A small regular file. UsageError for a pipe or a device, ValueError for a long text."""
    with opened_file(path) as file:
        found = file.read(_LARGEST_BYTES + 1)
    if len(found) > _LARGEST_BYTES:
        raise ValueError(f"{path} is no rig file")
    return found
