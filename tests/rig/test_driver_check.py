"""The contract of the shipped drivers over each link, on the simulated devices in real time."""

from types import SimpleNamespace

import pytest

from device.contract import faulty_instruments
from smarig.config import LinkFile, load_rig
from smarig.core import SmarigError, UsageError
from smarig.device import Silent
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


@pytest.mark.parametrize(
    ("url", "absent"),
    [
        ("ASRL/dev/pts/1::INSTR", "ASRL/dev/pts/1.absent::INSTR"),
        ("ASRL3::INSTR", "ASRL255::INSTR"),
        ("TCPIP0::192.168.1.20::INSTR", "TCPIP0::192.0.2.1::9::SOCKET"),
        ("USB0::0x2A8D::0x1301::MY57501234::INSTR", "TCPIP0::192.0.2.1::9::SOCKET"),
        ("GPIB0::5::INSTR", "TCPIP0::192.0.2.1::9::SOCKET"),
    ],
)
def test_the_absent_instrument_of_visa_has_a_visa_address(url, absent):
    """Else its absence is not tested: an address of no form is refused before anything is opened."""
    rname = pytest.importorskip("pyvisa.rname")
    link = LinkFile(driver="visa_meter", framing="lines", url=url)
    assert driver_check._without_device(link).url == absent
    rname.ResourceName.from_string(absent)


def test_an_absent_serial_meter_does_not_open():
    pytest.importorskip("pyvisa_py", reason="the extra visa is not installed")
    link = LinkFile(
        driver="visa_meter", framing="lines", url="ASRL/dev/pts/1::INSTR", settings={"backend": "@py"}
    )
    with pytest.raises(Silent, match="cannot be opened"):
        driver_check.in_role("encoder_daq", driver_check._without_device(link), load_rig("laboratory_supply"))
