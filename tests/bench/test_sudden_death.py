"""kill -9 of the host, in the middle of an identification, with devices that live on: the lease ends the current,
no committed sample is lost, ``resume`` finishes, and the table is that of a run that nobody killed.

Five moments in lock-step, where time stands still until the host is missed for a second; with ``SMARIG_KILLS`` (the
long campaign: 100) so many in real time × 20. Moments are spread evenly over the run.
"""

import csv
import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from smarig.identification.fod_data import fod_data
from smarig.record import load_run

KILLS = int(os.environ.get("SMARIG_KILLS", "5"))
SPEED = 20.0 if "SMARIG_KILLS" in os.environ else 0.0
LEASE_S = 2.0 if SPEED else 0.5  # of the device's time: a tenth of a second of ours in real time
MISSED_S = 1.0  # until devices in lock-step let time run
PROTOCOL = ["first_order_descending", "--set", "partition_K=0,80,160"]
SETTLE = ["--set", "settle.window_s=5", "--set", "settle.approach_K=0.3"]
RIG = """
name = "mortal"
simulator = {{ start = false, speed = {speed} }}
base = "one_wire_twin"
kind = "bench"
wire = "{wire}"
lease_s = {lease}
links.amplifier = {{ driver = "smarig_amplifier", framing = "lines", url = "{amplifier}" }}
links.encoder_daq = {{ driver = "smarig_encoder_daq", framing = "lines", url = "{daq}" }}
protection.slew_max_A_per_s = 25.0
protection.resistance_min_ohm = 1.0
protection.resistance_max_ohm = 20.0
protection.heat_max_A2s = 20.0
protection.heat_settle_s = 10.0
"""


class Devices:
    """Simulated devices in a process of their own, that outlive every host."""

    def __init__(self, folder):
        self.trace = folder / "trace.csv"
        plain = folder / "devices.toml"
        plain.write_text(f'name = "devices"\nbase = "one_wire_twin"\nlease_s = {LEASE_S}\n')
        command = [sys.executable, "-m", "simulators", "--rig", str(plain), "--framing", "lines"]
        pace = ["--speed", str(SPEED)] if SPEED else ["--lock-step"]
        self._process = subprocess.Popen(
            [*command, *pace, "--trace", str(self.trace)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        urls = json.loads(self._process.stdout.readline())
        self.rig = folder / "rig.toml"
        where = {"amplifier": urls["amplifier"]["url"], "daq": urls["encoder_daq"]["url"]}
        self.rig.write_text(RIG.format(speed=SPEED, lease=LEASE_S, wire=f"mortal {folder.name}", **where))

    def rows(self):
        """Tick, wall seconds and output of every tick so far."""
        with self.trace.open(newline="") as file:
            rows = [row for row in csv.reader(file) if len(row) == 6][1:]
        return np.array([[float(r[0]), float(r[1]), float(r[2])] for r in rows])

    def wait_for(self, tick):
        """Until the wire has lived so long."""
        patience = time.monotonic() + 60
        while time.monotonic() < patience:
            lines = self.trace.read_bytes().count(b"\n") if self.trace.exists() else 0
            if lines > tick:
                return
            time.sleep(0.001)
        raise AssertionError("the host did not get so far")

    def close(self):
        self._process.stdin.close()
        self._process.wait(20)
        self._process.stdout.close()


@pytest.fixture
def devices(tmp_path):
    devices = Devices(tmp_path)
    yield devices
    devices.close()


def host(*arguments):
    command = [sys.executable, "-m", "smarig", *arguments, "--quiet"]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run that nobody killed."""
    folder = tmp_path_factory.mktemp("whole")
    devices = Devices(folder)
    try:
        out = folder / "whole.run.sqlite"
        done = host("run", *PROTOCOL, *SETTLE, "--rig", str(devices.rig), "-o", str(out))
        _, err = done.communicate(timeout=120)
        assert done.returncode == 0, err
    finally:
        devices.close()
    return load_run(out)


@pytest.mark.parametrize("k", range(KILLS))
def test_a_killed_host_costs_time_and_nothing_else(k, devices, whole, tmp_path):
    out = tmp_path / "mortal.run.sqlite"
    run = host("run", *PROTOCOL, *SETTLE, "--rig", str(devices.rig), "-o", str(out))
    devices.wait_for((k + 0.5) / KILLS * len(whole))
    run.send_signal(signal.SIGKILL)
    killed_tick = devices.rows()[-1, 0]
    run.communicate()
    committed = _settled_ticks(out)
    time.sleep(2.5 * LEASE_S / SPEED + 0.1 if SPEED else MISSED_S + 2.5 * LEASE_S)
    _off_within_the_lease(devices.rows(), killed_tick)

    again = host("resume", str(out))
    said, err = again.communicate(timeout=180)
    assert again.returncode == 0, f"{said}\n{err}"
    resumed = load_run(out)
    assert resumed.cause == "done"
    assert committed <= set(resumed["tick"].astype(int).tolist()), "no committed sample is lost"
    one, other = fod_data(whole), fod_data(resumed)
    np.testing.assert_array_equal(one.alpha, other.alpha)
    np.testing.assert_array_equal(one.beta, other.beta)
    per_count = float(whole.meta["output"]["per_count"])
    assert np.abs(one.y - other.y).max() <= per_count * 1.0


def _settled_ticks(out):
    try:
        return set(load_run(out)["tick"].astype(int).tolist())
    except Exception:
        return set()  # killed before the file was one


def _off_within_the_lease(rows, killed_tick):
    lease = round(LEASE_S / 0.1)
    heard_at_most = killed_tick + 2  # a tick that was under way, and the trace's own
    late = rows[rows[:, 0] > heard_at_most + lease + 1]
    assert late.size, "time went on"
    assert not np.any(late[:, 2]), "the output is off"
