"""One runner per wire and per line: a session at real devices locks the wire's name and the address of each link.

Twins and simulated devices that a session starts itself are locked by nobody: each session has its own. The locks
exclude processes of one computer. Two computers that reach the same device over a network cannot be kept apart by a
file: only give one of them the address.
"""

import ipaddress
import os
import socket
import stat
from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from pathlib import Path
from urllib.parse import urlsplit

from smarig.config import LinksFile, RigFile
from smarig.core import process_lock
from smarig.runner.run_metadata import outlives_session

SHARED = ("room_thermometer",)  # a device of the room may serve several rigs
MODBUS_PORT = 502  # of an address without a port
_THIS_COMPUTER = "localhost"


@contextmanager
def rig_locks(file: RigFile, wire: str) -> Iterator[None]:
    """Hold the locks of a rig: none, or that of the wire and those of each line. Raises InUse with the holder."""
    with ExitStack() as held:
        if outlives_session(file):
            held.enter_context(wire_lock(wire))
            roles = LinksFile.model_fields if file.links else ()
            links = [getattr(file.links, role) for role in roles if role not in SHARED]
            urls = [link.url for link in links if link is not None]
            lines = {key: url for url in urls for key in line_keys(url)}
            for key in sorted(lines):
                held.enter_context(_line_lock(key, lines[key]))
        yield


def wire_lock(wire: str) -> AbstractContextManager[None]:
    """Hold the lock of a wire."""
    return process_lock(
        wire,
        f"Wire '{wire}' is in use",
        "Wait until it has ended, or stop it. A rig with another wire gives that wire its own name (--wire).",
    )


def _line_lock(key: str, url: str) -> AbstractContextManager[None]:
    return process_lock(
        key,
        f"The line {url} is in use",
        "Wait until it has ended, stop it, or correct links in the rig file.",
    )


def line_keys(url: str) -> set[str]:
    """What identifies the line of a link. Two links on one line have a key in common, however they are written.

    Units of Modbus share their line, so the unit's address is no part of it.

    >>> line_keys("tcp://127.0.0.1") == line_keys("socket://LOCALHOST:502") == line_keys("tcp://127.1")
    True
    """
    if not url:
        return set()
    kind, network, rest = url.partition("://")
    if not network:
        return _port_keys(url)
    if kind in ("spy", "alt"):  # pyserial's wrappings of a local port
        return _port_keys(rest.partition("?")[0])
    place = _place(rest) if kind in ("tcp", "socket", "rfc2217") else None
    return {f"line {place or url}"}


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
