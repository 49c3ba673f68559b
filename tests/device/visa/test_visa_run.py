"""A run on a supply and a laser by VISA, on the wire of a twin; hosts that are killed leave no current on."""

import os
import signal
import subprocess
import sys
import time

import pytest

pytest.importorskip("pyvisa_py", reason="the extra visa is not installed")

from device.polled.wire_by_time import SPEED, WireByTime
from device.visa.scpi_server import ScpiServer
from smarig.record import load_run

RIG = """name = "visa"
base = "bench_one_wire"
wire = "twin-of-a-test"
lease_s = {lease}
encoder.resolution = 0.01
[links.amplifier]
driver = "visa_supply"
framing = "lines"
url = "{url}"
timeout_s = 1.0
settings = {{ backend = "@py" }}
[links.encoder_daq]
driver = "visa_meter"
framing = "lines"
url = "{url}"
timeout_s = 1.0
settings = {{ backend = "@py", query = "MEAS:POS?", unit = "mm" }}
[simulator]
start = false
speed = {speed}
"""
LEASE_S, LATE_S = 10.0, 10.0  # of device time: a quarter of a second each, for a busy machine
KILLS = range(20) if os.environ.get("SMARIG_LONG") else (3, 11)


@pytest.fixture
def bench(tmp_path):
    """(the server of a make, the command that runs step currents on it)"""
    servers = []

    def made(make):
        wire = WireByTime()
        server = ScpiServer(make, speed=SPEED, drive=wire.drive, position=lambda: wire.position_mm)
        server.wire = wire
        servers.append(server)
        path = tmp_path / "visa.toml"
        path.write_text(RIG.format(url=server.url, speed=SPEED, lease=LEASE_S))
        words = "run step_currents --set temperatures_K=60,100 --set settle.timeout_s=60 --force --quiet"
        out = ["--rig", str(path), "-o", str(tmp_path / "a.run.sqlite")]
        return server, [sys.executable, "-W", "ignore", "-m", "smarig", *words.split(), *out]

    yield made
    for server in servers:
        server.close()


@pytest.mark.parametrize("make", ["keysight_n6700", "rigol_dp800"])
def test_a_run_moves_the_wire_and_says_whether_it_has_a_lease(bench, make, tmp_path):
    server, command = bench(make)
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    run = load_run(tmp_path / "a.run.sqlite")
    heated = [step.position for step in run.steps if step.target and step.target > 0]
    assert 6.0 < heated[0] < heated[1] < 13.0, "as the twin moves"
    leased = make == "keysight_n6700"
    assert run.meta["has_lease"] is leased
    assert bool([e for e in run.events if e.kind == "no_lease"]) is not leased
    assert (server.flows_A, server.unknown) == (0.0, [])


@pytest.mark.parametrize("moment", KILLS)
def test_a_killed_host_leaves_no_current_on(bench, moment):
    server, command = bench("keysight_n6700")
    host = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        begin_s = time.monotonic()
        while server.flows_A == 0.0 and time.monotonic() - begin_s < 60:
            time.sleep(0.01)
        time.sleep(0.05 * moment)
        host.send_signal(signal.SIGKILL)
    finally:
        host.kill()
        host.wait()
    time.sleep((LEASE_S + LATE_S) / SPEED)
    assert server.flows_A == 0.0
    assert server.off_after_s is None or server.off_after_s < LEASE_S + LATE_S, "None: it was off already"
