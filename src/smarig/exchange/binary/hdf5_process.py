"""Has an HDF5 file read by a child with bounds of time and memory (``hdf5_child.py``), and reads its answers."""

import contextlib
import io
import json
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

import numpy as np

from smarig.core import Array, DataError, UsageError, printable
from smarig.exchange.tables.found_table import FoundColumn

LONGEST_S = 300
_CHILD = Path(__file__).with_name("hdf5_child.py")
_LEADING_ELSEWHERE = (
    "HDF5_PLUGIN_PATH",
    "HDF5_DRIVER",
    "HDF5_VOL_CONNECTOR",
    "HDF5_EXTFILE_PREFIX",
    "HDF5_VDS_PREFIX",
)
_NO_PLUGINS = {"HDF5_PLUGIN_PRELOAD": "::"}  # the library's own word for it
_Process = subprocess.Popen[bytes]


@dataclass
class Hdf5Group:
    """A group: path, attributes, columns of one length, and data sets that are no columns, with the reason; ``scalars``
    are its single numbers with their units, ``starts`` the zeros of its clocks as they are written, by column.
    """

    name: str
    header: dict[str, str]
    left_out: dict[str, str]
    columns: list[FoundColumn] = field(default_factory=list)
    scalars: dict[str, tuple[float, str]] = field(default_factory=dict)
    starts: dict[str, str] = field(default_factory=dict)


def read_groups(path: Path, group: str = "") -> list[Hdf5Group]:
    """All groups of a file, or one. DataError for a file that is damaged, too large, or not complete in itself."""
    process = started(path, group)
    late = threading.Timer(LONGEST_S, process.kill)
    late.start()
    try:
        with process.stdout or io.BytesIO() as output:
            return list(_groups(path, output))
    finally:
        process.kill()  # it has sent all, or what follows is not wanted
        late.cancel()
        process.wait()


def started(path: Path, group: str) -> _Process:
    """The child, before its first answer. ``-P``: no file of the working folder is imported as a module."""
    environment = {key: value for key, value in os.environ.items() if key not in _LEADING_ELSEWHERE}
    try:
        return subprocess.Popen(
            [sys.executable, "-P", "-W", "ignore", str(_CHILD), str(path), group],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment | _NO_PLUGINS,
        )
    except OSError as error:
        raise UsageError(f"{path} cannot be read: no process can be started ({error.strerror}).") from None


def _groups(path: Path, output: IO[bytes]) -> Iterator[Hdf5Group]:
    group: Hdf5Group | None = None
    for words in _answers(output):
        if "refused" in words:
            raise DataError(printable(f"{path}: {words['refused']}"))
        if "damaged" in words:
            raise DataError(
                f"{path} is no HDF5 file, or is damaged or cut off ({words['damaged']}). Copy it again."
            )
        if group is not None and "column" in words:
            values = _values(output, words["size"])
            group.starts |= {words["column"]: words["start"]} if words["start"] else {}
            group.columns.append(
                FoundColumn(words["column"], words["unit"], values, comment=words["comment"])
            )
        elif group is not None:
            yield group
        if "end" in words:
            return
        if "group" in words:
            scalars = {name: (value, unit) for name, (value, unit) in words["scalars"].items()}
            group = Hdf5Group(words["group"], words["header"], words["left_out"], scalars=scalars)
    raise DataError(
        f"{path} is damaged: the HDF5 library failed on it, or needed too much memory or time. Copy it again."
    )


def _answers(output: IO[bytes]) -> Iterator[dict[str, Any]]:
    """The answers until the child ends; one that is not complete is none."""
    while (line := output.readline()).endswith(b"\n"):
        with contextlib.suppress(ValueError):
            yield json.loads(line)


def _values(output: IO[bytes], size: int) -> Array:
    """The values that follow a column, NaN where the child has ended before."""
    values = np.full(size, np.nan)
    given = output.read(8 * size)
    values[: len(given) // 8] = np.frombuffer(given[: len(given) // 8 * 8])
    return values
