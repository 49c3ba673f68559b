"""The hidden files that ``new_file`` writes, and those of them that a killed process has left behind.

The name tells the process and its computer, so a file that somebody still writes is never taken for left behind. A
process number may be in use again: such a file is kept, rather than one removed that is written.
"""

import os
import platform
import re
import secrets
import zlib
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

_LONGEST = 120  # characters of the name that the one beside it repeats
_NAME = re.compile(
    r"\.(?P<of>.+)\.(?:(?P<computer>[0-9a-f]{8})-(?P<process>\d{1,10})-)?[0-9a-f]{16}\.part(-journal|-wal|-shm)?",
    re.DOTALL,
)


class Writer(StrEnum):
    """What is known of the process that writes a hidden file."""

    ENDED = "ended"
    ALIVE = "alive"
    UNKNOWN = "unknown"  # of another computer, or of a smarig that did not tell


@dataclass(frozen=True)
class Leftover:
    """A hidden file in the place of ``of``, which was not finished."""

    path: Path
    of: str
    writer: Writer
    n_bytes: int


def part_name(name: str) -> str:
    """A name for the hidden file beside a file while it is written. It cannot be guessed."""
    return f".{name[:_LONGEST]}.{_computer()}-{os.getpid()}-{secrets.token_hex(8)}.part"


def leftovers(folder: Path) -> list[Leftover]:
    """The hidden files below a folder, in the order of their paths. Links are not followed."""
    found = []
    for place, _, names in os.walk(folder):
        for name in names:
            parts = _NAME.fullmatch(name)
            path = Path(place, name)
            if parts and path.is_file() and not path.is_symlink():
                writer = _writer(parts["computer"], parts["process"])
                found.append(Leftover(path, parts["of"], writer, path.stat().st_size))
    return sorted(found, key=lambda leftover: leftover.path)


def _computer() -> str:
    return f"{zlib.crc32(platform.node().encode(errors='surrogateescape')):08x}"


def _writer(computer: str | None, process: str | None) -> Writer:
    if process is None or computer != _computer() or os.name == "nt":
        return Writer.UNKNOWN
    try:
        os.kill(int(process), 0)
    except (ProcessLookupError, OverflowError):
        return Writer.ENDED
    except OSError:
        return Writer.ALIVE  # of another user
    return Writer.ALIVE
