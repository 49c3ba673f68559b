"""Wrong settings of a LabJack are one sentence that names the key, before a box is touched."""

from typing import Any

import pytest

from device.labjack.boxes import INPUTS, VOLTAGE_STAGE, link_of, rig, running_box
from smarig.core.errors import ConfigError
from smarig.rig.driver_check import in_role

CURRENT = {"dac": 0, "amperes_per_volt": 0.25, **INPUTS}
AIN = {"channel": 2, "scale": 1.0}

WRONG: list[tuple[str, str, dict[str, Any], str]] = [
    ("amplifier", "labjack_output", CURRENT | {"dac": 2}, "dac: .*less than or equal to 1"),
    ("amplifier", "labjack_output", CURRENT | {"volts_per_volt": 1.0}, "give either amperes_per_volt"),
    ("amplifier", "labjack_output", {"dac": 0, **INPUTS}, "give either amperes_per_volt"),
    ("amplifier", "labjack_output", CURRENT | {"shunt": 1}, "unknown key 'shunt'"),
    ("amplifier", "labjack_output", {"dac": 0, "amperes_per_volt": 1.0}, "key 'current_input' is missing"),
    (
        "amplifier",
        "labjack_output",
        VOLTAGE_STAGE | {"current_input": AIN},
        "a voltage stage needs voltage_input",
    ),
    ("encoder_daq", "labjack_position", {}, "give either input"),
    ("encoder_daq", "labjack_position", {"input": AIN}, "input needs unit, mm or deg"),
    ("encoder_daq", "labjack_position", {"input": AIN, "unit": "inch"}, "unit: .*'mm' or 'deg'"),
    (
        "encoder_daq",
        "labjack_position",
        {"input": AIN, "unit": "mm", "minimum": 3, "maximum": 2},
        "less than",
    ),
    ("thermometer", "labjack_temperature", {"feature": {"channel": 1}}, "either thermocouple or configured"),
    ("thermometer", "labjack_temperature", {}, "give either input"),
    ("load_cell", "labjack_force", {"input": {"channel": "AIN3", "scale": 1}}, "input.channel: "),
]


@pytest.mark.parametrize(("role", "driver", "settings", "says"), WRONG)
def test_wrong_settings(role, driver, settings, says):
    file = rig("tcp://127.0.0.1:1", {role: (driver, settings)})
    with pytest.raises(ConfigError, match=f"settings of driver {driver}: .*{says}") as caught:
        in_role(role, link_of(file, role), file)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"lease_s": 1.5}, r"lease_s = 1.5: the watchdog .* Give lease_s = 2"),
        ({"lease_s": 0.4}, r"Give lease_s = 1"),
        ({"limits": {"current_min_A": -0.5}}, "one sign only"),
        ({"links": {"amplifier": {"framing": "lines"}}}, 'framing = "modbus_tcp"'),
        ({"links": {"amplifier": {"settings": {"amperes_per_volt": 0.1}}}}, "needs 10 V at DAC0"),
    ],
)
def test_a_rig_that_a_labjack_cannot_serve(changed, says):
    with running_box() as box:
        file = rig(box.url, **changed)
        with pytest.raises(ConfigError, match=says):
            in_role("amplifier", link_of(file, "amplifier"), file)
        assert box.wire.box.dac_V == [0.0, 0.0]
