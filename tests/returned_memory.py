"""Memory that tests have freed is returned to the system, so that a worker is as large as what it uses.

Figures and diagnoses leave cycles of large arrays, which Python collects late, and holes between small objects, which
glibc keeps. Arrays from ``MAPPED_BYTES`` on have mappings of their own: without a limit, glibc would learn from the
first large array that is freed to put the next into its heap, where it leaves a hole. Less than ``GROWTH_BYTES``
free at the end of the heap stay there: by default, that limit is so low that the pages of every array are made anew.
One heap serves all threads: each thread of a rig or a console would leave holes in a heap of its own.
"""

import ctypes
import gc
import linecache
import os
from pathlib import Path

STATM = Path("/proc/self/statm")
GROWTH_BYTES = 32 << 20
MAPPED_BYTES = 1 << 20
SELDOM = 20_000  # new objects between two collections
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD, M_ARENA_MAX = -1, -3, -8  # of glibc's malloc.h


class ReturnedMemory:
    """``after_test`` collects and trims when the process has grown by ``GROWTH_BYTES`` since it last did."""

    def __init__(self) -> None:
        self._trim = _of_c_library("malloc_trim")
        self._resident = self._between_files = 0
        self._thresholds = gc.get_threshold()
        if mallopt := _of_c_library("mallopt"):
            mallopt(M_MMAP_THRESHOLD, MAPPED_BYTES)
            mallopt(M_TRIM_THRESHOLD, GROWTH_BYTES)
            mallopt(M_ARENA_MAX, 1)

    def before_collection(self) -> None:
        """Importing modules and making tests leaves little to collect: seldom is enough."""
        gc.set_threshold(SELDOM)

    def after_collection(self) -> None:
        """Modules and tests stay until the end: no later collection visits them. Their source is read again."""
        linecache.clearcache()
        self._return()
        gc.freeze()
        gc.set_threshold(*self._thresholds)

    def after_test(self) -> None:
        """Nothing on a system without /proc."""
        if STATM.exists() and resident_bytes() > self._resident + GROWTH_BYTES:
            self._return()

    def after_file(self) -> None:
        """The same, against what remained after the last file that grew: what the caches of this one held is free."""
        if STATM.exists() and resident_bytes() > self._between_files + GROWTH_BYTES:
            self._return()
            self._between_files = self._resident

    def _return(self) -> None:
        gc.collect()
        if self._trim is not None:
            self._trim(0)
        self._resident = resident_bytes() if STATM.exists() else 0


def resident_bytes() -> int:
    """Memory of this process that is not swapped out."""
    return int(STATM.read_bytes().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def _of_c_library(name: str):
    """A function of glibc, None elsewhere."""
    try:
        return getattr(ctypes.CDLL(None), name)
    except (AttributeError, TypeError, OSError):
        return None
