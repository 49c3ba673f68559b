"""Addresses of lines that carry bytes: a serial port, or a URL; and the opening of what they name.

    /dev/serial/by-id/…, COM3    a serial port of this computer
    tcp://HOST:PORT              a TCP socket of an instrument or gateway; ``socket://`` is the same
    rfc2217://HOST:PORT          a serial port on the network

The other URLs of pyserial (``hwgrep://``, ``spy://``, …) are accepted, too.
"""

import contextlib
import errno
import os
import select
import socket
import time
from urllib.parse import urlsplit

import serial

from smarig.core import ConfigError
from smarig.device.encoding.link_faults import Silent
from smarig.device.links.network_address import no_scheme_text

NETWORK = ("tcp", "socket", "rfc2217")  # schemes with host and port
LOCAL = ("alt", "cp2110", "hwgrep", "loop", "spy")  # of pyserial, for ports of this computer
_SCHEMES = (
    "a serial port, tcp://HOST:PORT (a TCP socket) or rfc2217://HOST:PORT (a serial port on the network)"
)


def checked_url(url: str) -> str:
    """The URL in the words of pyserial. Raises ConfigError for an unknown scheme or none, and for one without host or
    port.

    >>> checked_url("tcp://192.168.1.30:5025"), checked_url("/dev/ttyUSB0")
    ('socket://192.168.1.30:5025', '/dev/ttyUSB0')
    """
    scheme, is_url, rest = url.partition("://")
    if not is_url:
        if wrong := no_scheme_text(url):
            raise ConfigError(wrong)
        return url
    if scheme not in (*NETWORK, *LOCAL):
        raise ConfigError(f"'{url}': nothing is reached by '{scheme}://'. Give {_SCHEMES}.")
    if scheme in NETWORK and not _has_port(rest):
        kind = "a serial port on the network" if scheme == "rfc2217" else "a TCP socket"
        written = "rfc2217" if scheme == "rfc2217" else "tcp"
        raise ConfigError(f"'{url}' is not an address of {kind}. Write {written}://HOST:PORT.")
    return f"socket://{rest}" if scheme == "tcp" else url


def unopened_port(
    url: str, baud: int, timeout_s: float, write_timeout_s: float, serial_format: str = "8N1"
) -> serial.Serial:
    """The port of a checked URL, closed. ``serial_format``: of a serial port, as in a rig file."""
    data_bits, parity, stop_bits = int(serial_format[0]), serial_format[1], float(serial_format[2:])
    return serial.serial_for_url(
        url,
        baudrate=baud,
        bytesize=data_bits,
        parity=parity,
        stopbits=stop_bits,
        timeout=timeout_s,
        write_timeout=None if url.startswith("rfc2217:") else write_timeout_s,  # rfc2217 has none
        do_not_open=True,
    )


def send(port: serial.Serial, data: bytes) -> None:
    """Send bytes. Raises SerialTimeoutException if the line does not take them in time.

    pyserial looks at the time after it has sent, too: on a busy computer, its time-out comes although all was taken.
    """
    is_plain = os.name == "posix" and (type(port) is serial.Serial or _socket_of(port) is not None)
    if not (is_plain and port.is_open and port.write_timeout):
        port.write(data)
        return
    end_s = time.monotonic() + port.write_timeout
    while data:
        left_s = end_s - time.monotonic()
        sent = 0
        if select.select([], [port.fileno()], [], max(left_s, 0.0))[1]:
            with contextlib.suppress(BlockingIOError):
                sent = os.write(port.fileno(), data)
        if not sent and left_s <= 0:
            reason = "the device reads nothing, or its flow control holds the line"
            raise serial.SerialTimeoutException(reason)
        data = data[sent:]


def send_at_once(port: serial.Serial) -> bool:
    """Whether it is a TCP socket. A query on it does not wait until the command before is acknowledged, for 40 ms."""
    line = _socket_of(port)
    if line is None:
        return False
    with contextlib.suppress(OSError):
        line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return True


def close_port(port: serial.Serial) -> None:
    """Close it; also a socket whose connection was cut, which pyserial would leave open. Never raises."""
    line = _socket_of(port)
    if line is not None:
        with contextlib.suppress(OSError):
            line.shutdown(socket.SHUT_RDWR)
        line.close()
        port.is_open = False  # pyserial would wait for 0.3 s
        return
    with contextlib.suppress(Exception):
        port.close()


def error_of(url: str, error: BaseException) -> str:
    """What pyserial says, with the address as it was given."""
    return str(error).replace("socket://", "tcp://") if url.startswith("tcp://") else str(error)


def refusal_of(url: str, error: BaseException, baud: int, serial_format: str) -> str:
    """The same, with what to do: a port that exists may not offer the speed or the format."""
    if getattr(error, "errno", None) == errno.EINVAL or errno.EINVAL in getattr(error, "args", ()):
        return f"it does not offer {baud} baud with {serial_format}. Give another baud or serial_format."
    return f"{error_of(url, error)}. {Silent.remedy}"


def _socket_of(port: serial.Serial) -> socket.socket | None:
    line = getattr(port, "_socket", None)
    return line if isinstance(line, socket.socket) else None


def _has_port(rest: str) -> bool:
    try:
        parts = urlsplit(f"tcp://{rest}")
        return bool(parts.hostname and parts.port)
    except ValueError:
        return False
