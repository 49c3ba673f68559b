"""Opens the link that a rig file describes."""

from urllib.parse import urlsplit

from smarig.config import LinkFile
from smarig.core import ConfigError
from smarig.device.links.link import Link
from smarig.device.links.modbus_tcp import ModbusTcp
from smarig.device.links.serial_line import TEXT, SerialLine, rtu_framing
from smarig.device.links.serial_port import SharedPort

PORT = 502


def opened(where: LinkFile, default_address: int) -> Link:
    """The open line to one device. Raises Silent if it does not exist, ConfigError if the file does not name it."""
    if not where.url:
        raise ConfigError("The rig file does not locate its devices. Give links.DEVICE.url or [simulator].")
    address = where.address or default_address
    match where.framing:
        case "modbus_tcp":
            host, port = _place(where.url)
            return ModbusTcp(host, port, address, where.timeout_s)
        case "modbus_rtu":
            port = SharedPort(where.url, where.baud, where.timeout_s, address, where.serial_format)
            return SerialLine(where.url, rtu_framing(address), where.timeout_s, port=port)
        case "lines":
            if where.line_end != "\n":
                raise ConfigError(
                    f"The lines of firmware_protocol end with a line feed: leave out line_end of {where.url}."
                )
            return SerialLine(where.url, TEXT, where.timeout_s, where.baud, serial_format=where.serial_format)


def _place(url: str) -> tuple[str, int]:
    try:
        parts = urlsplit(url)
        host, port = parts.hostname or "", PORT if parts.port is None else parts.port
        host.encode("idna")
    except ValueError:
        parts, host, port = None, "", 0
    if parts is None or parts.scheme != "tcp" or not host or not port:
        raise ConfigError(f"'{url}' is not an address of Modbus TCP. Write tcp://HOST:PORT.")
    return host, port
