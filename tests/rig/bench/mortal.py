"""A host that is killed during an identification while the devices continue, and the required state
afterwards."""

import csv
import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from rig.bench.wired_chips import PERIOD_S, write_rig
from smarig.device.drivers._conversation import Conversation
from smarig.device.encoding.register import load_register_map
from smarig.device.links.serial_line import TEXT, SerialLine
from smarig.identification.fod_data import fod_data
from smarig.record import Run, load_run

RESUMES_S = 600.0
PATIENCE_S = 60.0
TRIPS = 3
SHORTEST = 0.9  # of the undisturbed run's length: in real time, holds settle a little sooner or later


class SimulatedDevices:
    """Simulated devices in a process of their own, that outlive every host; ``speed`` 0: lock-step."""

    period_s = PERIOD_S

    def __init__(self, folder: Path, speed: float, lease_s: float) -> None:
        self.speed, self.lease_s = speed, lease_s
        self.lease_ticks = round(lease_s / PERIOD_S)
        self._trace = folder / "trace.csv"
        plain = folder / "devices.toml"
        plain.write_text(f'name = "devices"\nbase = "one_wire_twin"\nlease_s = {lease_s}\n')
        command = [sys.executable, "-m", "simulators", "--rig", str(plain), "--framing", "lines"]
        pace = ["--speed", str(speed)] if speed else ["--lock-step", "--gone-after", str(RESUMES_S)]
        self._process = subprocess.Popen(
            [*command, *pace, "--trace", str(self._trace)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        urls = json.loads(self._process.stdout.readline())
        self._daq = urls["encoder_daq"]["url"]
        where = {"amplifier": urls["amplifier"]["url"], "daq": urls["encoder_daq"]["url"]}
        self.rig = write_rig(folder, where, speed, lease_s, PERIOD_S, "gorbet_one_wire")

    def driven(self) -> np.ndarray:
        """The output in every tick so far."""
        if not self._trace.exists():
            return np.empty(0)
        with self._trace.open(newline="") as file:
            return np.array([float(row[2]) for row in csv.reader(file) if len(row) == 6 and row[0] != "tick"])

    def wait(self) -> None:
        """Wait until a lease has expired. In lock-step, time advances by polling the encoder alone."""
        if self.speed:
            time.sleep(2.5 * self.lease_s / self.speed + 0.1)
            return
        line = SerialLine(self._daq, TEXT, PATIENCE_S)
        talk = Conversation(line, load_register_map("encoder_daq"))
        tick = talk.handshake()["tick"]
        for k in range(3 * self.lease_ticks):
            talk.command({"ring_next": tick + 1 + k}, 1)
        line.close()

    def close(self) -> None:
        self._process.stdin.close()
        self._process.wait(PATIENCE_S)
        self._process.stdout.close()


def protocol(devices) -> list[str]:
    """A short identification: three levels."""
    settle = [f"settle.window_s={50 * devices.period_s:g}", "settle.approach_K=0.3"]
    settings = [word for pair in ("partition_K=0,80,160", *settle) for word in ("--set", pair)]
    return ["first_order_descending", *settings]


def host(*arguments: str) -> subprocess.Popen:
    command = [sys.executable, "-m", "smarig", *arguments, "--quiet"]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def undisturbed(devices, out: Path) -> Run:
    """An uninterrupted run."""
    done = host("run", *protocol(devices), "--rig", str(devices.rig), "-o", str(out))
    _, err = done.communicate(timeout=RESUMES_S)
    assert done.returncode == 0, err
    return load_run(out)


def killed_and_resumed(devices, whole: Run, share: float, out: Path) -> Run:
    """The run that was killed after a share of it and resumed; its output was off within the lease meanwhile."""
    run = host("run", *protocol(devices), "--rig", str(devices.rig), "-o", str(out))
    begin = 0
    if devices.speed:  # in real time, the devices have run for a while before a run starts
        _until(out.exists, run)
        begin = devices.driven().size
    _until(lambda: devices.driven().size > begin + share * SHORTEST * len(whole), run)
    run.send_signal(signal.SIGKILL)
    killed_at = devices.driven().size
    run.communicate()
    committed = _committed(out)
    devices.wait()
    slack = 3  # a tick under way, one of the trace, one of rounding
    late = devices.driven()[killed_at + devices.lease_ticks + slack :]
    assert late.size, "time went on"
    assert not np.any(late), "the output is off"
    _resume(devices, out)
    resumed = load_run(out)
    assert committed <= set(resumed["tick"].astype(int).tolist()), "no committed sample is lost"
    return resumed


def same_table(resumed: Run, whole: Run) -> None:
    """Complete, and equal within a count."""
    assert resumed.cause == "done"
    one, other = fod_data(whole), fod_data(resumed)
    np.testing.assert_array_equal(one.alpha, other.alpha)
    np.testing.assert_array_equal(one.beta, other.beta)
    assert np.abs(one.y - other.y).max() <= float(whole.meta["output"]["per_count"])


def _resume(devices, out: Path) -> None:
    """To its end; on a busy machine, a tenth of a second's lease may run out on the way, which is resumed as well."""
    for _ in range(TRIPS + 1):
        again = host("resume", str(out), "--rig", str(devices.rig))
        said, err = again.communicate(timeout=RESUMES_S)
        if again.returncode != 3 or "switched its output off: lease" not in err:
            break
    assert again.returncode == 0, f"{said}\n{err}"


def _until(holds, run: subprocess.Popen) -> None:
    """While the host lives."""
    while not holds():
        assert run.poll() is None, run.communicate()
        time.sleep(0.005)


def _committed(out: Path) -> set[int]:
    try:
        return set(load_run(out)["tick"].astype(int).tolist())
    except Exception:
        return set()  # killed before the file was one
