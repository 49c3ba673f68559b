"""One runner per wire and per line: a session at real devices locks the wire's name and the address of each link.

Twins and simulated devices that a session starts itself are locked by nobody: each session has its own. The locks
exclude processes of one computer. Two computers that reach the same device over a network cannot be kept apart by a
file: only give one of them the address.
"""

from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager

from smarig.config import LinksFile, RigFile
from smarig.core import process_lock
from smarig.runner.line_keys import line_keys
from smarig.runner.run_metadata import outlives_session

SHARED = ("room_thermometer",)  # a device of the room may serve several rigs


@contextmanager
def rig_locks(file: RigFile, wire: str) -> Iterator[None]:
    """Hold the locks of a rig: none, or that of the wire and those of each line. Raises InUse with the holder."""
    with ExitStack() as held:
        if outlives_session(file):
            held.enter_context(wire_lock(wire))
            roles = LinksFile.model_fields if file.links else ()
            links = [getattr(file.links, role) for role in roles if role not in SHARED]
            named = [link for link in links if link is not None]
            lines = {key: link.url for link in named for key in line_keys(link.url, link.driver)}
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
