"""Every role of a LabJack fulfils the contract of its role, on a simulated box with the wire of the twin."""

import time
from typing import Any

import pytest

from device.labjack.boxes import INPUTS, SPEED, VOLTAGE_STAGE, rig, running_box
from smarig.device import ContractCase, Role, check_contract
from smarig.rig.driver_check import in_role

CASES: dict[str, tuple[Role, dict[str, Any]]] = {
    "current amplifier": ("amplifier", {}),
    "voltage stage": ("amplifier", {"amplifier": ("labjack_output", VOLTAGE_STAGE | INPUTS)}),
    "laser": ("encoder_daq", {}),
    "encoder": ("encoder_daq", {"encoder_daq": ("labjack_position", {"counter_line": 0})}),
    "wire": (
        "thermometer",
        {"thermometer": ("labjack_temperature", {"input": {"channel": 4, "scale": 100.0}})},
    ),
    "thermocouple": (
        "room_thermometer",
        {
            "room_thermometer": (
                "labjack_temperature",
                {"feature": {"channel": 5, "thermocouple": "K"}},
            )
        },
    ),
    "load cell": (
        "load_cell",
        {"load_cell": ("labjack_force", {"input": {"channel": 6, "scale": 20.0, "offset": -1.0}})},
    ),
}


@pytest.mark.parametrize(("name", "product"), [*((name, 7) for name in CASES), ("current amplifier", 4)])
def test_the_contract(name, product):
    """The DAC of a T4 has 10 bits: steps of 5 mV."""
    role, links = CASES[name]
    with running_box(links, product) as box:
        file = rig(box.url, links)
        absent = rig("tcp://127.0.0.1:1", links)
        case = ContractCase(
            open=lambda: in_role(role, getattr(file.links, role), file),
            open_absent=lambda: in_role(role, getattr(absent.links, role), absent),
            rig=file,
            wait=lambda seconds: time.sleep(seconds / SPEED),
        )
        results = list(check_contract(role, case))
        broken = [f"{r.name}: {r.observed}" for r in results if not r.passed]
        assert not broken
        if role == "amplifier":
            lease = next(r for r in results if r.name == "lease")
            assert "its watchdog switched it off after 2 s" in lease.observed
            assert box.wire.box.dac_V == [0.0, 0.0]
            assert box.wire.box.fired >= 1
