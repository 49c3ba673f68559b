"""Viewer processes: the native viewer, or a web server for browsers. Both use loopback and end with this
process.

They are started directly, because the wrapper on PATH would leave them orphaned. Their configuration is in a
temporary folder: analytics are off, and nothing is written into the user's home.
"""

import atexit
import contextlib
import importlib.util
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
from pathlib import Path

from smarig.core import MissingExtra, UsageError

LOOPBACK = "127.0.0.1"
MEMORY = "1GB"  # of the viewer; it drops the oldest data beyond that
WEB_REMARK = (
    "The page requests fonts, updates and telemetry from the internet; "
    "it also works with that traffic blocked."
)
_HOME_PREFIX = "smarig-viewer-"  # prefix of temporary folders, followed by the process that owns them: PID-…
_ANSI_COLOUR = re.compile("\x1b\\[[0-9;]*m")
_ERROR_PATTERN = re.compile(
    r"\b(error|panicked|fatal)\b", re.IGNORECASE
)  # other kinds of messages explain nothing
_SCREEN_VARIABLES = ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET")


def free_port(requested: int = 0) -> int:
    """A free loopback port, or ``requested`` if given. Raises UsageError if that port is taken."""
    with socket.socket() as probe:
        if os.name != "nt":
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((LOOPBACK, requested))
        except OSError:
            raise UsageError(
                f"Port {requested} on {LOOPBACK} is taken. Give another port, or none."
            ) from None
        return probe.getsockname()[1]


def viewer_address(port: int) -> str:
    """The address of a server of this process."""
    return f"rerun+http://{LOOPBACK}:{port}/proxy"


def program() -> Path:
    """The viewer that comes with the package."""
    found = importlib.util.find_spec("rerun_cli")
    if found is None or found.origin is None:
        raise MissingExtra("The live view", "live")
    return Path(found.origin).with_name("rerun.exe" if os.name == "nt" else "rerun")


class ViewerProcess:
    """A process that shows the data served at an address. ``close`` or the end of this process ends it."""

    def __init__(self, arguments: list[str]) -> None:
        _remove_stale_homes()
        self._home = tempfile.mkdtemp(prefix=f"{_HOME_PREFIX}{os.getpid()}-")
        self._log = Path(self._home) / "viewer.log"
        with self._log.open("wb") as log:
            self.process = subprocess.Popen(
                [*parent_death_signal(), str(program()), *arguments],
                env=_environment(Path(self._home)),
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,  # Ctrl-C is for the run only
            )
        atexit.register(self.close)

    @classmethod
    def native(cls, url: str) -> "ViewerProcess":
        """A window on this screen. Raises UsageError if there is no screen."""
        _check_screen()
        port = str(free_port())
        return cls(
            ["--bind", LOOPBACK, "--port", port, "--memory-limit", MEMORY, "--hide-welcome-screen", url]
        )

    @classmethod
    def headless(cls, url: str, port: int, size: str) -> "ViewerProcess":
        """A viewer without a screen, controlled at ``port``, for images."""
        common = [
            "--bind",
            LOOPBACK,
            "--memory-limit",
            MEMORY,
            "--hide-welcome-screen",
            "--window-size",
            size,
        ]
        return cls(["--headless", "--port", str(port), *common, url])

    @classmethod
    def web(cls, url: str, port: int) -> "ViewerProcess":
        """A web server at ``port``."""
        return cls(["--serve-web", "--bind", LOOPBACK, "--web-viewer-port", str(port), url])

    @property
    def running(self) -> bool:
        """Whether the viewer still runs."""
        return self.process.poll() is None

    @property
    def complaint(self) -> str:
        """The last error message of the viewer, or ""."""
        with contextlib.suppress(OSError):
            lines = _ANSI_COLOUR.sub("", self._log.read_text(errors="replace")).splitlines()
            return next((line.strip() for line in reversed(lines) if _ERROR_PATTERN.search(line)), "")
        return ""

    def close(self) -> None:
        """End the process in any state; may be repeated."""
        atexit.unregister(self.close)
        if self.running:
            with contextlib.suppress(ProcessLookupError):
                self.process.terminate()
                _continue_process(self.process)
            try:
                self.process.wait(3)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        shutil.rmtree(self._home, ignore_errors=True)


def web_page(web_port: int, port: int) -> str:
    """The address to open in a browser."""
    return f"http://{LOOPBACK}:{web_port}/?url={viewer_address(port).replace('+', '%2B')}&hide_welcome_screen"


def _check_screen() -> None:
    """Raise UsageError if a window cannot be opened, before anything runs."""
    if sys.platform.startswith("linux") and not any(os.environ.get(name) for name in _SCREEN_VARIABLES):
        raise UsageError(
            "No screen is available: neither DISPLAY nor WAYLAND_DISPLAY is set. Use --web for a browser, or "
            "'smarig view RUN --save FILE.rrd' to view the run on another machine."
        )


def _remove_stale_homes() -> None:
    """Remove the folders of viewers whose owners were killed."""
    if os.name == "nt":  # os.kill would end the process on Windows
        return
    for home in Path(tempfile.gettempdir()).glob(f"{_HOME_PREFIX}[0-9]*-*"):
        with contextlib.suppress(ValueError, PermissionError):  # not one of these folders, or another user's
            try:
                os.kill(int(home.name.removeprefix(_HOME_PREFIX).partition("-")[0]), 0)
            except (ProcessLookupError, OverflowError):
                shutil.rmtree(home, ignore_errors=True)


def _environment(home: Path) -> dict[str, str]:
    """The environment of the viewer: settings in ``home`` and analytics off."""
    where = home / "rerun"
    where.mkdir()
    settings = {
        "analytics_enabled": False,
        "analytics_id": "",
        "metadata": {},
        "config_file_path": str(where / "analytics.json"),
        "data_dir_path": str(where / "analytics"),
    }
    (where / "analytics.json").write_text(json.dumps(settings), encoding="utf-8")
    return {
        **os.environ,
        "XDG_CONFIG_HOME": str(home),
        "XDG_DATA_HOME": str(home),
        "XDG_CACHE_HOME": str(home),
    }


def _continue_process(process: subprocess.Popen) -> None:
    """Continue a stopped process, since it handles SIGTERM only then."""
    if hasattr(signal, "SIGCONT"):
        process.send_signal(signal.SIGCONT)


def parent_death_signal() -> list[str]:
    """On Linux: a command that has the kernel end the viewer when this process ends, even by kill -9.

    The kernel looks at the thread that starts the viewer: it must be one that lasts. It also
    lowers the viewer's priority, so that the run comes first if the viewer draws without a graphics card.
    """
    if not sys.platform.startswith("linux"):
        return []
    ask = "import ctypes,os,sys; ctypes.CDLL(None).prctl(1, 9)\n"  # PR_SET_PDEATHSIG, SIGKILL
    become = "os.nice(10); os.getppid() == int(sys.argv[1]) and os.execv(sys.argv[2], sys.argv[2:])"
    return [sys.executable, "-S", "-P", "-c", ask + become, str(os.getpid())]
