"""Memory that tests have freed is returned to the system, so that a worker is as large as what it uses.

Figures and diagnoses leave cycles of large arrays, which Python collects late, and holes between small objects, which
glibc keeps.
"""

import ctypes
import gc
import linecache
import os
from pathlib import Path

STATM = Path("/proc/self/statm")
GROWTH_BYTES = 32 << 20


class ReturnedMemory:
    """``after_test`` collects and trims when the process has grown by ``GROWTH_BYTES`` since it last did."""

    def __init__(self) -> None:
        self._trim = _malloc_trim()
        self._resident = 0

    def before_collection(self) -> None:
        """Importing modules and making tests leaves little to collect."""
        gc.disable()

    def after_collection(self) -> None:
        """Modules and tests stay until the end: no later collection visits them. Their source is read again."""
        linecache.clearcache()
        self._return()
        gc.freeze()
        gc.enable()

    def after_test(self) -> None:
        """Nothing on a system without /proc."""
        if STATM.exists() and resident_bytes() > self._resident + GROWTH_BYTES:
            self._return()

    def _return(self) -> None:
        gc.collect()
        if self._trim is not None:
            self._trim(0)
        self._resident = resident_bytes() if STATM.exists() else 0


def resident_bytes() -> int:
    """Memory of this process that is not swapped out."""
    return int(STATM.read_bytes().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def _malloc_trim():
    """The function of glibc that returns free memory, None elsewhere."""
    try:
        return ctypes.CDLL(None).malloc_trim
    except (AttributeError, TypeError, OSError):
        return None
