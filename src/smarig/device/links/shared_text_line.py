"""One text line for all roles that use the same address: opened by the first, closed by the last.

A box that is both source and sensor has one port, and answers on it in the order of the queries.
"""

import threading
from dataclasses import dataclass

from smarig.config import LinkFile
from smarig.device.encoding.link_faults import Silent
from smarig.device.links.port_url import checked_url
from smarig.device.links.text_line import TextLine


@dataclass
class _OpenLine:
    """An open line and the number of its users."""

    line: TextLine
    users: int = 0


_OPEN: dict[str, _OpenLine] = {}
_GUARD = threading.Lock()


class SharedTextLine:
    """One user's part in a line. After its ``close`` it raises Silent; the other users keep theirs."""

    def __init__(self, key: str, entry: _OpenLine) -> None:
        self._key, self._entry, self._open = key, entry, True
        entry.users += 1

    @property
    def where(self) -> str:
        """The address, for messages."""
        return self._entry.line.where

    @property
    def repeats(self) -> int:
        """How many queries were asked once more."""
        return self._entry.line.repeats

    @property
    def reconnections(self) -> int:
        """How often the line was opened again."""
        return self._entry.line.reconnections

    def identify(self) -> str:
        """The instrument's identity, queried by the first user."""
        line = self._used()
        return line.identity or line.identify()

    def write(self, text: str) -> None:
        """Send a line that has no answer."""
        self._used().write(text)

    def ask(self, question: str, *, reads: bool | None = None) -> str:
        """The answer to a query."""
        return self._used().ask(question, reads=reads)

    def number(self, question: str, *, reads: bool | None = None) -> float:
        """The answer as a number."""
        return self._used().number(question, reads=reads)

    def close(self) -> None:
        """Leave the line; the last user closes it. Never raises and may be called repeatedly."""
        with _GUARD:
            if not self._open:
                return
            self._open = False
            self._entry.users -= 1
            if self._entry.users == 0:
                _OPEN.pop(self._key, None)
                self._entry.line.close()

    def _used(self) -> TextLine:
        if not self._open:
            raise Silent(f"{self.where} is not open. {Silent.remedy}")
        return self._entry.line


def shared_text_line(where: LinkFile, who: str = "*IDN?") -> SharedTextLine:
    """The text line of a link, shared with all that use the same address. The first user's ``timeout_s`` holds.

    Raises Silent if nothing listens there, ConfigError for an unknown scheme.
    """
    key = checked_url(where.url)
    with _GUARD:
        entry = _OPEN.get(key)
        if entry is None:
            entry = _OPEN[key] = _OpenLine(TextLine(where.url, where.baud, where.timeout_s, who))
        return SharedTextLine(key, entry)
