"""What a power cut leaves of a folder: computed from a log of all calls.

A file keeps what was synced. Of what was written since, each page (or sector) may be there or not, in any order. Of
the links, renames and removals since the last sync of the folder, the first ones may be there.
"""

import random
import struct
from dataclasses import dataclass, field
from pathlib import Path

HEAD = struct.Struct("6q")
OPEN, WRITE, TRUNCATE, SYNC, LINK, RENAME, UNLINK, NOTE = range(1, 9)
PAGE, SECTOR = 4096, 512


@dataclass(frozen=True)
class Call:
    """A call that succeeded, or a note; ``number`` counts calls."""

    kind: int
    a: int
    b: int
    one: bytes
    two: bytes
    number: int


@dataclass
class Content:
    """A file: what was synced, and the calls since."""

    synced: bytearray = field(default_factory=bytearray)
    since: list[Call] = field(default_factory=list)


def calls(log: bytes) -> list[Call]:
    """The calls in a log."""
    found, place = [], 0
    while place < len(log):
        kind, a, b, first, second, number = HEAD.unpack_from(log, place)
        place += HEAD.size
        found.append(
            Call(kind, a, b, log[place : place + first], log[place + first : place + first + second], number)
        )
        place += first + second
    return found


class Disk:
    """A folder after some calls."""

    def __init__(self, folder: Path) -> None:
        self._folder = str(folder).encode()
        self._files: dict[int, Content] = {}
        self._names: dict[bytes, int] = {}  # as they are
        self._synced_names: dict[bytes, int] = {}
        self._changes: list[
            dict[bytes, int]
        ] = []  # the names after each change since the last sync of the folder
        self._open: dict[int, int | None] = {}  # file descriptor to file; None for the folder

    def apply(self, call: Call) -> None:
        """One more call."""
        if call.kind == OPEN:
            self._opened(call)
        elif call.kind in (WRITE, TRUNCATE):
            self._files[self._file(call)].since.append(call)
        elif call.kind == SYNC:
            self._sync(self._open[call.a], failed=call.b != 0)
        elif call.kind in (LINK, RENAME, UNLINK):
            if call.kind != UNLINK:
                self._names[call.two] = self._names[call.one]
            if call.kind != LINK:
                del self._names[call.one]
            self._changes.append(dict(self._names))

    def _file(self, call: Call) -> int:
        number = self._open[call.a]
        assert number is not None
        return number

    def _opened(self, call: Call) -> None:
        if call.one.rstrip(b"/") == self._folder:
            self._open[call.a] = None
            return
        if call.b & 1:
            number = len(self._files)
            self._files[number] = Content()
            self._names[call.one] = number
            self._changes.append(dict(self._names))
        self._open[call.a] = self._names[call.one]
        if call.b & 2:
            self._files[self._names[call.one]].since.append(Call(TRUNCATE, call.a, 0, b"", b"", call.number))

    def _sync(self, number: int | None, *, failed: bool) -> None:
        """After a sync that failed, what was written before is never stored, though it can be read for a while."""
        if number is None:
            if not failed:
                self._synced_names, self._changes = dict(self._names), []
            return
        content = self._files[number]
        if not failed:
            content.synced = _after(content, lambda _: True, PAGE)
        content.since = []

    def leave(self, out: Path, how: str, chance: random.Random) -> None:
        """Write what a power cut now leaves into an empty folder."""
        whole = how.endswith("all")
        lost = how.endswith("synced")
        unit = SECTOR if how.endswith("torn pages") else PAGE
        names = self._names
        if not whole:
            names = chance.choice([self._synced_names, *([] if lost else self._changes)])
        for name, number in names.items():
            keep = (
                (lambda _: True)
                if whole
                else (lambda _: False)
                if lost
                else (lambda _: chance.random() < 0.5)
            )
            data = _after(self._files[number], keep, unit)
            if name.endswith(b"-shm"):  # it is written by other means than calls: anything may be left of it
                data = chance.randbytes(len(data))
            (out / Path(name.decode()).name).write_bytes(data)


def _after(content: Content, keep, unit: int) -> bytearray:
    """The bytes of a file with those units of its calls that are kept."""
    data = bytearray(content.synced)
    for call in content.since:
        if call.kind == TRUNCATE:
            if keep(call):
                data = data[: call.b].ljust(call.b, b"\0")
            continue
        for start in range(0, len(call.one), unit):
            if keep(call):
                piece, at = call.one[start : start + unit], call.b + start
                data = data.ljust(at, b"\0")
                data[at : at + len(piece)] = piece
    return data
