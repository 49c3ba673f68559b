"""Which link a rig file asks for, opened."""

from urllib.parse import urlsplit

from smarig.config import LinkFile
from smarig.errors import ConfigError
from smarig.links.link import Link
from smarig.links.modbus_tcp import ModbusTcp
from smarig.links.serial_line import TEXT, SerialLine, rtu_framing

PORT = 502


def opened(where: LinkFile, default_address: int) -> Link:
    """The line to one device. Raises Silent where there is none, ConfigError where the file does not say which."""
    if not where.url:
        raise ConfigError(
            "The rig file does not say where its devices are: give links.DEVICE.url, or [simulator]."
        )
    address = where.address or default_address
    match where.framing:
        case "modbus_tcp":
            host, port = _place(where.url)
            return ModbusTcp(host, port, address, where.timeout_s)
        case "modbus_rtu":
            return SerialLine(where.url, rtu_framing(address), where.timeout_s, where.baud)
        case "lines":
            return SerialLine(where.url, TEXT, where.timeout_s, where.baud)


def _place(url: str) -> tuple[str, int]:
    parts = urlsplit(url)
    try:
        port = parts.port or PORT
    except ValueError:
        port = 0
    if parts.scheme != "tcp" or not parts.hostname or not port:
        raise ConfigError(f"'{url}' is no address of Modbus TCP; write tcp://HOST:PORT.")
    return parts.hostname, port
