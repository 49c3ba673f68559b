"""One command at real devices on a disk that stops answering, in processes of their own.

The folder holds a part for each of the places that a run uses: ``out``, ``history``, ``locks``, ``running``.
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from runner.lasting_devices import ROOT, rig_file, started

PARTS = ("out", "history", "locks", "running")
PATIENCE_S = 90.0  # ends a case that has failed
APART_S = 0.7  # between two Ctrl-C
_VARYING = r"[0-9a-f]{8}-\d+-[0-9a-f]{16}|.{30,}-[0-9a-f]{8}(?=\.lock)|\d+-\w{8}|(?<=#)\d+"  # in names
COMMAND = """
import sys
from importlib import import_module
limits = import_module("smarig.core.forced_end")
limits.STALLED_S, limits.REQUESTED_S = float(sys.argv[1]), float(sys.argv[2])
from smarig.cli import main
main(sys.argv[3:])
"""
RUN = ("run", "wiping_out", "--set", "points_per_branch=1", "-o", "{out}/a.run.sqlite")


def shim(folder: Path) -> Path:
    """The library that stalls the disk of a process, built."""
    built = folder / "stalled_disk.so"
    source = Path(__file__).with_name("stalled_disk.c")
    subprocess.run(["gcc", "-O1", "-w", "-shared", "-fPIC", "-o", built, source, "-ldl"], check=True)
    return built


@dataclass(frozen=True)
class Operation:
    """A call of the C library on a file, whose name is a pattern, and the thread that makes it: "main" or "other"."""

    part: str
    call: str
    name: str = ""
    thread: str = "main"

    def __str__(self) -> str:
        return f"{self.thread}: {self.call} {self.part}/{self.name}"


@dataclass
class Ending:
    """How a command ended. ``after_s``: since the last signal, or since the first call that hung; inf if it did not."""

    hung: str  # "main" or "other" thread, "" if no call hung
    after_s: float
    status: int | None
    stderr: str
    locked: list[str]  # files whose locks are held after the end
    output_A: float  # the last current of the amplifier, in its own record
    calls: list[tuple[str, str, str]] = field(default_factory=list)  # call, path, thread


def stalled_run(
    base: Path,
    library: Path,
    operation: Operation | None,
    signals: Sequence[signal.Signals],
    *,
    words: Sequence[str] = RUN,
    stalled_s: float = 60.0,
    requested_s: float = 15.0,
) -> Ending:
    """Run a command until it ends, and signal it when the operation hangs."""
    for part in PARTS:
        (base / part).mkdir(parents=True)
    trace, mark, log = base / "trace.csv", base / "mark", base / "log"
    with started(trace=trace) as urls:
        rig = rig_file(base / "rig.toml", urls, wire="stalled")
        given = [word.format(out=base / "out") for word in words]
        process = subprocess.Popen(
            [sys.executable, "-c", COMMAND, str(stalled_s), str(requested_s), *given, "--rig", str(rig)],
            env=_environment(base, library, operation, mark, log),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            asked_s = _asked(process, mark, signals)
            _, stderr = process.communicate(timeout=PATIENCE_S)
            after_s = time.monotonic() - asked_s
        except subprocess.TimeoutExpired:
            after_s, stderr = float("inf"), ""
        finally:
            status = process.poll()
            locked = [path.name for path in sorted((base / "locks").glob("*.lock")) if _is_locked(path)]
            process.kill()
    hung = mark.read_text() if mark.exists() else ""
    calls = [tuple(line.split("\t")) for line in log.read_text().splitlines()] if log.exists() else []
    return Ending(hung, after_s, status, stderr, locked, _last_current_A(trace), calls)


def _environment(
    base: Path, library: Path, operation: Operation | None, mark: Path, log: Path
) -> dict[str, str]:
    given = {
        "PYTHONPATH": str(ROOT / "src"),
        "LD_PRELOAD": str(library),
        "SMARIG_HISTORY_DIR": str(base / "history"),
        "SMARIG_LOCK_DIR": str(base / "locks"),
        "SMARIG_RUNNING_DIR": str(base / "running"),
        "HANG_ROOT": str(base if operation is None else base / operation.part),
    }
    if operation is None:
        return {**os.environ, **given, "HANG_LOG": str(log)}
    path = str(base / operation.part / operation.name)
    hanging = {"HANG_CALL": operation.call, "HANG_THREAD": operation.thread, "HANG_PATH": path}
    return {**os.environ, **given, **hanging, "HANG_MARK": str(mark)}


def _asked(process: subprocess.Popen, mark: Path, signals: Sequence[signal.Signals]) -> float:
    """Send the signals when the operation hangs. Returns the host time of the last, or of the hang."""
    while not mark.exists() and process.poll() is None:
        time.sleep(0.02)
    for k, number in enumerate(signals):
        time.sleep(APART_S if k else 0.2)
        process.send_signal(number)
    return time.monotonic()


def _is_locked(path: Path) -> bool:
    import fcntl

    with path.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return True
    return False


def _last_current_A(trace: Path) -> float:
    """The current that flows in the last tick of the devices."""
    head, *rows = trace.read_text().splitlines()
    return float(rows[-1].split(",")[head.split(",").index("output_uA")]) * 1e-6 if rows else 0.0


def operations(calls: Sequence[tuple[str, str, str]], base: Path) -> list[Operation]:
    """Each call on each kind of file by each kind of thread once, in the order of the first."""
    found = {}
    for call, path, thread in calls:
        part, _, name = os.path.relpath(path, base).partition("/")
        if part in PARTS:
            found[Operation(part, call, re.sub(_VARYING, "*", name), thread)] = None
    return list(found)


def clear(base: Path) -> None:
    """Remove what a case has left."""
    shutil.rmtree(base, ignore_errors=True)
