"""kill -9 of a host that drives the firmware on emulated chips: the lease ends the current, counted in their ticks."""

import signal
import subprocess
import sys
import time

import numpy as np

from rig.bench.wired_chips import Chips

HOST = """
import sys
from smarig.config import load_rig
from smarig.plant import Actuator
from smarig.rig import TwinSettings
from smarig.rig.open_rig import open_rig
file = load_rig(sys.argv[1])
with open_rig(sys.argv[1], file, Actuator.named(file.actuator), TwinSettings()) as bench:
    while True:
        bench.step(0.5)
"""
LIVES = 10  # ticks with current
SLACK = 3  # a tick under way, one that is not told yet, one of rounding
PATIENCE_S = 60.0


def test_the_lease_ends_the_current(start, tmp_path):
    chips = Chips(tmp_path, start)
    host = subprocess.Popen([sys.executable, "-c", HOST, str(chips.rig)])
    try:
        until(lambda: np.count_nonzero(chips.driven()) > LIVES, host)
    finally:
        host.send_signal(signal.SIGKILL)
        killed_at = chips.driven().size
        host.wait()
    until(lambda: chips.driven().size > killed_at + chips.lease_ticks + 2 * SLACK)
    flowed = np.flatnonzero(chips.driven()[killed_at:])
    print(f"current in {flowed.size} ticks after the death; lease {chips.lease_ticks}")
    assert abs(flowed.size - chips.lease_ticks) <= SLACK
    assert not np.any(chips.driven()[killed_at + chips.lease_ticks + SLACK :])


def until(holds, host=None):
    end_s = time.monotonic() + PATIENCE_S
    while not holds():
        assert host is None or host.poll() is None
        assert time.monotonic() < end_s
        time.sleep(0.005)
