"""A host on the Uno under simavr: both roles on one port; kill -9, after which the lease ends the current.

One kill by default, twenty with ``SMARIG_LONG=1``. All times are device times.
"""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from firmware.test_uno_trips import MEASURE_MS, TICK_MS, NO_CURRENT_uA
from firmware.uno_emulator import PATIENCE_S
from firmware.uno_twin import host_rig
from smarig.config import load_rig
from smarig.plant import Actuator
from smarig.rig import TwinSettings
from smarig.rig.open_rig import open_rig

LONG = bool(os.environ.get("SMARIG_LONG"))
KILLS = 20 if LONG else 1
APART_MS = 137  # from one moment of a kill to the next: another phase of tick and exchange
FOLLOWS = ("--speed", "0", "--wait", "110")  # device time waits for a host, so a busy machine makes none late
SIMULATOR = "{ start = false, speed = 200.0 }"
LEASE_MS = 1000


def test_both_roles_on_one_port(uno, tmp_path):
    board = uno(*FOLLOWS)
    rig = str(host_rig(tmp_path, board.path, simulator=SIMULATOR))
    file = load_rig(rig)
    with open_rig(rig, file, Actuator.named(file.actuator), TwinSettings()) as bench:
        samples = [s for _ in range(12) for s in bench.step(0.3)]
    assert all(np.diff([s.tick for s in samples]) == 1)
    assert abs(samples[-1].current_A - 0.3) < 0.003
    assert abs(samples[-1].counts - 1005) < 10
    board.go(200)
    assert board.now()[1] < NO_CURRENT_uA


def killed_host(board, rig, out, after_ms):
    """A run that is killed so long after its current began to flow."""
    command = [sys.executable, "-m", "smarig", "run", "step_currents", "--rig", str(rig), "-o", str(out)]
    host = subprocess.Popen(
        [*command, "--set", "currents_A=0.4,0.5", "--force"],
        stdout=subprocess.DEVNULL,
        start_new_session=True,
    )
    began_ms, end_s = 0, time.monotonic() + PATIENCE_S
    while not began_ms or board.now()[0] < began_ms + after_ms:
        ms, current_uA = board.now()
        began_ms = began_ms or (ms if current_uA > NO_CURRENT_uA else 0)
        assert time.monotonic() < end_s
        assert host.poll() is None
        time.sleep(0.002)
    os.killpg(host.pid, signal.SIGKILL)
    host.wait()


@pytest.mark.parametrize("kills", [KILLS])
def test_a_killed_host_costs_the_lease(kills, uno, tmp_path):
    board = uno(*FOLLOWS)
    rig = host_rig(tmp_path, board.path, simulator=SIMULATOR)
    ends_ms = []
    for k in range(kills):
        killed_host(board, rig, tmp_path / "killed.run.sqlite", 300 + APART_MS * k)
        board.go(2 * LEASE_MS)
        ms, current_uA = board.now()
        assert current_uA < NO_CURRENT_uA
        ends_ms.append(ms)
    trace = board.close()
    for end_ms in ends_ms:
        before = trace.ms <= end_ms
        last_byte_ms = trace.last_byte_ms[before][-1]
        flowed_ms = trace.ms[before][trace.mean_uA[before] > NO_CURRENT_uA][-1] - last_byte_ms
        print(f"current {flowed_ms:.0f} ms after the last byte of the host")
        assert 0 < flowed_ms <= LEASE_MS + TICK_MS + MEASURE_MS
