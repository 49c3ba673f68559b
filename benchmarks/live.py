"""Time that the live view takes from the ticks of a run in real time over a serial pty.

The viewer is absent, attached, stopped, killed and restarted, each for a fifth of the time. The time in a
tick is the wall time of the runner's calls into the view. The table also gives the processor time of these
calls and the time of a bare call, since the three differ on a busy machine. Memory is that of this process.
"""

import os
import signal
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from time import monotonic, perf_counter, sleep, thread_time
from typing import Any

import numpy as np

from benchmarks.soak import LEVELS_A, RIG, _fixed_length_holds, _rss_MB
from smarig.config import load_rig
from smarig.core import Sample
from smarig.live import ViewerProcess, free_port, live_listener, rig_display_info, viewer_address
from smarig.plant import Actuator
from smarig.record import load_run
from smarig.rig import TwinSettings
from smarig.runner import CallbackListener, Listener, Session, twin_source

MINUTES, QUICK_MINUTES = 10.0, 0.7
PHASES = ("absent", "attached", "stopped", "killed", "restarted")
WALL, PROCESSOR, BARE = 1, 2, 3  # columns of the measured times
WINDOW = "1600x900"
TIMEOUT_S = 30.0


def run(quick: bool = False) -> dict[str, Any]:
    """Measure the ticks.

    Returns ``{"rig", "minutes", "samples", "lost", "tick_us": {phase: {"p50", "p99", "max"}}, "rss_MB",
    …}``.
    """
    minutes = QUICK_MINUTES if quick else MINUTES
    port, viewer_port = free_port(), free_port()
    scenario = _ViewerScenario(viewer_address(port), viewer_port, 60 * minutes / len(PHASES))
    hold_s = 60 * minutes / len(LEVELS_A)
    file = load_rig(RIG)
    actuator, source = Actuator.named(file.actuator), twin_source(file, TwinSettings())
    display_info = rig_display_info(file, actuator, source, {}, "benchmark live")
    messages: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        with (
            live_listener(display_info, viewer=False, port=port, show_message=messages.append) as watcher,
            scenario,
        ):
            timed = _TimedListener(watcher, scenario)
            with Session(RIG, speed=1.0, wire="live-benchmark") as session:
                path = session.run(
                    "step_currents",
                    {"currents_A": list(LEVELS_A), **_fixed_length_holds(hold_s)},
                    Path(folder) / "live.run.sqlite",
                    listeners=[CallbackListener(on_sample=timed.bare), timed],
                )
            viewer_state = scenario.viewer_state()
        record = load_run(path)
    return {
        "rig": RIG,
        "minutes": float(np.ptp(record["t_s"])) / 60,
        "samples": len(record),
        "lost": int(np.sum(np.diff(record["tick"]) - 1)),
        "tick_us": {phase: timed.figures(phase) for phase in PHASES},
        "tick_us_all": timed.figures(None),
        "processor_us_all": timed.figures(None, PROCESSOR),
        "bare_call_us_all": timed.figures(None, BARE),
        "rss_MB": {phase: timed.memory(phase) for phase in PHASES},
        "viewer": viewer_state,
        "said": messages,
    }


class _ViewerScenario:
    """The states of a viewer one after the other, controlled by a thread; ``phase`` is the present one."""

    def __init__(self, url: str, viewer_port: int, each_s: float) -> None:
        self._url, self._viewer_port, self._each_s = url, viewer_port, each_s
        self._viewer: ViewerProcess | None = None
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run_phases, daemon=True)
        self._running: list[bool] = []
        self.phase = PHASES[0]

    def __enter__(self) -> "_ViewerScenario":
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._over.set()
        self._thread.join()
        if self._viewer is not None:
            self._viewer.close()

    def _run_phases(self) -> None:
        began = monotonic()
        actions: tuple[tuple[str, Callable[[], None]], ...] = (
            ("attached", self._start),
            ("stopped", self._stop),
            ("killed", self._kill),
            ("restarted", self._start),
        )
        for k, (phase, action) in enumerate(actions, start=1):
            if self._over.wait(max(began + k * self._each_s - monotonic(), 0.0)):
                return
            action()
            self.phase = phase

    def _start(self) -> None:
        self._viewer = ViewerProcess.headless(self._url, self._viewer_port, WINDOW)

    def _stop(self) -> None:
        if self._viewer is not None and self._viewer.running:
            self._running.append(True)
            os.kill(self._viewer.process.pid, signal.SIGSTOP)

    def _kill(self) -> None:
        if self._viewer is not None:
            self._viewer.process.kill()
            self._viewer.close()

    def viewer_state(self) -> dict[str, Any]:
        """What the viewer that was started last shows. A late viewer must show the run from its start."""
        if self._viewer is None or not self._viewer.running:
            return {"running": False, "why": self._viewer.complaint if self._viewer else "never started"}
        from smarig.live import viewer_state

        until, failure = monotonic() + TIMEOUT_S, "it shows no recording"
        while monotonic() < until:
            try:
                found = viewer_state(f"rerun+http://127.0.0.1:{self._viewer_port}/proxy")
                if found["begins_s"]:
                    return {
                        "running": True,
                        "history_from_s": min(found["begins_s"]),
                        "history_to_s": max(found["ends_s"]),
                        "views": len(found["views"]),
                        "complaints": found["complaints"],
                    }
            except Exception as error:  # not ready yet, which raises several kinds of error
                failure = str(error)
            sleep(0.5)
        return {"running": True, "why": failure}


class _TimedListener:
    """A listener around another that measures the duration of each call by phase."""

    def __init__(self, inner: Listener, scenario: _ViewerScenario) -> None:
        self._inner, self._scenario = inner, scenario
        self._took: list[tuple[str, float, float, float]] = []
        self._memory: list[tuple[str, float]] = []
        self._bare_us = 0.0

    def bare(self, *_: Any) -> None:
        """The duration of a call and of two clock readings."""
        began = perf_counter()
        self._bare_us = 1e6 * (perf_counter() - began)

    def sample(self, s: Sample, step: int | None, input_value: float) -> None:
        """Pass the sample on and measure the duration."""
        began, worked = perf_counter(), thread_time()
        self._inner.sample(s, step, input_value)
        worked, took = thread_time() - worked, perf_counter() - began
        self._took.append((self._scenario.phase, 1e6 * took, 1e6 * worked, self._bare_us))
        if len(self._took) % 20 == 0:
            self._memory.append((self._scenario.phase, _rss_MB()))

    def step(self, *what: Any, **more: Any) -> None:
        """Pass the step on."""
        self._inner.step(*what, **more)

    def event(self, *what: Any, **more: Any) -> None:
        """Pass the event on."""
        self._inner.event(*what, **more)

    def figures(self, phase: str | None, what: int = WALL) -> dict[str, float] | None:
        """p50, p99 and max of a phase, or of all if None; None without data."""
        took = np.array([row[what] for row in self._took if phase in (row[0], None)])
        if not took.size:
            return None
        return {
            "p50": float(np.quantile(took, 0.5)),
            "p99": float(np.quantile(took, 0.99)),
            "max": float(took.max()),
            "n": took.size,
        }

    def memory(self, phase: str) -> float | None:
        """The peak memory of this process in a phase."""
        found = [m for p, m in self._memory if p == phase]
        return max(found) if found else None
