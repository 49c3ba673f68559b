"""Timing of a run in real time at 10 Hz over a serial pty, with the recorder and a slow listener.

The figures are the delay of each sample against its own clock, the computing time of the host, and the
growth of memory.
"""

import resource
import sys
import tempfile
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import numpy as np

from smarig.config import load_rig
from smarig.record import load_run
from smarig.runner import BoundedListener, CallbackListener, Session

RIG = "one_wire_serial"
MINUTES, QUICK_MINUTES = 10.0, 0.25
SLOW_S = 0.5  # of a listener, five ticks
QUEUE = 100  # samples that wait for it
LEVELS_A = (0.3, 0.6, 0.9, 0.5, 0.0)


def run(quick: bool = False) -> dict[str, Any]:
    """``{"rig", "minutes", "samples", "jitter_ms": {"p50", "p99", "max"}, "overruns", "dropped", "rss_MB"}``."""
    minutes = QUICK_MINUTES if quick else MINUTES
    period_s = load_rig(RIG).period_s
    arrivals: list[float] = []
    memory: list[float] = []

    def arrived(*_: Any) -> None:
        arrivals.append(monotonic())
        if len(arrivals) % 50 == 0:
            memory.append(_rss_MB())

    slow = BoundedListener(CallbackListener(on_sample=lambda *_: sleep(SLOW_S)), size=QUEUE)
    hold_s = 60 * minutes / len(LEVELS_A)
    with tempfile.TemporaryDirectory() as folder:
        with Session(RIG, speed=1.0, wire="soak") as session:
            path = session.run(
                "step_currents",
                {"currents_A": list(LEVELS_A), **_fixed_length_holds(hold_s)},
                Path(folder) / "soak.run.sqlite",
                listeners=[CallbackListener(on_sample=arrived), slow],
            )
        record = load_run(path)
    ticks = record["tick"]
    late = np.array(arrivals[: ticks.size]) - period_s * ticks
    jitter = 1e3 * (late - np.median(late))
    third = max(1, len(memory) // 3)
    return {
        "rig": RIG,
        "minutes": float(np.ptp(record["t_s"])) / 60,
        "samples": ticks.size,
        "lost": int(np.sum(np.diff(ticks) - 1)),
        "jitter_ms": {
            "p50": float(np.quantile(np.abs(jitter), 0.5)),
            "p99": float(np.quantile(np.abs(jitter), 0.99)),
            "max": float(np.abs(jitter).max()),
        },
        "overruns": int(np.sum(jitter > 1e3 * period_s)),
        "dropped": slow.dropped,
        "rss_MB": {"after_a_third": max(memory[:third]), "at_the_end": max(memory[-third:])},
    }


def _fixed_length_holds(hold_s: float) -> dict[str, float]:
    """Holds of a fixed duration."""
    return {"settle.band_counts": 1e-9, "settle.window_s": min(25.0, hold_s), "settle.timeout_s": hold_s}


def _rss_MB(pid: int | None = None) -> float:
    """The present memory of a process, or of this one, if the system reports it; else the peak of this one."""
    status = Path(f"/proc/{pid or 'self'}/statm")
    if status.is_file():
        return int(status.read_text().split()[1]) * resource.getpagesize() / 1e6
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most / (1e6 if sys.platform == "darwin" else 1e3)
