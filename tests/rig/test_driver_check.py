"""The contract of the shipped drivers over each link, on the simulated devices in real time."""

from types import SimpleNamespace

import pytest

from device.contract import faulty_instruments
from smarig.config import load_rig
from smarig.core import SmarigError, UsageError
from smarig.rig import check_driver, driver_check, rig_for_check

LINKS = ("serial", "modbus_tcp", "modbus_rtu")


LONG = pytest.mark.long("takes three seconds")
ALWAYS = {("amplifier", "serial"), ("encoder_daq", "modbus_tcp"), ("encoder_daq", "modbus_rtu")}


@pytest.mark.parametrize(
    ("role", "link"),
    [
        pytest.param(role, link, marks=[] if (role, link) in ALWAYS else LONG)
        for role in ("amplifier", "encoder_daq")
        for link in LINKS
    ],
)
def test_a_shipped_driver_meets_the_contract_over_each_link(link, role):
    name = f"one_wire_{link}"
    found = list(check_driver(name, load_rig(name), role))
    assert [(r.name, r.observed) for r in found if not r.passed] == []
    assert len(found) == {"amplifier": 13, "encoder_daq": 6}[role]


def test_a_driver_of_the_other_role_is_one_sentence():
    with pytest.raises(SmarigError, match="requires|is of kind"):
        list(check_driver("one_wire_serial", load_rig("one_wire_serial"), "amplifier", "smarig_encoder_daq"))


def test_a_role_without_a_device_needs_a_driver():
    with pytest.raises(UsageError, match="has no link thermometer"):
        list(check_driver("one_wire_serial", load_rig("one_wire_serial"), "thermometer"))


def test_a_device_at_an_address_of_its_own_is_waited_for_in_its_own_time(monkeypatch):
    """Not in that of the simulated devices which the rig file would start: its lease of 1 s takes 1 s."""
    time, state = faulty_instruments.SimulatedTime(), {}
    clock = SimpleNamespace(sleep=time.wait, monotonic=lambda: time.now_s)

    def opened(link, _):
        return faulty_instruments.Output(time, state, present=link.url == "tcp://10.0.0.9:5025")

    monkeypatch.setattr(driver_check, "instrument_of", opened)
    monkeypatch.setattr(driver_check, "time", clock)
    rig = load_rig("one_wire_serial")
    found = list(check_driver("one_wire_serial", rig, "amplifier", "a_driver", "tcp://10.0.0.9:5025"))
    assert [(r.name, r.observed) for r in found if not r.passed] == []
    assert {r.name: r.observed for r in found}["lease"] == "Its watchdog has switched it off."


def test_devices_that_run_already_keep_the_speed_of_the_rig_file():
    rig = load_rig("one_wire_serial")
    running = rig.simulator.model_copy(update={"start": False, "speed": 20.0})
    used = rig_for_check(
        rig.model_copy(update={"simulator": running}), "amplifier", url="tcp://10.0.0.9:5025"
    )
    assert used.simulator == running
    assert used.links.amplifier.url == "tcp://10.0.0.9:5025", "the line that is locked"
