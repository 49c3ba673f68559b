"""The child that reads HDF5 files, forked from a process that has the library already: a tenth of the time."""

import os
import signal
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from smarig.exchange.binary import hdf5_child


@dataclass
class ForkedChild:
    """What ``hdf5_process`` uses of a child."""

    number: int
    stdout: BinaryIO

    def kill(self) -> None:
        """End it."""
        os.kill(self.number, signal.SIGKILL)

    def wait(self) -> None:
        """Wait for its end."""
        os.waitpid(self.number, 0)


def started(path: Path, group: str) -> ForkedChild:
    """The child of a file, with all of its own limits but a shorter one of time."""
    ask, tell = os.pipe()
    child = os.fork()
    if not child:
        try:
            hdf5_child.CPU_S = 20
            hdf5_child.limit()
            with os.fdopen(tell, "wb") as out:
                hdf5_child.answer(str(path), group, out)
        finally:
            sys.stdout = sys.stderr = None
            os._exit(0)
    os.close(tell)
    return ForkedChild(child, os.fdopen(ask, "rb"))
