"""A protocol that the real drivers run on emulated chips with the twin's wire between them: it settles where the twin's
does, in counts."""

import numpy as np
import pytest

from rig.bench.wired_chips import PERIOD_S, Chips
from smarig.cli import run as cli
from smarig.config import load_rig
from smarig.plant import Actuator
from smarig.record import load_run

CURRENTS = "currents_A=0.5,0.9,0.6"
pytestmark = pytest.mark.long("real time on chips")
WINDOW, MOVED = 50, 100  # ticks of a settled position; counts
RMS_counts, LARGEST_counts = 1.0, 2.0


def settled(rig, period_s, out):
    """Settled positions, in counts from the first of them."""
    chosen = (CURRENTS, f"settle.window_s={WINDOW * period_s:g}", "settle.approach_K=0.3")
    words = [word for pair in chosen for word in ("--set", pair)]
    assert cli(["run", "step_currents", *words, "--rig", str(rig), "-o", str(out), "--quiet"]) == 0
    steps = np.array([step.position for step in load_run(out).steps if step.position is not None])
    file = load_rig("one_wire_twin")
    per_count = Actuator.named(file.actuator).position_per_count(file.encoder.counts_per_rev)
    return (steps - steps[0]) / per_count


def test_positions_settle_where_the_twins_do(start, tmp_path):
    chips = Chips(tmp_path, start, timeout_s=5.0)
    found = settled(chips.rig, chips.period_s, tmp_path / "chips.run.sqlite")
    expected = settled("one_wire_twin", PERIOD_S, tmp_path / "twin.run.sqlite")
    rms = float(np.sqrt(np.mean(np.square(found - expected))))
    print(f"{len(found)} steps over {np.ptp(expected):.0f} counts: rms {rms:.2f}")
    assert np.ptp(expected) > MOVED, "it moves"
    assert rms <= RMS_counts
    assert np.max(np.abs(found - expected)) <= LARGEST_counts
