"""Protocols on the Uno under simavr, coupled to the twin's wire: the same settled positions as in the twin, in counts.

``SMARIG_LONG=1`` makes a whole quick look, with a wire ten times as quick as the twin's: some minutes of device time.
By default three currents are held, briefly, with a wire twenty times as quick.
"""

import os

import numpy as np
import pytest

from firmware.uno_twin import OPTIONS, TwinWire, host_rig, twin_rig
from rig.bench.wired_chips import quick_actuator
from smarig.cli import run as cli
from smarig.plant import Actuator
from smarig.record import load_run

LONG = bool(os.environ.get("SMARIG_LONG"))
QUICKER = 10 if LONG else 20
BRIEF = ("currents_A=0.5,0.9,0.6", "settle.window_s=1", "settle.approach_K=2")
WORK = ("quick_look",) if LONG else ("step_currents", *(word for pair in BRIEF for word in ("--set", pair)))
SIMULATOR = "{ start = false, speed = 200.0 }"
RMS_counts, LARGEST_counts = 1.0, 3.0


def settled_counts(path):
    """Settled positions of all steps of a run, in counts of the AS5600 from the first of them."""
    steps = [step.position for step in load_run(path).steps if step.position is not None]
    per_count = Actuator.named("gorbet_one_wire").position_per_count(4096)
    return (np.array(steps) - steps[0]) / per_count


@pytest.fixture
def runs(uno, tmp_path):
    """Run files of the same work on the board and in the twin, in pairs."""
    actuator = quick_actuator(tmp_path, QUICKER)
    board = uno(*OPTIONS, wire=TwinWire(actuator))
    rigs = {
        "uno": host_rig(tmp_path, board.path, simulator=SIMULATOR, actuator=f'"{actuator}"'),
        "twin": twin_rig(tmp_path, actuator),
    }
    for name, rig in rigs.items():
        out = tmp_path / (name if LONG else f"{name}.run.sqlite")
        assert cli(["run", *WORK, "--rig", str(rig), "-o", str(out), "--quiet"]) == 0
    made = {
        name: sorted(tmp_path.glob(f"{name}/*.run.sqlite" if LONG else f"{name}.run.sqlite")) for name in rigs
    }
    return list(zip(made["uno"], made["twin"], strict=True))


@pytest.mark.long("takes twenty seconds")
def test_positions_settle_where_the_twins_do(runs):
    differences, moved = [], 0.0
    for on_board, in_twin in runs:
        found, expected = settled_counts(on_board), settled_counts(in_twin)
        assert len(found) == len(expected)
        differences += list(found - expected)
        moved = max(moved, float(np.ptp(expected)))
    rms = float(np.sqrt(np.mean(np.square(differences))))
    print(
        f"{len(differences)} steps over {moved:.0f} counts: rms {rms:.2f}, largest {np.max(np.abs(differences)):.2f}"
    )
    assert moved > 100, "it moves"
    assert rms <= RMS_counts
    assert np.max(np.abs(differences)) <= LARGEST_counts
