"""A text line that several roles of one instrument share (``SharedConnections``)."""

from smarig.config import LinkFile
from smarig.device.links.port_url import checked_url
from smarig.device.links.shared_connection import ConnectionUse, SharedConnections
from smarig.device.links.text_line import TextLine

_LINES: SharedConnections[TextLine] = SharedConnections()


class SharedTextLine(ConnectionUse[TextLine]):
    """One user's part in a line."""

    @property
    def repeats(self) -> int:
        """How many queries were asked once more."""
        return self._connection.repeats

    @property
    def reconnections(self) -> int:
        """How often the line was opened again."""
        return self._connection.reconnections

    def identify(self) -> str:
        """The instrument's identity, queried by the first user."""
        return self.connection.identity or self.connection.identify()

    def write(self, text: str) -> None:
        """Send a command at once, whatever state the line is in."""
        self.connection.write(text)

    def ask(self, question: str, *, reads: bool | None = None) -> str:
        """The answer to a query."""
        return self.connection.ask(question, reads=reads)

    def number(self, question: str, *, reads: bool | None = None) -> float:
        """The answer as a number."""
        return self.connection.number(question, reads=reads)


def shared_text_line(where: LinkFile, who: str = "*IDN?", *, acknowledged: bool = False) -> SharedTextLine:
    """The text line of a link, shared with all that use the same address. The first user's values hold.

    ``who``: the query of its identity, "" if it has none. ``acknowledged``: the instrument answers each command, such
    as with "OK".

    Raises Silent if nothing listens there, ConfigError for an unknown scheme.
    """
    key = checked_url(where.url)
    return _LINES.use(
        SharedTextLine,
        key,
        lambda: TextLine(
            where.url,
            where.baud,
            where.timeout_s,
            who,
            line_end=where.line_end,
            acknowledged=acknowledged,
            serial_format=where.serial_format,
        ),
    )
