"""The kinds of faults that the faulty disk knows, and where a run of it is found."""

import ctypes
import functools
import os
import shutil
import subprocess
from pathlib import Path

HERE = Path(__file__).resolve().parent
NONE, READ_ONLY = 0, 11
LIVE = {  # numbers as in faulty_disk.c
    "one error": 1,
    "errors from here on": 2,
    "one refusal for lack of space": 3,
    "a full disk": 4,
    "a short write": 5,
    "a short write, then a full disk": 6,
    "a disk that hangs": 7,
    "killed before the call": 8,
    "killed after the call": 9,
    "killed half way through a write": 10,
}
THEN_CUT = {  # a fault during the life, and a power cut after it
    "one error, then a power cut": 1,
    "a full disk, then a power cut": 4,
}
KILLS = tuple(kind for kind in LIVE if kind.startswith("killed"))
CUTS = (
    "a power cut: what was synced",
    "a power cut: some pages too",
    "a power cut: torn pages",
    "a power cut: all",
)


def built(folder: Path) -> Path:
    """The faulty disk, compiled."""
    library = folder / "faulty_disk.so"
    command = ["gcc", "-shared", "-fPIC", "-O1", "-o", library, HERE / "faulty_disk.c"]
    subprocess.run(command, check=True)
    return library


def missing() -> str:
    """Why there can be no faulty disk here; "" if there can be one."""
    if os.name != "posix" or not Path("/proc/self").exists():
        return "needs Linux for a disk that fails"
    return "" if shutil.which("gcc") else "needs gcc for a disk that fails"


@functools.cache
def disk() -> ctypes.CDLL:
    """The functions of the faulty disk, in a process that was started with it."""
    library = ctypes.CDLL(None)
    library.fault_arm.argtypes = [ctypes.c_char_p, ctypes.c_long, ctypes.c_int, ctypes.c_int]
    library.fault_note.argtypes = [ctypes.c_char_p]
    library.fault_count.restype = ctypes.c_long
    return library
