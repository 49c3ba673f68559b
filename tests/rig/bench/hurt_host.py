"""``python hurt_host.py TROUBLE TICK smarig-arguments…``: the command line with one failure of the host at a
tick.

It runs in its own process, so signals, exit status and stderr are those that a user gets. TICK 0 is the time
in which the devices are opened.
"""

import os
import shutil
import signal
import sys
import time

from smarig.cli import main
from smarig.device.drivers._conversation import Conversation
from smarig.record import recorder
from smarig.running import RunStatus


def _stall(wall_s: str) -> None:
    time.sleep(float(wall_s))


def _signal(name: str) -> None:
    os.kill(os.getpid(), getattr(signal, name))


def _full_disk(_: str) -> None:
    full = type("Usage", (), {"free": 1000})()
    shutil.disk_usage = lambda _: full
    recorder.COMMIT_INTERVAL_S = 0.001


def _listener(_: str) -> None:
    raise RuntimeError("viewer bug")


TROUBLES = {"stall": _stall, "signal": _signal, "full_disk": _full_disk, "listener": _listener}


def inject_host_fault(trouble: str, tick: int) -> None:
    """Let it happen once."""
    kind, _, more = trouble.partition(":")
    left = [lambda: TROUBLES[kind](more)]
    sample, handshake = RunStatus.sample, Conversation.handshake

    def watched(self, s, step, input_value):
        if left and s.tick >= tick:
            left.pop()()
        sample(self, s, step, input_value)

    def opening(self):
        if left:
            left.pop()()
        return handshake(self)

    if tick:
        RunStatus.sample = watched
    else:
        Conversation.handshake = opening


if __name__ == "__main__":
    inject_host_fault(sys.argv[1], int(sys.argv[2]))
    main(sys.argv[3:])
