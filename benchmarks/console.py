"""What a console costs the run that it shows, how soon its page has a sample, and whether its memory grows.

A twin runs at 50 × real time in this process. A console and browsers' streams, each a process of its own, are absent,
attached, stopped, killed and restarted beside it. The tick is the processor time of the run's thread from one sample to
the next; ratios are to the ticks of the same run without a console. Streams stand for browsers: what a page draws with
comes over them.
"""

import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from time import monotonic, thread_time
from typing import Any

import numpy as np

from benchmarks.soak import LEVELS_A, _fixed_length_holds, _rss_MB
from smarig.config import load_rig
from smarig.core import Sample
from smarig.runner import CallbackListener, Session
from smarig.running import PanelRunInfo, RunStatus, announced, runs_in_progress

RIG, SPEED = "one_wire_twin", 50.0
PHASE_S = {True: 8.0, False: 65.0}
WITHOUT = "no console"
PHASES = (WITHOUT, "1 stream", WITHOUT, "3 streams", WITHOUT, "stopped", "killed", "restarted", WITHOUT)
START_S = 3.0  # the first seconds of a phase, in which streams begin with the history, count for nothing
LAUNCH_S = 20.0  # for the four consoles that are started; what is left is without a console
MEMORY_EVERY_S = 0.5

_STREAM = """
import http.client, json, sys, time, urllib.parse
address, key = sys.argv[1:3]
at = urllib.parse.urlsplit(address)
connection = http.client.HTTPConnection(at.hostname, at.port)
connection.request("GET", f"{at.path}?{at.query}")
first = connection.getresponse(); first.read()
cookie = first.getheader("set-cookie").partition(";")[0]
connection.request("GET", f"/runs/{key}/follow?model=", headers={"cookie": cookie})
lines = iter(connection.getresponse().readline, b"")
for line in lines:
    if line == b"event: samples\\n":
        rows = json.loads(next(lines).removeprefix(b"data: "))
        print(json.dumps([rows[0][0], time.monotonic()]), flush=True)
"""


def run(quick: bool = False) -> dict[str, Any]:
    """``{"rig", "hours_of_rig_time", "samples", "tick_us": {phase: {"p50", "p99", "ratio_p99"}}, "update_ms", …}``."""
    phase_s = PHASE_S[quick]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        scenario = _Scenario(folder, phase_s)
        timed = _Timer(scenario)
        total_s = SPEED * (phase_s * len(PHASES) + LAUNCH_S)
        with Session(RIG, speed=SPEED, wire="console-benchmark") as session:
            status = RunStatus(_description(session, folder, total_s), session.control, keys=False)
            with announced(status.run_info, session.control, status) as announcement, scenario:
                session.run(
                    "step_currents",
                    {"currents_A": list(LEVELS_A), **_fixed_length_holds(total_s / len(LEVELS_A))},
                    folder / "console.run.sqlite",
                    listeners=[status, announcement, CallbackListener(on_sample=timed.sample)],
                )
        return {
            "rig": RIG,
            "hours_of_rig_time": round(total_s / 3600, 2),
            "samples": len(timed.arrivals),
            "tick_us": _figures(timed.ticks),
            "update_ms": _updates(timed.arrivals, scenario.received(), load_rig(RIG).period_s / SPEED),
            "console_rss_MB": scenario.memory(),
            "console_share_of_a_core": scenario.shares,
        }


def _description(session: Session, folder: Path, total_s: float) -> PanelRunInfo:
    actuator = session.actuator
    return PanelRunInfo(
        protocol="step_currents",
        rig=session.file.name,
        wire=session.wire,
        source="twin",
        two_wire=actuator.two_wire,
        unit=actuator.unit,
        period_s=session.file.period_s,
        steps=len(LEVELS_A),
        duration_s=total_s,
        out=folder / "console.run.sqlite",
    )


