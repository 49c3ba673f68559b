"""Helpers for tests of records: samples that carry their own tick, and waiting for a condition."""

import contextlib
import sqlite3
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from smarig.core.command import StepResult, StepVerdict
from smarig.core.sample import NAN, Sample

META = {
    "rig": "bench",
    "protocol": "wiping_out",
    "source": "twin",
    "output": {"unit": "mm"},
    "input": {"unit": "K"},
}


def sample(tick: int, **changes: float) -> Sample:
    """A sample whose every number follows from its tick; no temperature sensor."""
    whole = Sample(tick, tick / 10, 0.5, 0.5 + tick / 1000, 2.4, NAN, 7 * tick, tick * 0.047, 22.0, 0)
    return whole._replace(**changes)


def result(index: int, verdict: StepVerdict = StepVerdict.SETTLED) -> StepResult:
    """A finished step."""
    return StepResult(index, verdict, 1.5 + index, 32.0, 0.1, 250, 10.0 * index, 10.0 * index + 9.9)


def until(condition: Callable[[], bool], patience_s: float = 60.0) -> None:
    """Poll a condition; the time-out only ends a test that has already failed."""
    end = time.monotonic() + patience_s
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"waited {patience_s:g} s in vain")


def beside(path: Path) -> list[str]:
    """Names of the files in the folder of a file."""
    return sorted(p.name for p in path.parent.iterdir() if p.is_file())


def unhash(path: Path) -> None:
    """Remove the hashes of a closed run."""
    with edited(path):
        pass


@contextlib.contextmanager
def edited(path: Path) -> Iterator[sqlite3.Connection]:
    """The database of a closed run, to be changed as a foreign program might; its hashes are removed."""
    with contextlib.closing(sqlite3.connect(path)) as db, db:
        db.execute("DELETE FROM run WHERE key = 'hashes'")
        db.execute("UPDATE run SET value = json_remove(value, '$.hashed') WHERE key = 'end'")
        yield db
