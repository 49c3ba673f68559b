"""What identifies the line of a link, however its address is written.

Addresses are compared as text, without DNS, which can hang: a host name and its IP address count as two lines.
"""

import ipaddress
import os
import socket
import stat
from contextlib import suppress
from pathlib import Path
from urllib.parse import urlsplit

from smarig.runner.visa_address import canonical_address

MODBUS_PORT = 502  # of an address without a port
SCPI_PORT = "5025"  # scpi-raw at IANA: the first device of an instrument
_THIS_COMPUTER = "localhost"


def line_keys(url: str, driver: str = "") -> set[str]:
    """What identifies the line of a link. Two links on one line have a key in common, however they are written.

    Units of Modbus share their line, so the unit's address is no part of it. NI's software names its devices for the
    whole computer.

    >>> line_keys("tcp://127.0.0.1") == line_keys("socket://LOCALHOST:502") == line_keys("tcp://127.1")
    True
    >>> line_keys("TCPIP0::10.0.0.5::inst0::INSTR") & line_keys("tcp://10.0.0.5:5025")
    {'line 10.0.0.5/0'}
    """
    if not url:
        return set()
    if driver.startswith("ni_"):
        return {f"line ni/{url.strip().lower()}"}
    url = canonical_address(url)
    kind, network, rest = url.partition("://")
    if not network:
        return _port_keys(url)
    if kind in ("spy", "alt"):  # pyserial's wrappings of a local port
        return _port_keys(rest.partition("?")[0])
    if kind == "visa":
        host, _, device = rest.partition("/")
        return {f"line {_host(host.strip('[]'))}/{device}"}
    place = _place(rest) if kind in ("tcp", "socket", "rfc2217") else None
    keys = {f"line {place or url}"}
    if place and place.endswith(f":{SCPI_PORT}"):
        keys.add(f"line {place.rpartition(':')[0]}/0")
    return keys


def _port_keys(name: str) -> set[str]:
    """A serial port by its name, its real path and its device number. Replugged, it may keep only the first."""
    if os.name == "nt":
        return {"line " + name.removeprefix("\\\\.\\").upper()}
    path = Path(name).absolute()
    found = {f"line {path}", f"line {os.path.realpath(path)}"}
    try:
        about = path.stat()
    except (OSError, ValueError):
        return found
    if stat.S_ISCHR(about.st_mode):
        found.add(f"line device {os.major(about.st_rdev)}:{os.minor(about.st_rdev)}")
    return found


def _place(rest: str) -> str | None:
    """HOST:PORT, the same for all names of this computer; None if it is none. Names are not looked up."""
    try:
        parts = urlsplit(f"tcp://{rest}")
        host, port = parts.hostname or "", MODBUS_PORT if parts.port is None else parts.port
    except ValueError:
        return None
    return f"{_host(host)}:{port}" if host else None


def _host(name: str) -> str:
    name = name.rstrip(".").lower()
    with suppress(OSError, ValueError):  # such as a NUL
        name = socket.inet_ntoa(socket.inet_aton(name))  # 127.1 and 0x7f000001 are addresses, too
    try:
        address = ipaddress.ip_address(name)
    except ValueError:
        own = name.endswith(".localhost") or name == socket.gethostname().lower()
        return _THIS_COMPUTER if own else name
    mapped = getattr(address, "ipv4_mapped", None)
    address = mapped or address
    return _THIS_COMPUTER if address.is_loopback or address.is_unspecified else str(address)
