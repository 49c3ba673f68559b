"""Which entries a person has started: marks in a folder of the account, which no folder of runs can bring along.

A mark is a file without content. Its name is a hash of the place of the queue, the number and the arguments of the
entry, and the own code that it runs. The worker starts an entry only if its mark is there, and removes it: so an entry
that came with a folder, was copied, altered or put back among those that wait needs a click, and a console that is
started again goes on with what was queued here.
"""

import hashlib
import json
import os
from pathlib import Path

from smarig.console.own_code import (
    OwnCode,
    own_code_digest,
    own_code_of_effect,
    own_code_of_experiment,
    own_code_of_rig,
    own_code_of_setting,
)
from smarig.console.queue.entry_request import EntryRequest
from smarig.console.queue.queue_entry import QueueEntry
from smarig.core import StorageError


def marks_folder() -> Path:
    """The folder of the marks: $SMARIG_STATE_DIR/queues, or in the user's folder for the state of programs."""
    if given := os.environ.get("SMARIG_STATE_DIR"):
        return Path(given) / "queues"
    state = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(state) / "smarig" / "queues"


def own_code_of_request(request: EntryRequest, folder: Path) -> tuple[OwnCode, ...]:
    """The own code that the command of a request runs."""
    found = [*own_code_of_experiment(request.experiment, folder), *own_code_of_rig(request.rig, folder)]
    found += [code for effect in request.effects for code in own_code_of_effect(effect, folder)]
    found += [code for value in request.settings.values() for code in own_code_of_setting(value, folder)]
    return tuple(dict.fromkeys(found))


class AllowedEntries:
    """The marks of one queue."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder.resolve()
        self._place = marks_folder() / _hash(os.fsencode(self._folder))[:32]

    def mark_of(self, number: int, request: EntryRequest) -> str:
        """The name of the mark of an entry, as it and its own code are now."""
        code = own_code_digest(own_code_of_request(request, self._folder))
        parts = [os.fsencode(self._folder).hex(), number, request.to_json(), code]
        return _hash(json.dumps(parts).encode())

    def allow(self, number: int, request: EntryRequest) -> None:
        """A person has asked for this entry. Raises StorageError."""
        try:
            self._place.mkdir(mode=0o700, parents=True, exist_ok=True)
            (self._place / self.mark_of(number, request)).touch(mode=0o600)
        except OSError as error:
            raise StorageError(
                f"{self._place} cannot be written ({error.strerror or error}), so nothing would tell later that you "
                "have started this entry. Set SMARIG_STATE_DIR to a folder of yours."
            ) from None

    def has(self, entry: QueueEntry) -> bool:
        """Whether a person has asked for this entry, and nothing of it has changed since."""
        return self._place.is_dir() and (self._place / self.mark_of(entry.id, entry.request)).is_file()

    def take(self, entry: QueueEntry) -> bool:
        """The same; it counts once."""
        try:
            (self._place / self.mark_of(entry.id, entry.request)).unlink()
        except OSError:
            return False
        return True


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
