"""The NI drivers on a stub of nidaqmx: contract of every role, faults, settings. Not on hardware."""

import math
import time

import pytest

from device.labjack.boxes import link_of
from device.ni import stub_nidaqmx as stub
from smarig.config import RigFile, load_rig
from smarig.core.errors import ConfigError, UsageError
from smarig.device import ContractCase, Garbled, Silent, check_contract
from smarig.device.drivers import _ni
from smarig.plant import Actuator
from smarig.rig.driver_check import in_role
from smarig.rig.open_rig import open_rig
from smarig.rig.twin import TwinSettings

SPEED = 10.0
INPUTS = {
    "current_input": {"channel": "ai0", "scale": 1.0},
    "voltage_input": {"channel": "ai1", "scale": 1.0, "terminal": "DIFF"},
}
CURRENT = {"channel": "ao0", "amperes_per_volt": 0.25, **INPUTS}
STAGE = {"channel": "ao0", "volts_per_volt": 1.25, **INPUTS}
LASER = {"input": {"channel": "ai2", "scale": 2.0}, "unit": "mm"}

CASES = {
    "current amplifier": ("amplifier", "ni_output", CURRENT),
    "with watchdog": ("amplifier", "ni_output", CURRENT | {"watchdog": True}),
    "voltage stage": ("amplifier", "ni_output", STAGE),
    "laser": ("encoder_daq", "ni_position", LASER),
    "encoder": ("encoder_daq", "ni_position", {"counter": "ctr0"}),
    "sampled encoder": ("encoder_daq", "ni_position", {"counter": "ctr0", "clock": "ctr1"}),
    "linear": ("thermometer", "ni_temperature", {"input": {"channel": "ai2", "scale": 20.0}}),
    "thermocouple": ("thermometer", "ni_temperature", {"thermocouple": {"channel": "ai0", "type": "K"}}),
    "load cell": ("load_cell", "ni_force", {"input": {"channel": "ai3", "scale": 5.0}}),
}


@pytest.fixture(autouse=True)
def world(monkeypatch):
    monkeypatch.setattr(_ni, "importlib", _Importing())
    monkeypatch.setattr(stub, "WORLD", stub.World())
    monkeypatch.setattr(stub, "SPEED", [SPEED])
    yield stub.WORLD
    assert stub.WORLD.open_tasks == 0


class _Importing:
    @staticmethod
    def import_module(name):
        assert name.split(".")[0] == "nidaqmx"
        return stub.PACKAGE


def rig(role, driver, settings, url="Dev1", **changed):
    table = load_rig("labjack_one_wire").model_dump(exclude_none=True)
    table["simulator"] |= {"start": False, "speed": SPEED}
    for link in table["links"].values():
        link["url"] = "Dev1"
    table["links"][role] = {"driver": driver, "framing": "lines", "url": url, "settings": settings}
    return RigFile.model_validate(table | changed)


def opened(role, driver, settings, **changed):
    file = rig(role, driver, settings, **changed)
    return in_role(role, link_of(file, role), file)


@pytest.mark.parametrize("name", CASES)
def test_the_contract(name):
    role, driver, settings = CASES[name]
    case = ContractCase(
        open=lambda: opened(role, driver, settings),
        open_absent=lambda: opened(role, driver, settings, url="Dev9"),
        rig=rig(role, driver, settings),
        wait=lambda seconds: time.sleep(seconds / SPEED),
    )
    results = list(check_contract(role, case))
    assert not [f"{r.name}: {r.observed}" for r in results if not r.passed]
    assert "untested on hardware" in results[0].observed
    if role == "amplifier":
        lease = next(r.observed for r in results if r.name == "lease")
        assert ("it has none" in lease) != ("watchdog" in settings)


