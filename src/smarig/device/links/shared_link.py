"""A link of registers that several roles of one instrument share (``SharedConnections``)."""

from smarig.config import LinkFile
from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.device.links.link import Link
from smarig.device.links.opening import opened
from smarig.device.links.shared_connection import ConnectionUse, SharedConnections

_LINKS: SharedConnections[Link] = SharedConnections()


class SharedLink(ConnectionUse[Link]):
    """One user's part in a link."""

    def exchange(self, exchange: Exchange) -> list[int] | Refusal:
        """Send one request and return its reply."""
        return self.connection.exchange(exchange)

    def more(self, exchange: Exchange) -> list[int] | Refusal:
        """The next reply without a new request."""
        return self.connection.more(exchange)

    def reopen(self) -> None:
        """Close the line and open it again, for all its users."""
        self.connection.reopen()


def shared(where: LinkFile, default_address: int) -> SharedLink:
    """The link of a rig file, shared with all that use the same address. The first user's ``timeout_s`` holds.

    Raises Silent if nothing listens there, ConfigError if the file does not name it.
    """
    key = (where.framing, where.url, where.address or default_address)
    return _LINKS.use(SharedLink, key, lambda: opened(where, default_address))
