"""How an entry has ended: from its exit status, its result and its last lines."""

import json
import signal
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarig.console.queue.entry_process import EntryFiles
from smarig.console.queue.queue_entry import EntryState
from smarig.core import Interrupted, UsageError, file_bytes, opened_file, printable

_LAST_BYTES = 20_000  # of the lines that are searched for the last sentence
_LARGEST_RESULT = 100_000_000
_NO_RESULT = "The process is gone without a result: it was killed, or the machine was restarted."


@dataclass(frozen=True)
class Outcome:
    """The new state of an entry. ``pauses``: the rig, the data or a person gave a reason to start nothing more."""

    state: EntryState
    exit_status: int | None
    sentence: str

    @property
    def pauses(self) -> bool:
        """A refused command (exit status 2) has no cause that the next entry would share."""
        refused = self.state is EntryState.FAILED and self.exit_status == UsageError.exit_status
        return self.state is not EntryState.DONE and not refused


def outcome_of(folder: Path, number: int, exit_status: int | None) -> Outcome:
    """The outcome of an entry whose process has ended. ``exit_status`` is None if another worker had started it."""
    files = EntryFiles.of(folder, number)
    result = _result(files.result)
    if exit_status is None and result is not None:
        exit_status = result.get("exit_status", 0) if "error" in result else 0
    if exit_status is None or exit_status < 0:
        return Outcome(EntryState.INTERRUPTED, exit_status, _killed_text(exit_status))
    error = str(result["error"]) if result and "error" in result else ""
    if exit_status == 0:
        return Outcome(EntryState.DONE, 0, printable(_last_sentence(files.lines, "Warning: "), 1000))
    sentence = printable(error or _last_sentence(files.lines), 1000)
    state = EntryState.STOPPED if exit_status == Interrupted.exit_status else EntryState.FAILED
    return Outcome(state, exit_status, sentence or f"It ended with exit status {exit_status}.")


def _killed_text(exit_status: int | None) -> str:
    if exit_status is None:
        return _NO_RESULT
    try:
        name = signal.Signals(-exit_status).name
    except ValueError:
        name = f"signal {-exit_status}"
    return f"The process was killed ({name})."


def _result(path: Path) -> dict[str, Any] | None:
    """The object that a command prints at its end; None if it printed none."""
    with suppress(UsageError, OSError, ValueError):
        if path.stat().st_size <= _LARGEST_RESULT:
            found = json.loads(file_bytes(path))
            return found if isinstance(found, dict) else None
    return None


def _last_sentence(path: Path, start: str = "") -> str:
    """The last line for people that starts so; lines for programs begin with a brace."""
    with suppress(UsageError, OSError), opened_file(path) as file:
        file.seek(max(path.stat().st_size - _LAST_BYTES, 0))
        lines = file.read().decode("utf-8", "replace").splitlines()
        plain = [
            line for line in map(str.strip, lines) if line.startswith(start) and line[:1] not in ("", "{")
        ]
        return plain[-1].removeprefix("smarig: ") if plain else ""
    return ""