def test_without_the_package(monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(_ni.importlib, "import_module", missing, raising=False)
    with pytest.raises(UsageError, match=r"pip install 'smarig\[ni\]'"):
        opened("amplifier", "ni_output", CURRENT)


def test_without_the_driver_of_ni(world):
    world.installed = False
    with pytest.raises(Silent, match="The driver NI-DAQmx is not installed"):
        opened("amplifier", "ni_output", CURRENT)
    world.installed = True


def test_a_device_that_is_pulled_out(world):
    source = opened("amplifier", "ni_output", CURRENT)
    source.set(0.3)
    world.fault = "The specified device is not present or is not active in the system."
    with pytest.raises(
        Silent, match=r"Dev1: The specified device is not present .*\. Check its power"
    ) as caught:
        source.since(1, 1)
    assert "\n" not in str(caught.value)
    assert "switch the amplifier off by hand now" in source.off()
    source.close()


def test_an_output_that_stays_on_is_reported(world):
    source = opened("amplifier", "ni_output", CURRENT)
    source.set(0.3)
    world.stuck = True
    assert "is set to 0 V, but 0.3 A are measured" in source.off()
    source.close()


def test_a_device_without_watchdog_is_said_so(world):
    world.has_watchdog = False
    with pytest.raises(ConfigError, match="Dev1 has no watchdog .* Give watchdog = false"):
        opened("amplifier", "ni_output", CURRENT | {"watchdog": True})


def test_an_encoder_counts_from_opening_on(world):
    world.counts = 100
    file = rig("encoder_daq", "ni_position", {"counter": "ctr0"})
    sensor = in_role("encoder_daq", link_of(file, "encoder_daq"), file)
    world.counts = 93
    time.sleep(0.02)
    assert sensor.since(0, 1)[-1].counts == -7
    sensor.close()


def sampled():
    return opened("encoder_daq", "ni_position", {"counter": "ctr0", "clock": "ctr1"})


def test_every_tick_of_a_sampled_encoder_has_its_reading_however_late_it_is_read(world):
    """A host that sleeps for 20 ticks loses none, and none takes the place of another."""
    world.path = lambda edge: 3 * edge
    sensor = sampled()
    time.sleep(0.2)
    found = sensor.since(0, 1000)
    sensor.close()
    assert len(found) >= 20
    assert [(r.tick, r.counts) for r in found] == [(k, 3 * k) for k in range(len(found))]


def test_the_same_samples_can_be_read_again_from_any_tick(world):
    world.path = lambda edge: edge
    sensor = sampled()
    time.sleep(0.1)
    assert [r.counts for r in sensor.since(4, 3)] == [4, 5, 6]
    assert [r.counts for r in sensor.since(2, 2)] == [2, 3]
    sensor.close()


def test_zero_holds_for_later_samples_of_a_sampled_encoder(world):
    world.counts = 0
    sensor = sampled()
    world.counts = 40
    time.sleep(0.05)
    sensor.zero()
    at = sensor.tick()
    time.sleep(0.05)
    later = sensor.since(at + 1, 100)
    sensor.close()
    assert later
    assert {r.counts for r in later} == {0}


@pytest.mark.parametrize("answer", [[math.nan], [math.inf], ["x"], None])
def test_what_is_no_count_is_a_fault(world, monkeypatch, answer):
    sensor = sampled()
    monkeypatch.setattr(stub.Task, "_sampled", lambda _: answer)
    with pytest.raises(Garbled, match="for a count"):
        sensor.tick()
    sensor.close()


def test_a_clock_that_does_not_run_is_said(world, monkeypatch):
    monkeypatch.setattr(stub.World, "edges", lambda *_: 0)
    monkeypatch.setattr("smarig.device.drivers._ni_sampled_counter.LATEST_WAIT_S", 0.1)
    monkeypatch.setattr("smarig.device.drivers._ni_sampled_counter.FIRST_PERIODS", 1)
    with pytest.raises(Silent, match="ctr0 sampled by ctr1 .* gives no sample: its clock does not run"):
        sampled()


def test_samples_that_the_device_has_overwritten_are_a_fault(world, monkeypatch):
    sensor = sampled()
    monkeypatch.setattr(stub.World, "edges", lambda *_: 10**6)
    with pytest.raises(Silent, match="samples that are no longer available"):
        sensor.tick()
    sensor.close()


@pytest.mark.parametrize(
    ("role", "driver", "settings", "says"),
    [
        ("amplifier", "ni_output", CURRENT | {"volts_per_volt": 1.0}, "give either amperes_per_volt"),
        ("amplifier", "ni_output", CURRENT | {"amperes_per_volt": 0.01}, "needs 100 V at ao0"),
        ("amplifier", "ni_output", {**STAGE, "voltage_input": None}, "a voltage stage needs voltage_input"),
        ("encoder_daq", "ni_position", {}, "give either input"),
        ("encoder_daq", "ni_position", {"counter": "ctr0", "clock": "ctr0"}, "clock is a second counter"),
        ("encoder_daq", "ni_position", LASER | {"clock": "ctr1"}, "clock is a second counter"),
        ("encoder_daq", "ni_position", {"counter": "c", "unit": 3}, "unit: "),
        ("thermometer", "ni_temperature", {}, "give either input"),
        ("load_cell", "ni_force", {}, "key 'input' is missing"),
    ],
)
def test_wrong_settings(role, driver, settings, says):
    with pytest.raises(ConfigError, match=says):
        opened(role, driver, settings)


def test_a_device_without_a_name():
    with pytest.raises(ConfigError, match="'Dev1/ao0' is no name of an NI device"):
        opened("amplifier", "ni_output", CURRENT, url="Dev1/ao0")


def test_measuring_feeds_the_watchdog(world):
    source = opened("amplifier", "ni_output", CURRENT | {"watchdog": True})
    source.set(0.3)
    for _ in range(8):  # 2 s of the lease are 0.2 s here
        time.sleep(0.05)
        source.since(1, 1)
    assert world.ao_V > 1.0
    assert not source.tripped
    source.off()
    source.close()


def test_a_rig_steps_with_the_clock_of_the_device_beside_that_of_the_host(world):
    """The position comes from the device's ticks, the current from the host's; each sample of the rig has both."""
    world.path = lambda edge: edge
    file = rig("amplifier", "ni_output", CURRENT)
    table = file.model_dump(exclude_none=True)
    table["links"]["encoder_daq"]["driver"] = "ni_position"
    table["links"]["encoder_daq"]["settings"] = {"counter": "ctr0", "clock": "ctr1"}
    for further in ("thermometer", "room_thermometer", "load_cell"):
        table["links"].pop(further, None)
    file = RigFile.model_validate(table)
    with open_rig(file.name, file, Actuator.named(file.actuator), TwinSettings(), speed=SPEED) as bench:
        bench.arm()
        found = [sample for _ in range(40) for sample in bench.step(0.2)]
    counts = [round((s.position - found[0].position) / file.encoder.resolution) for s in found]
    assert counts == [s.tick - found[0].tick for s in found], (
        "a sample of the device was used in another tick"
    )
    assert found[-1].current_A == pytest.approx(0.2, abs=0.01)
    assert world.ao_V == 0.0
