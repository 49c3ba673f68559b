"""Which entries a person has started: marks in a folder of the account, which no folder of runs can bring along.

A mark is a file without content. Its name is a hash of the place of the queue, the number and the arguments of the
entry, and the own code that it runs. The worker starts an entry only if its mark is there, and removes it: so an entry
that came with a folder, was copied, altered or put back among those that wait needs a click, and a console that is
started again goes on with what was queued here.

Files outside of the folder are opened only for an entry that a person has asked for. If they bring code (a base that
names a driver), there are two marks, before and after that; with the first alone the code is shown, and waits for a
click.
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
    own_code_text,
)
from smarig.console.queue.entry_request import EntryRequest
from smarig.console.queue.queue_entry import QueueEntry
from smarig.core import StorageError, UsageError


def marks_folder() -> Path:
    """The folder of the marks: $SMARIG_STATE_DIR/queues, or in the user's folder for the state of programs."""
    if given := os.environ.get("SMARIG_STATE_DIR"):
        return Path(given) / "queues"
    state = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(state) / "smarig" / "queues"


def own_code_of_request(
    request: EntryRequest, folder: Path, *, opened: bool = False, rig_is_opened: bool = False
) -> tuple[OwnCode, ...]:
    """The own code that the command of a request runs. ``opened``: a person has asked for it, or only for its rig."""
    found = [
        *own_code_of_experiment(request.experiment, folder, opened=opened),
        *own_code_of_rig(request.rig, folder, opened=opened or rig_is_opened),
    ]
    for effect in request.effects:
        found += own_code_of_effect(effect, folder, opened=opened)
    for value in request.settings.values():
        found += own_code_of_setting(value, folder, opened=opened)
    return tuple(dict.fromkeys(found))


class AllowedEntries:
    """The marks of one queue."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder.resolve()
        self._place = marks_folder() / _hash(os.fsencode(self._folder))[:32]

    def code_of(self, number: int, request: EntryRequest) -> tuple[OwnCode, ...]:
        """The own code of an entry; of files outside of the folder only if a person has asked for it."""
        code = own_code_of_request(request, self._folder)
        if (self._place / self._mark(number, request, code)).is_file():
            return own_code_of_request(request, self._folder, opened=True)
        return code

    def mark_of(self, number: int, request: EntryRequest) -> str:
        """The name of the mark of an entry, as it and its own code are now."""
        return self._mark(number, request, self.code_of(number, request))

    def allow(self, number: int, request: EntryRequest, *, as_shown: bool = False) -> None:
        """A person has asked for this entry. Raises StorageError.

        ``as_shown``: with the code of ``code_of``. UsageError if files that were opened only now bring more.
        """
        before = self.code_of(number, request)
        self._leave(self._mark(number, request, before))
        code = self.code_of(number, request)
        shown = {(each.role, each.name) for each in before}
        if as_shown and (more := [each for each in code if (each.role, each.name) not in shown]):
            raise UsageError(f"Entry {number} also runs {own_code_text(more)}. Look at it again.")
        self._leave(self._mark(number, request, code))

    def _mark(self, number: int, request: EntryRequest, code: tuple[OwnCode, ...]) -> str:
        parts = [os.fsencode(self._folder).hex(), number, request.to_json(), own_code_digest(code)]
        return _hash(json.dumps(parts).encode())

    def _leave(self, mark: str) -> None:
        try:
            self._place.mkdir(mode=0o700, parents=True, exist_ok=True)
            (self._place / mark).touch(mode=0o600)
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
        first = self._mark(entry.id, entry.request, own_code_of_request(entry.request, self._folder))
        try:
            (self._place / self.mark_of(entry.id, entry.request)).unlink()
            (self._place / first).unlink(missing_ok=True)
        except OSError:
            return False
        return True


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
