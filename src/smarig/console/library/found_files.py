"""The files of a folder and its subfolders that can be entries, with what tells whether they have changed.

Links to folders are not followed, so a loop of links ends; hidden folders are left out. What a folder can make this
cost is bounded.
"""

import os
import stat
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from smarig.console.library.library_entry import DIAGNOSIS, MODEL, RUN, shown_place
from smarig.diagnosis import DIAGNOSIS_JSON, DIAGNOSIS_PAGE
from smarig.record import SIDECARS

PAGE = "page"  # of any kind, which its head states
MOST_NAMES = 2_000_000  # in all folders together
DEEPEST = 60  # folders within each other
MOST_PROBLEMS = 20  # that are told one by one
_MODEL_NAME = "model.json"


@dataclass(frozen=True)
class FoundFile:
    """A file: its place in the folder, what it is by its name, size, time, and ``state``, which a change changes.

    ``newest_ns`` is the time of the last change of the file or of its write-ahead log.
    """

    place: bytes
    kind: str
    size: int
    modified_ns: int
    newest_ns: int
    state: str


@dataclass(frozen=True)
class LibraryFiles:
    """The files by place, and a sentence for each folder that could not be read."""

    files: Mapping[bytes, FoundFile]
    problems: tuple[str, ...]


def found_files(folder: Path) -> LibraryFiles:
    """The files in the folder that can be entries."""
    files: dict[bytes, FoundFile] = {}
    problems: list[str] = []
    names, waiting = 0, [(b"", 0)]
    while waiting:
        place, depth = waiting.pop()
        try:
            inside = list(_names(os.fsencode(folder), place, MOST_NAMES - names))
        except OSError as error:
            _add(problems, f"Folder {shown_place(place) or '.'} cannot be read: {error.strerror}.")
            continue
        names += len(inside)
        if depth < DEEPEST:
            waiting += [(place + name + b"/", depth + 1) for name, is_folder in inside if is_folder]
        files |= {file.place: file for file in _candidates(os.fsencode(folder), place, inside)}
        if names >= MOST_NAMES:
            _add(problems, f"The folder has more than {MOST_NAMES} files; the rest is left out.")
            break
    return LibraryFiles(files, tuple(problems))


def file_now(folder: Path, place: bytes, kind: str) -> FoundFile | None:
    """The file as it is now; None if it is gone or no regular file."""
    head, _, name = place.rpartition(b"/")
    where = os.path.join(os.fsencode(folder), head)  # noqa: PTH118 - Path takes no bytes
    neighbours = {name + os.fsencode(suffix) for suffix in SIDECARS} if kind == RUN else set()
    return _file(where, place, name, kind, neighbours)


def _names(folder: bytes, place: bytes, most: int) -> Iterator[tuple[bytes, bool]]:
    """Names in a folder and whether each is a folder. Hidden ones are left out."""
    with os.scandir(os.path.join(folder, place)) as inside:  # noqa: PTH118
        for each in inside:
            if most <= 0:
                return
            most -= 1
            if not each.name.startswith(b"."):
                yield each.name, each.is_dir(follow_symlinks=False)


def _candidates(folder: bytes, place: bytes, inside: list[tuple[bytes, bool]]) -> Iterator[FoundFile]:
    plain = {name for name, is_folder in inside if not is_folder}
    for name in plain:
        kind = _kind(name, plain)
        if kind:
            where = os.path.join(folder, place)  # noqa: PTH118
            found = _file(where, place + name, name, kind, plain)
            if found is not None:
                yield found


def _kind(name: bytes, neighbours: set[bytes]) -> str:
    """What a file is by its name; "" for any other. The page of a diagnosis stands for its numbers."""
    if name.endswith(b".run.sqlite"):
        return RUN
    if name == _MODEL_NAME.encode() or name.endswith(b"." + _MODEL_NAME.encode()):
        return MODEL
    if name.endswith(b".html"):
        return PAGE
    if name == DIAGNOSIS_JSON.encode() and DIAGNOSIS_PAGE.encode() not in neighbours:
        return DIAGNOSIS
    return ""


def _file(folder: bytes, place: bytes, name: bytes, kind: str, neighbours: set[bytes]) -> FoundFile | None:
    about = _status(folder, name)
    if about is None or not stat.S_ISREG(about.st_mode):
        return None
    states = [_state(about)]
    newest = about.st_mtime_ns
    for suffix in SIDECARS if kind == RUN else ():
        sidecar = name + os.fsencode(suffix)
        if suffix != "-shm" and sidecar in neighbours and (other := _status(folder, sidecar, linked=False)):
            states.append(suffix + _state(other))
            newest = max(newest, other.st_mtime_ns)
    return FoundFile(place, kind, about.st_size, about.st_mtime_ns, newest, " ".join(states))


def _status(folder: bytes, name: bytes, *, linked: bool = True) -> os.stat_result | None:
    try:
        return os.stat(os.path.join(folder, name), follow_symlinks=linked)  # noqa: PTH116, PTH118
    except (OSError, ValueError):
        return None


def _state(about: os.stat_result) -> str:
    """Size and times; the inode and the time of its change tell of a file that another one replaced."""
    return f"{about.st_size} {about.st_mtime_ns} {about.st_ctime_ns} {about.st_ino}"


def _add(problems: list[str], sentence: str) -> None:
    if len(problems) < MOST_PROBLEMS:
        problems.append(sentence)
    elif len(problems) == MOST_PROBLEMS:
        problems.append("There are more such folders.")
