"""kill -9 of the host during an identification while the devices continue: the lease ends the current.

No committed sample is lost, ``resume`` finishes the run, and its table equals that of an uninterrupted run.

There is one moment in lock-step, with ``SMARIG_LONG`` three, where time advances after the kill because the test
polls the encoder.
The long campaign has ``SMARIG_KILLS`` moments in real time × 20, and ``SMARIG_CHIP_KILLS`` on the firmware
under simavr. Moments are spread evenly over the run.
"""

import os

import pytest

from rig.bench.mortal import SimulatedDevices, killed_and_resumed, same_table, undisturbed
from rig.bench.wired_chips import Chips

KILLS = int(os.environ.get("SMARIG_KILLS", "3"))
LONG = pytest.mark.long("takes ten seconds")
CHIP_KILLS = int(os.environ.get("SMARIG_CHIP_KILLS", "0"))
SPEED = 20.0 if "SMARIG_KILLS" in os.environ else 0.0
LEASE_S = 2.0 if SPEED else 0.5  # of the device's time: a tenth of a second of ours in real time


@pytest.fixture
def devices(tmp_path):
    devices = SimulatedDevices(tmp_path, SPEED, LEASE_S)
    yield devices
    devices.close()


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """An uninterrupted run in lock-step."""
    folder = tmp_path_factory.mktemp("whole")
    devices = SimulatedDevices(folder, 0.0, LEASE_S)
    try:
        return undisturbed(devices, folder / "whole.run.sqlite")
    finally:
        devices.close()


@pytest.mark.long("takes ten seconds", cases=("1",))
@pytest.mark.parametrize(
    "k",
    range(KILLS)
    if "SMARIG_KILLS" in os.environ
    else [pytest.param(0, marks=LONG), 1, pytest.param(2, marks=LONG)],
)
def test_a_killed_host_costs_time_and_nothing_else(k, devices, whole, tmp_path):
    same_table(killed_and_resumed(devices, whole, (k + 0.5) / KILLS, tmp_path / "mortal.run.sqlite"), whole)


@pytest.mark.skipif(not CHIP_KILLS, reason="takes a minute each: SMARIG_CHIP_KILLS=20")
@pytest.mark.parametrize("k", range(max(CHIP_KILLS, 1)))
def test_neither_does_it_on_chips(k, start, whole, tmp_path):
    devices = Chips(tmp_path, start)
    run = killed_and_resumed(devices, whole, (k + 0.5) / CHIP_KILLS, tmp_path / "mortal.run.sqlite")
    same_table(run, whole)
