"""``smarig check FOLDER``: name the hidden files that killed processes have left behind, and remove them on request."""

import contextlib
from pathlib import Path

from smarig.cli.output import emit
from smarig.core import Leftover, Writer, leftovers, printable

_STATES = {
    Writer.ENDED: "its process has ended",
    Writer.ALIVE: "its process is running",
    Writer.UNKNOWN: "its process is not of this computer, or is not known; not removed",
}


def check_leftovers(folder: Path, *, remove: bool) -> None:
    """Report the unfinished files below a folder. Only those of ended processes are removed."""
    found = leftovers(folder)
    ended = [leftover for leftover in found if leftover.writer == Writer.ENDED]
    removed = [leftover.path for leftover in ended if remove and _removed(leftover)]
    lines = [
        f"{printable(str(each.path), 300)} ({each.n_bytes} bytes, instead of {printable(each.of)}): "
        f"{_state(each, removed)}"
        for each in found
    ]
    noun = "file" if len(found) == 1 else "files"
    lines.append(f"{folder} holds {len(found)} unfinished {noun}; {len(removed)} removed.")
    if ended and not remove:
        lines.append(f"Remove those of ended processes: smarig check {folder} --remove-leftovers")
    data = [
        {
            "file": str(f.path),
            "of": f.of,
            "writer": str(f.writer),
            "bytes": f.n_bytes,
            "removed": f.path in removed,
        }
        for f in found
    ]
    emit({"folder": str(folder), "leftovers": data}, "\n".join(lines))


def _state(leftover: Leftover, removed: list[Path]) -> str:
    return "removed" if leftover.path in removed else _STATES[leftover.writer]


def _removed(leftover: Leftover) -> bool:
    with contextlib.suppress(OSError):
        leftover.path.unlink()
        return True
    return False
