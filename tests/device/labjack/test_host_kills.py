"""A host that is killed at any moment: the box sets its DAC to 0 V within its watchdog.

The box's own time is compared: two seconds of the watchdog, one step of its clock, and a host that was on at the end.
"""

import os
import random
import subprocess
import sys
import time
from pathlib import Path

import pytest

from device.labjack.boxes import running_box

LONG = bool(os.environ.get("SMARIG_LONG"))
KILLS = 20 if LONG else 2
LEASE_S, SPEED = 2.0, 10.0
OBSERVING_S = 2.0  # of the box: this process may be late by a fifth of a second
PATIENCE_S = 30.0  # of the clock


@pytest.mark.parametrize("kill", range(KILLS))
def test_a_killed_host_leaves_no_current(kill):
    moment = random.Random(kill)
    with running_box(speed=SPEED) as box:
        tests = str(Path(__file__).parents[2])
        host = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name("host_of_a_box.py")), box.url],
            env={**os.environ, "PYTHONPATH": os.pathsep.join([tests, *sys.path])},
        )
        try:
            until(lambda: box.wire.box.dac_V[0] > 1.0)
            time.sleep(moment.uniform(0.0, 0.3))
        finally:
            host.kill()
            host.wait()
        if box.wire.box.fired:
            pytest.skip("This machine is too busy: the host paused for longer than the watchdog.")
        killed_s = box.now_s()
        until(lambda: box.wire.box.dac_V[0] == 0.0)
        assert LEASE_S < box.wire.box.silent_s <= LEASE_S + 0.5 * box.wire.file.period_s
        assert box.now_s() - killed_s < LEASE_S + OBSERVING_S
        until(lambda: box.wire.current_A == 0.0)


def until(holds):
    end_s = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < end_s
        time.sleep(0.005)
