"""Watches what a command does, by an audit hook of Python: nothing may be executed, nothing outside touched."""

import os
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

_CONNECTS = ("socket.connect", "socket.getaddrinfo", "socket.sendto")
_STARTS = ("subprocess.Popen", "os.exec", "os.posix_spawn", "os.spawn", "os.system", "os.startfile")
_CHANGES = (
    "os.remove",
    "os.rename",
    "os.mkdir",
    "os.rmdir",
    "os.link",
    "os.symlink",
    "os.truncate",
    "os.chmod",
)
_TOUCHES = ("open", "os.", "ctypes.dlopen", "sqlite3.connect", "import", "glob", "shutil", "tempfile")
_OF_LINKS = ("os.remove", "os.rename", "os.link", "os.symlink", "os.readlink", "os.lstat")
_FLAGS = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC


class Watch:
    """What a command did that it must not: touched ``outside``, wrote elsewhere, started or called anything."""

    def __init__(self, outside: Path) -> None:
        self.outside = os.path.realpath(outside)
        self.seen: list[str] = []
        self._places = [tempfile.gettempdir(), str(Path.home()), *_caches()]

    def note(self, event: str, arguments: tuple[Any, ...]) -> None:
        """Judge one event."""
        if event in _CONNECTS and not _is_local(arguments):
            self.seen.append(f"{event} {arguments[1:]!r:.100}")
        elif event in _STARTS:
            self.seen.append(f"{event} {arguments[:2]!r:.300}")
        elif event == "exec" and self._is_outside(getattr(arguments[0], "co_filename", "")):
            self.seen.append(f"exec {arguments[0].co_filename}")
        elif event.startswith(_TOUCHES):
            real = _of_the_link if event in _OF_LINKS else os.path.realpath
            self.seen += [f"{event} {a!s:.200}" for a in arguments if self._is_outside(a, real)]
            if _writes(event, arguments) and self._is_elsewhere(arguments[0]):
                self.seen.append(f"{event} {arguments[0]!s:.200}: written")

    def _is_outside(self, what: object, real: Callable[[str], str] = os.path.realpath) -> bool:
        if isinstance(what, bytes):
            what = os.fsdecode(what)
        if isinstance(what, os.PathLike):
            what = os.fspath(what)
        if not isinstance(what, str) or not what or len(what) > 4000 or "\0" in what:
            return False
        if self.outside in what:
            return True
        there = real(what)
        return there.startswith(self.outside + os.sep) and os.path.lexists(there)

    def _is_elsewhere(self, what: object) -> bool:
        if isinstance(what, int) or what is None:
            return False
        place = os.path.realpath(os.fsdecode(what))
        return not place.startswith("/dev/") and not any(place.startswith(p) for p in self._places if p)


def _of_the_link(path: str) -> str:
    """A link is removed or replaced itself, not what it leads to."""
    return os.path.join(os.path.realpath(os.path.dirname(path)), os.path.basename(path))  # noqa: PTH118, PTH120, PTH119


_ACTIVE: list[Watch] = []
_JUDGING = threading.local()


def _hook(event: str, arguments: tuple[Any, ...]) -> None:
    if _ACTIVE and not getattr(_JUDGING, "now", False):  # what judging does is not judged
        _JUDGING.now = True
        try:
            _ACTIVE[-1].note(event, arguments)
        finally:
            _JUDGING.now = False


@contextmanager
def looks_seen() -> Iterator[None]:
    """Python has no audit events for looks at what a file is, or where a link leads: here they are events, too."""
    with pytest.MonkeyPatch.context() as patch:
        for name in ("stat", "lstat", "readlink", "access"):
            patch.setattr(os, name, _seen(name, getattr(os, name)))
        yield


def _seen(name: str, look: Callable[..., Any]) -> Callable[..., Any]:
    def noted(path: Any, *more: Any, **others: Any) -> Any:
        _hook(f"os.{name}", (path,))
        return look(path, *more, **others)

    return noted


_INSTALLED: list[bool] = []  # a hook stays for the life of the process


@contextmanager
def watched(outside: Path) -> Iterator[Watch]:
    """Watch what is done here. Commands run in this process, so that nothing escapes; processes are not started.

    Modules that are imported meanwhile leave no bytecode beside them, which would be a file written elsewhere.
    """
    if not _INSTALLED:
        sys.addaudithook(_hook)
        _INSTALLED.append(True)
    _ACTIVE.append(Watch(outside))
    kept, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        yield _ACTIVE[-1]
    finally:
        sys.dont_write_bytecode = kept
        _ACTIVE.pop()


def _writes(event: str, arguments: tuple[Any, ...]) -> bool:
    if event in _CHANGES:
        return True
    mode, flags = (*arguments, None, None)[1:3]
    writes = isinstance(mode, str) and any(c in mode for c in "wax+")
    return event == "open" and (writes or (isinstance(flags, int) and bool(flags & _FLAGS)))


def _is_local(arguments: tuple[Any, ...]) -> bool:
    """Whether an address is that of a socket of this computer's own files."""
    return isinstance(arguments[-1], str | bytes) and not isinstance(arguments[0], str)


def _caches() -> list[str]:
    return [
        os.path.realpath(v)
        for k, v in os.environ.items()
        if k.endswith(("_DIR", "_CACHE", "CACHE_HOME")) and v
    ]
