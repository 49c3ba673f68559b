"""Duration of a diagnosis of the thesis's largest record: 407 steps, all effects.

The records are the two-wire twin's first-order descending curves, once without an effect and once with each
of a few effects. Times are wall times from run file to verdict. Memory is the peak of the process.
"""

import os
import resource
import sys
import tempfile
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from smarig.diagnosis import diagnose_commanded
from smarig.identification import identify
from smarig.plant import effects_from_pairs
from smarig.record import load_run
from smarig.rig import TwinSettings
from smarig.runner import Session

HIDDEN = ("", "settling", "resistance_phase")
RIG = "two_wire_twin"
LEVELS, REACH_K = 28, 184.0  # of the partition, on each side: 407 steps


def run(quick: bool = False, seed: int = 0) -> dict[str, Any]:
    """Measure times and verdicts of the diagnoses.

    Returns ``{"rig", "results": [{"hidden", "steps", "readings", "seconds", "verdict", "names"}],
    "peak_MB"}``.
    """
    rows = [_row(LEVELS // 2 if quick else LEVELS, hidden, seed) for hidden in HIDDEN]
    return {"rig": RIG, "results": rows, "peak_MB": _peak_MB()}


def _row(levels: int, hidden: str, seed: int) -> dict[str, Any]:
    effects = effects_from_pairs([hidden] if hidden else [])
    with tempfile.TemporaryDirectory() as folder:
        twin = TwinSettings(seed=seed, effects=effects)
        with Session(RIG, twin=twin, wire=f"benchmark {os.getpid()}") as session:
            levels_K = np.linspace(-REACH_K, REACH_K, levels).round(3).tolist()
            path = session.run(
                "first_order_descending", {"partition_K": levels_K}, Path(folder) / "fod.run.sqlite"
            )
        record = load_run(path)
        model = identify([record], "positive").model
        begin = monotonic()
        found = diagnose_commanded(model, [record], seed=seed)
        seconds = monotonic() - begin
    return {
        "hidden": hidden or "nothing",
        "steps": len(found.timeline.settled),
        "readings": sum(len(r) for r in found.timeline.all_readings),
        "seconds": seconds,
        "verdict": found.verdict.word,
        "names": list(found.verdict.names),
    }


def _peak_MB() -> float:
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most / (1 << 20 if sys.platform == "darwin" else 1 << 10)
