"""Executes one cell of the fault table: a whole run on simulated devices with that fault, and its observed
result."""

import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from rig.bench.broken_rig import REAL_TIME, lease_s, protocol, rig_file
from rig.bench.fault_table import Cell
from rig.bench.moments import Moment, sound
from rig.bench.wiring import Relays, exchanged, other_firmware, rewired
from smarig.cli import run as cli

PERIOD_S = 0.1
SENSOR_TIMEOUT_S = 300.0  # of the wall's: a hang, not a slow machine
HOST = Path(__file__).with_name("hurt_host.py")


class FaultResult(NamedTuple):
    """Of one run: exit status, stderr, the run file, the wire's history, the tick when it began, wall time."""

    status: int
    stderr: str
    run: Path
    trace: np.ndarray  # tick, output_uA
    began: int
    lease_ticks: int
    wall_s: float


def perform(
    cell: Cell, folder: Path, capsys: pytest.CaptureFixture, patch: pytest.MonkeyPatch
) -> FaultResult:
    """In this process, or in one of its own where the host itself is what suffers."""
    fault = cell.fault
    what = protocol(cell.phase, real_time=fault.real_time)
    moment = sound(what)[0][cell.phase]
    began = (
        max(getattr(moment, f["device"]).tick for f in fault.simulated)
        if fault.simulated
        else moment.encoder_daq.tick
    )
    capsys.readouterr()
    rig = rig_file(folder, cell.link, list(_simulated(cell, moment)), real_time=fault.real_time)
    name, *pairs = what
    out = folder / "r.run.sqlite"
    arguments = ["run", name, "--rig", str(rig), "-o", str(out), "--quiet"]
    arguments += [word for pair in pairs for word in ("--set", pair)]
    begun_s = time.monotonic()
    if fault.host:
        status, stderr = _in_a_process(fault.host, began, arguments)
    else:
        status, stderr = _in_this_process(cell, arguments, folder, capsys, patch)
    wall_s = time.monotonic() - begun_s
    trace = np.loadtxt(folder / "trace.csv", delimiter=",", skiprows=1, usecols=(0, 2), ndmin=2)
    lease_ticks = round(lease_s(fault.real_time) / PERIOD_S)
    return FaultResult(status, stderr, out, trace, began, lease_ticks, wall_s)


def _simulated(cell: Cell, moment: Moment):
    """The simulator's faults, each with its beginning."""
    for fault in cell.fault.simulated:
        from_s = round(moment.encoder_daq.tick * PERIOD_S, 6)
        if cell.fault.by_time or cell.fault.real_time:
            begin = {"from_s": from_s}
        else:
            begin = {"from_exchange": getattr(moment, fault["device"]).number}
        if cell.fault.lasts_s:
            begin["to_s"] = from_s + cell.fault.lasts_s
        yield {**fault, **begin}


def _in_a_process(trouble: str, tick: int, arguments: list[str]) -> tuple[int, str]:
    command = [sys.executable, str(HOST), trouble, str(tick), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=SENSOR_TIMEOUT_S, check=False)
    return done.returncode, done.stderr


def _in_this_process(
    cell: Cell, arguments: list[str], folder: Path, capsys: pytest.CaptureFixture, patch: pytest.MonkeyPatch
) -> tuple[int, str]:
    relays = Relays(cell.link) if cell.link in ("socket", "rfc2217") else None
    if cell.fault.wiring == "other firmware":
        other_firmware(patch, folder)
    how = exchanged if cell.fault.wiring == "exchanged" else relays or (lambda urls: urls)
    try:
        with rewired(patch, how):
            status = cli(arguments)
    finally:
        if relays:
            relays.close()
    return status, capsys.readouterr().err


__all__ = ["REAL_TIME", "SENSOR_TIMEOUT_S", "FaultResult", "perform"]
