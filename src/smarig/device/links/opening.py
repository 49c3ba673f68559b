"""Opens the link that a rig file describes."""

from urllib.parse import urlsplit

from smarig.config import LinkFile
from smarig.core import ConfigError
from smarig.device.links.link import Link
from smarig.device.links.modbus_tcp import ModbusTcp
from smarig.device.links.serial_line import TEXT, SerialLine, rtu_framing
from smarig.device.links.serial_port import SharedPort

PORT = 502
NETWORK = ("socket", "rfc2217")  # schemes of pyserial with host and port


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
            url = _line(where.url)
            port = SharedPort(url, where.baud, where.timeout_s, address)
            return SerialLine(url, rtu_framing(address), where.timeout_s, port=port)
        case "lines":
            return SerialLine(_line(where.url), TEXT, where.timeout_s, where.baud)


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


def _line(url: str) -> str:
    """The name of a serial port, or the checked URL of a serial port on the network."""
    kind, network, rest = url.partition("://")
    if not network:
        return url
    try:
        parts = urlsplit(f"tcp://{rest}")
        whole = bool(parts.hostname and parts.port)
    except ValueError:
        whole = False
    if kind in NETWORK and not whole:
        raise ConfigError(
            f"'{url}' is not an address of a serial port on the network. Write {kind}://HOST:PORT."
        )
    return url
