"""A run on a supply and a laser by VISA, on the wire of a twin; hosts that are killed leave no current on."""

import os
import signal
import subprocess
import sys
import time

import pytest

pytest.importorskip("pyvisa_py", reason="the extra visa is not installed")

from device.visa.supplies import SPEED, bench_of
from smarig.record import load_run

LEASE_S, LATE_S = 10.0, 10.0  # of device time: a quarter of a second each, for a busy machine
KILLS = range(20) if os.environ.get("SMARIG_LONG") else (3,)


@pytest.fixture
def bench(tmp_path):
    """(the simulated devices with a supply of a make, the command that runs step currents on them)"""
    benches = []

    def made(make):
        path = tmp_path / "visa.toml"
        benches.append(bench_of(make, path, LEASE_S))
        words = "run step_currents --set temperatures_K=60,100 --set settle.timeout_s=60 --force --quiet"
        out = ["--rig", str(path), "-o", str(tmp_path / "a.run.sqlite")]
        return benches[-1], [sys.executable, "-W", "ignore", "-m", "smarig", *words.split(), *out]

    yield made
    for bench in benches:
        bench.close()


@pytest.mark.parametrize(
    "make", [pytest.param("keysight_n6700", marks=pytest.mark.long("takes five seconds")), "rigol_dp800"]
)
def test_a_run_moves_the_wire_and_says_whether_it_has_a_lease(bench, make, tmp_path):
    devices, command = bench(make)
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    run = load_run(tmp_path / "a.run.sqlite")
    heated = [step.position for step in run.steps if step.target and step.target > 0]
    assert 6.0 < heated[0] < heated[1] < 13.0, "as the twin moves"
    leased = make == "keysight_n6700"
    assert run.meta["has_lease"] is leased
    assert bool([e for e in run.events if e.kind == "no_lease"]) is not leased
    assert (devices.supply.flows_A, devices.supply.unknown) == (0.0, [])


@pytest.mark.long("takes a second", cases=("3",))
@pytest.mark.parametrize("moment", KILLS)
def test_a_killed_host_leaves_no_current_on(bench, moment):
    devices, command = bench("keysight_n6700")
    supply = devices.supply
    host = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        begin_s = time.monotonic()
        while supply.flows_A == 0.0 and time.monotonic() - begin_s < 60:
            time.sleep(0.01)
        time.sleep(0.05 * moment)
        host.send_signal(signal.SIGKILL)
    finally:
        host.kill()
        host.wait()
    time.sleep((LEASE_S + LATE_S) / SPEED)
    assert supply.flows_A == 0.0
    assert supply.off_after_s is None or supply.off_after_s < LEASE_S + LATE_S, "None: it was off already"


@pytest.mark.long("takes ten seconds")
def test_a_command_starts_the_supply_of_its_rig_file(tmp_path):
    rig = tmp_path / "mine.toml"
    rig.write_text(
        'name = "mine"\nbase = "laboratory_supply"\nwire = "twin-of-a-test"\nlease_s = 10.0\n'
        'simulator = { speed = 10.0, make = "keithley_2400" }\n'
    )
    done = smarig_on(
        rig, "run", "step_currents", "--rig", rig, "-o", "a.run.sqlite", "--set", "currents_A=0.5"
    )
    assert done.returncode == 0, done.stderr
    run = load_run(tmp_path / "a.run.sqlite")
    assert "MODEL 2400" in run.info.instruments[0]
    assert 1.0 < run.steps[-1].position < 13.0, "heated"
    checked = smarig_on(rig, "check", rig, "--driver", "visa_supply", "--role", "amplifier")
    assert "!!  lease: it has none" in checked.stderr
    assert "!!  off after a killed host: the current flows until it is opened again" in checked.stderr
    assert "only the cut-out stops the current" in checked.stdout


@pytest.mark.long("takes a second")
def test_a_driver_of_another_device_than_the_simulated_is_one_sentence(tmp_path):
    done = smarig_on(tmp_path / "x", "check", "--driver", "visa_supply")
    assert done.returncode == 2
    assert "simulates no device for the driver 'visa_supply'" in done.stderr
    assert "laboratory_supply" in done.stderr


def smarig_on(rig, *words):
    """A command in the folder of the rig file."""
    command = [sys.executable, "-W", "ignore", "-m", "smarig", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, cwd=rig.parent)