class _Scenario:
    """The phases one after the other, controlled by a thread; ``phase`` is the present one, "" while one starts."""

    def __init__(self, folder: Path, phase_s: float) -> None:
        self._folder, self._phase_s = folder, phase_s
        self._console: subprocess.Popen[str] | None = None
        self._streams: list[subprocess.Popen[bytes]] = []
        self._files: list[Path] = []
        self._memory_MB: dict[str, list[float]] = {}
        self.shares: dict[str, float] = {}  # processor time of the console over time
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run_phases, daemon=True)
        self.phase = WITHOUT

    def __enter__(self) -> "_Scenario":
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._over.set()
        self._thread.join()
        self._end()

    def _run_phases(self) -> None:
        actions: dict[str, Callable[[], None]] = {
            WITHOUT: self._end,
            "1 stream": lambda: self._start(1),
            "3 streams": lambda: self._start(3),
            "stopped": self._start_and_stop,
            "killed": lambda: self._signal(signal.SIGKILL),
            "restarted": lambda: self._start(1),
        }
        for phase in PHASES:
            self.phase = ""
            actions[phase]()
            began = monotonic()
            if self._over.wait(min(START_S, self._phase_s / 2)):
                return
            self.phase = phase
            if self._watch(began + self._phase_s):
                return
        self._over.wait()

    def _watch(self, until_s: float) -> bool:
        """Note the memory and the work of a console that answers. Whether the run is over."""
        began, worked = monotonic(), self._worked_s()
        while monotonic() < until_s:
            if "stream" in self.phase or self.phase == "restarted":
                self._memory_MB.setdefault(self.phase, []).append(_rss_MB(_pid(self._console)))
            if self._over.wait(MEMORY_EVERY_S):
                return True
        if "stream" in self.phase:
            self.shares[self.phase] = round((self._worked_s() - worked) / (monotonic() - began), 4)
        return False

    def _start(self, streams: int) -> None:
        self._end()
        command = [sys.executable, "-m", "smarig", "console", "--folder", str(self._folder)]
        self._console = subprocess.Popen(
            [*command, "--no-browser", "--json"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        assert self._console.stdout is not None  # noqa: S101 - a pipe was asked for
        address = json.loads(self._console.stdout.readline())["address"]
        key = next(run.key for run in runs_in_progress() if run.info["pid"] == os.getpid())
        for _ in range(streams):
            self._files.append(self._folder / f"stream{len(self._files)}.jsonl")
            with self._files[-1].open("wb") as out:
                arguments = [sys.executable, "-c", _STREAM, address, key]
                self._streams.append(
                    subprocess.Popen(
                        arguments, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.DEVNULL
                    )
                )

    def _start_and_stop(self) -> None:
        self._start(1)
        self._signal(signal.SIGSTOP)

    def _signal(self, number: int) -> None:
        if self._console is not None:
            self._console.send_signal(number)

    def _end(self) -> None:
        for process in (*self._streams, self._console):
            if process is not None:
                process.send_signal(signal.SIGCONT)
                process.kill()
                process.communicate()
        self._streams, self._console = [], None

    def _worked_s(self) -> float:
        """Processor time of the console so far, s."""
        with contextlib.suppress(OSError):
            fields = Path(f"/proc/{_pid(self._console)}/stat").read_text().rpartition(")")[2].split()
            return sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")
        return 0.0

    def received(self) -> list[tuple[float, float]]:
        """The oldest sample of each update and when it came, of all streams."""
        lines = [line for file in self._files for line in file.read_text().splitlines()]
        return [tuple(json.loads(line)) for line in lines if line.endswith("]")]

    def memory(self) -> dict[str, dict[str, float]]:
        """Of the console, by phase: at its beginning and the largest in its last third."""
        return {
            phase: {
                "first": round(found[0], 1),
                "last_third": round(max(found[-max(1, len(found) // 3) :]), 1),
            }
            for phase, found in self._memory_MB.items()
        }


class _Timer:
    """Processor time of the run's thread from sample to sample by phase, and when each sample came."""

    def __init__(self, scenario: _Scenario) -> None:
        self._scenario = scenario
        self._worked = 0.0
        self.ticks: dict[str, list[float]] = {phase: [] for phase in PHASES}
        self.arrivals: dict[float, float] = {}

    def sample(self, s: Sample, *_: Any) -> None:
        """Note the time."""
        worked, phase = thread_time(), self._scenario.phase
        if phase and self._worked:
            self.ticks[phase].append(worked - self._worked)
        self.arrivals[round(s.t_s, 6)] = monotonic()
        self._worked = thread_time()


def _figures(ticks: dict[str, list[float]]) -> dict[str, dict[str, float] | None]:
    found = {phase: _quantiles(took) for phase, took in ticks.items()}
    reference = found[WITHOUT]
    for figures in found.values():
        if figures and reference:
            figures["ratio_p99"] = round(figures["p99"] / reference["p99"], 3)
    return found


def _quantiles(took: list[float]) -> dict[str, float] | None:
    if not took:
        return None
    p50, p99 = (round(1e6 * float(np.quantile(took, q)), 1) for q in (0.5, 0.99))
    return {"p50": p50, "p99": p99, "n": len(took)}


def _updates(
    arrivals: dict[float, float], received: list[tuple[float, float]], period_s: float
) -> dict[str, float] | None:
    """From the oldest sample of an update to its arrival, ms, without what waited while a console was stopped."""
    late = [at - arrivals[t] for t, at in received if t in arrivals]
    late = [each for each in late if each < START_S]
    if not late:
        return None
    return {
        "p50": round(1e3 * float(np.quantile(late, 0.5)), 1),
        "p95": round(1e3 * float(np.quantile(late, 0.95)), 1),
        "max": round(1e3 * max(late), 1),
        "n": len(late),
        "sample_ms": round(1e3 * period_s, 2),
    }


def _pid(process: subprocess.Popen[str] | None) -> int:
    """The number of a process; 0, which none has, without one."""
    return process.pid if process is not None else 0
