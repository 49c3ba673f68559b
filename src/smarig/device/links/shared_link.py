"""One link for several roles of one instrument: it is opened by the first user and closed by the last.

Instruments such as a LabJack accept few connections, and their watchdog counts the silence of all of them together.
"""

import threading
from dataclasses import dataclass

from smarig.config import LinkFile
from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.device.encoding.link_faults import Silent
from smarig.device.links.link import Link
from smarig.device.links.opening import opened

Key = tuple[str, str, int]


@dataclass
class _Entry:
    """An open link and the number of its users."""

    link: Link
    users: int = 0


_OPEN: dict[Key, _Entry] = {}
_GUARD = threading.Lock()


class SharedLink:
    """One user's part in a link. After its ``close`` it raises Silent; the other users keep theirs."""

    def __init__(self, key: Key, entry: _Entry) -> None:
        self._key, self._entry = key, entry
        self._open = True
        entry.users += 1

    @property
    def where(self) -> str:
        """The name of the line, for messages."""
        return self._entry.link.where

    def exchange(self, exchange: Exchange) -> list[int] | Refusal:
        """Send one request and return its reply."""
        return self._used().exchange(exchange)

    def more(self, exchange: Exchange) -> list[int] | Refusal:
        """The next reply without a new request."""
        return self._used().more(exchange)

    def reopen(self) -> None:
        """Close the line and open it again, for all its users."""
        self._used().reopen()

    def close(self) -> None:
        """Leave the link; the last user closes it. Never raises and may be called repeatedly."""
        with _GUARD:
            if not self._open:
                return
            self._open = False
            self._entry.users -= 1
            if self._entry.users == 0:
                _OPEN.pop(self._key, None)
                self._entry.link.close()

    def _used(self) -> Link:
        if not self._open:
            raise Silent(f"{self.where} is not open. {Silent.remedy}")
        return self._entry.link


def shared(where: LinkFile, default_address: int) -> SharedLink:
    """The link of a rig file, shared with all that use the same address. The first user's ``timeout_s`` holds.

    Raises Silent if nothing listens there, ConfigError if the file does not name it.
    """
    key = (where.framing, where.url, where.address or default_address)
    with _GUARD:
        entry = _OPEN.get(key)
        if entry is None:
            entry = _OPEN[key] = _Entry(opened(where, default_address))
        return SharedLink(key, entry)
