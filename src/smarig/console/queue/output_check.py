"""Where an entry may write: inside the folder of the queue, on nothing that exists or that another entry will write."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from smarig.console.queue.entry_request import EntryRequest
from smarig.console.queue.queue_entry import QueueEntry
from smarig.core import UsageError, shown
from smarig.record import check_not_recording

_RESERVED = (
    "queue.sqlite",
    "queue.log",
    "library.sqlite",
    "library.notes",
)  # first part of a name, and what it begins


def with_checked_output(request: EntryRequest, folder: Path) -> EntryRequest:
    """The request, its output relative to the folder. Raises UsageError, or InUse if it is being recorded."""
    if request.out.endswith("/") and request.kind == "protocol":
        raise UsageError(f"{shown(request.out)} is a folder. Name a run file.")
    inside = check_inside(request, folder)
    _check_absent(folder.resolve() / request.out, request)
    return replace(request, out=str(inside))


def check_inside(request: EntryRequest, folder: Path) -> Path:
    """The output relative to the folder. Raises UsageError if it is outside, or a file of the console itself."""
    try:
        inside = (folder.resolve() / request.out).resolve().relative_to(folder.resolve())
    except ValueError:
        raise UsageError(f"{shown(request.out)} is outside {folder}. Name an output inside it.") from None
    except OSError as error:
        raise UsageError(f"{shown(request.out)} is no usable name: {error.strerror or error}.") from None
    if inside == Path() or inside.parts[0].startswith(_RESERVED):
        raise UsageError(f"{shown(request.out)} is a name of the console itself. Give another name.")
    return inside


def check_no_other(request: EntryRequest, others: Iterable[QueueEntry]) -> None:
    """Raise UsageError if another entry writes to the same place, or one of them inside the other's folder."""
    mine = Path(request.out)
    for other in others:
        theirs = Path(other.request.out)
        if mine == theirs or mine in theirs.parents or theirs in mine.parents:
            raise UsageError(f"Entry {other.id} writes to {theirs}. Give another name than {mine}.")


def _check_absent(target: Path, request: EntryRequest) -> None:
    if request.kind == "protocol":
        check_not_recording(target)
        if target.exists():
            raise UsageError(f"{request.out} exists. Give another name.")
    elif target.exists() and not target.is_dir():
        raise UsageError(f"{request.out} is not a folder. Name a folder for the runs.")
    elif target.exists() and any(target.iterdir()):
        raise UsageError(f"Folder {request.out} is not empty. Give another name.")
    blocked = next((p for p in target.parents if p.exists() and not p.is_dir()), None)
    if blocked is not None:
        raise UsageError(f"{blocked} is not a folder. Give another name.")
