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
KILLS = 20 if LONG else 3
LEASE_S, SPEED = 2.0, 10.0
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
        last_s, fired = box.wire.box._last_request_s, box.wire.box.fired
        assert fired == 0
        assert box.wire.box.dac_V[0] > 1.0
        until(lambda: box.wire.box.dac_V[0] == 0.0)
        took_s = box.wire.box._last_request_s - last_s  # it is set to the moment of the watchdog's action
        assert LEASE_S < took_s <= LEASE_S + 0.5 * box.wire.file.period_s
        until(lambda: box.wire.current_A == 0.0)


def until(holds):
    end_s = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < end_s
        time.sleep(0.005)
