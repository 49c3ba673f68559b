"""The whole life of a run file, in a process of its own: created, recorded, closed, resumed, closed again.

Each thing that the recorder promises is told at once: what a commit has returned for, and what its last message says.
Every commit is awaited, so the calls of the file system are the same in each life.
"""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from record.runs import META, result, sample
from smarig.core import StorageError
from smarig.record import Continuation, Recorder, recorder, schema

Tell = Callable[..., None]
ROWS = 25  # of a batch
PATIENCE_S = 0.2  # until a disk is taken to be slow
BATCHES = 4  # before the run is closed, and half as many after
DESCRIPTION = {**META, "source": "bench", "config": "# a rig file\n" * 500}


def hurry() -> None:
    """The recorder's limits of seconds as fractions of one, and its intervals such that only steps commit."""
    recorder.STALL_S, recorder.CLOSE_LIMIT_S, recorder.RESUMED_S = 0.25, 0.25, 0.02
    recorder.COMMIT_INTERVAL_S = 60.0
    schema.WAL_PAGES = 8


def live(path: Path, tell: Tell) -> None:
    """Live, and tell in this order, unless a fault comes between.

    ("created",), ("given", ticks, steps), ("stored", ticks, steps), ("closed",), ("resuming",); ("said", message).
    """
    write_batch = Recorder._write_batch

    def telling(self: Recorder, rows: list[tuple], statements: list[tuple[str, tuple]]) -> Any:
        rejected = write_batch(self, rows, statements)
        tell("stored", [r[0] for r in rows], [row[0] for sql, row in statements if sql == schema.INSERT_STEP])
        return rejected

    Recorder._write_batch = telling
    hurry()
    try:
        own = Recorder(path, DESCRIPTION)
        tell("created")
        if not _recorded(own, range(BATCHES), tell):
            return
        tell("resuming")
        own = Recorder(path, {"notes": "resumed"}, continuation=Continuation())
        _recorded(own, range(BATCHES, BATCHES + BATCHES // 2), tell)
    except StorageError as error:
        tell("said", str(error))


def _recorded(own: Recorder, batches: range, tell: Tell) -> bool:
    """Whether these batches were recorded and the run was closed."""
    ended = "done"
    try:
        for batch in batches:
            _give(own, batch, tell)
    except StorageError as error:
        tell("said", str(error))
        ended = "stopped"
    try:
        own.close(ended, t_s=batches.stop * ROWS / 10)
    except StorageError as error:
        tell("said", str(error))
        return False
    tell("closed")
    return ended == "done"


def _give(own: Recorder, batch: int, tell: Tell) -> None:
    ticks = range(batch * ROWS, (batch + 1) * ROWS)
    tell("given", [*ticks], [batch])
    for tick in ticks:
        own.sample(sample(tick), batch, 0.0)
    own.event(ticks[-1] / 10, "mark", f"batch {batch}")
    own.describe("seed", batch)
    own.step(result(batch), branch="rise", target=1.0)
    _await(own, own._stored, ticks[-1])


def _await(own: Recorder, before: object, tick: int) -> None:
    """Until the batch is stored; if that takes long, samples go on, of which one is refused."""
    started = time.monotonic()
    while own._stored is before:
        time.sleep(0.001)
        if own._failure is not None or time.monotonic() - started > PATIENCE_S:
            tick += 1
            own.sample(sample(10_000 * tick), None, 0.0)
