"""kill -9 of a host that drives the firmware on emulated chips: the lease ends the current, counted in their ticks."""

import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from firmware.codes import LEASE, TRIPPED
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
TIMEOUT_S = 5.0  # of a reply: a busy machine takes its time


@pytest.mark.parametrize(
    "start", [pytest.param("avr", marks=pytest.mark.long("takes five seconds")), "cortex_m"], indirect=True
)
def test_the_lease_ends_the_current(start, tmp_path):
    chips = Chips(tmp_path, start, timeout_s=TIMEOUT_S)
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
    assert (
        0 < flowed.size <= chips.lease_ticks + SLACK
    )  # less if a busy machine kept the host waiting before its death
    assert flowed[-1] == flowed.size - 1, "it ends once"
    chips.amplifier.ask(b"", lambda _: False, patience_s=0.2)  # the reply that the host did not read
    assert [chips.amplifier.line(f"r {at} 1").words[0] for at in ("0", "9")] == [TRIPPED, LEASE]


def until(holds, host=None):
    end_s = time.monotonic() + PATIENCE_S
    while not holds():
        assert host is None or host.poll() is None
        assert time.monotonic() < end_s
        time.sleep(0.005)
