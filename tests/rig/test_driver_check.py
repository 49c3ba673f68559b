"""The contract of the shipped drivers over each link, on the simulated devices in real time."""

import pytest

from smarig.config import load_rig
from smarig.core import SmarigError, UsageError
from smarig.rig import check_driver

LINKS = ("serial", "modbus_tcp", "modbus_rtu")


@pytest.mark.parametrize("link", LINKS)
@pytest.mark.parametrize("role", ["amplifier", "encoder_daq"])
def test_a_shipped_driver_meets_the_contract_over_each_link(link, role):
    name = f"one_wire_{link}"
    found = list(check_driver(name, load_rig(name), role))
    assert [(r.name, r.observed) for r in found if not r.passed] == []
    assert len(found) == {"amplifier": 12, "encoder_daq": 6}[role]


def test_a_driver_of_the_other_role_is_one_sentence():
    with pytest.raises(SmarigError, match="requires|is of kind"):
        list(check_driver("one_wire_serial", load_rig("one_wire_serial"), "amplifier", "smarig_encoder_daq"))


def test_a_role_without_a_device_needs_a_driver():
    with pytest.raises(UsageError, match="has no link thermometer"):
        list(check_driver("one_wire_serial", load_rig("one_wire_serial"), "thermometer"))
