"""Checks that the result of a cell is safe and clear, and returns each violation as a sentence."""

from collections.abc import Iterator

import numpy as np

from rig.bench.broken_rig import protocol
from rig.bench.fault_cell import FaultResult
from rig.bench.fault_table import Cell
from rig.bench.moments import sound
from smarig.core.sample import Quality
from smarig.record import Run, load_run

BOUND_S = 240.0  # of the wall's: nothing hangs, however busy the machine is
LAG_TICKS = (
    12  # in real time, 0.3 s of the wall's: a sample reaches the host after its tick, and feeding follows
)
RESULTS = ("tick", "step", "current_command_A", "current_A", "voltage_V", "counts", "input")


def faulty(cell: Cell, result: FaultResult) -> list[str]:
    """What is wrong with it; nothing in a safe cell."""
    run = load_run(result.run) if result.run.exists() else None
    found = [*_sentence(cell, result), *_zero(cell, result, run), *_record(cell, result, run)]
    if run is not None and cell.fault.same_data:
        found += _same(cell, run)
    if result.wall_s > BOUND_S:
        found.append(f"it took {result.wall_s:.0f} s")
    return found


def sentences(result: FaultResult) -> list[str]:
    """What the person reads of errors."""
    return [
        line.removeprefix("smarig: ") for line in result.stderr.splitlines() if line.startswith("smarig: ")
    ]


def _sentence(cell: Cell, result: FaultResult) -> Iterator[str]:
    if "Traceback" in result.stderr:
        yield f"a traceback: {result.stderr}"
    matches = sentences(result)
    known = [o for o in cell.outcomes if o.status == result.status]
    if not known:
        yield f"exit status {result.status}: {result.stderr}"
    elif len(matches) != bool(known[0].reads):
        yield f"{len(matches)} sentences: {result.stderr}"
    elif matches and not known[0].matches(matches[0]):
        yield f"another sentence: {matches[0]}"


def _zero(cell: Cell, result: FaultResult, run: Run | None) -> Iterator[str]:
    """0 A within lease + 1 tick: of the fault, or of the last sample where the host keeps control until it notices."""
    tick, output_uA = result.trace.T
    if not tick.size or output_uA[-1]:
        yield "current flows at the end of the trace, or there is none"
        return
    since = (
        result.began
        if cell.fault.loses_control and result.status
        else int(run["tick"][-1])
        if run and len(run)
        else 0
    )
    since += LAG_TICKS if cell.fault.real_time else 0
    flowing = tick[output_uA != 0]
    if flowing.size and flowing[-1] > since + result.lease_ticks + 1:
        yield f"current until tick {flowing[-1]:.0f}, control until {since}, lease of {result.lease_ticks} ticks"


def _record(cell: Cell, result: FaultResult, run: Run | None) -> Iterator[str]:
    if run is None:
        if cell.phase != "opening" or not result.status:
            yield "no run file"
        return
    if not run.complete:
        yield f"the run was not closed: {run.cause}"
    matches = sentences(result)
    if run.cause == "done":
        if matches and not matches[0].endswith("are complete."):
            yield f"done, says the run, but the person reads: {matches[0]}"
    elif not matches:
        yield f"the run ended with '{run.cause}', and nobody says so"
    elif not _same_cause(run.cause, matches[0]):
        yield f"the run says '{run.cause}', the person reads '{matches[0]}'"


def _same_cause(cause: str, sentence: str) -> bool:
    """The person may read more than the run keeps, not something else."""
    kind, _, text = cause.partition(": ")
    return sentence.startswith(text) if kind == "stopped" else (text or kind) in sentence


def _same(cell: Cell, run: Run) -> Iterator[str]:
    true = sound(protocol(cell.phase))[1]
    for name in RESULTS:
        if not np.array_equal(run[name], true[name], equal_nan=True):
            yield f"{name} is not that of a sound run"
    retried = (run["quality"].astype(int) & int(Quality.RETRIED)) > 0
    outlasted = cell.link == "rfc2217"  # its time-out exceeds the delay of replies
    if cell.fault.retries and not outlasted and cell.phase not in ("zeroing", "end") and not retried.any():
        yield "no sample is marked as retried"
