"""What a driver says goes into one sentence; an identity that is none is an error of the driver."""

import pickle
from types import SimpleNamespace

import pytest

from smarig.config import load_rig
from smarig.core.errors import ConfigError, LeaseExpired, RigFault
from smarig.core.shown_text import LONGEST_LINE
from smarig.device.encoding.link_faults import Refused, Silent
from smarig.device.polled.adapted import as_force_input, as_position_sensor
from smarig.device.polled.polled_source import PolledSource


def cell(identity):
    return SimpleNamespace(identity=identity, force_N=lambda: 1.0, close=lambda: None)


@pytest.mark.parametrize("identity", [b"ACME", 3, None, "x" * 1_000_000])
def test_an_identity_that_is_no_text_of_some_length_is_an_error_of_the_driver(identity):
    with pytest.raises(
        ConfigError, match=r"^Driver \./cell\.py: identity is .*\. Correct the driver"
    ) as refused:
        as_force_input(cell(identity), "./cell.py")
    assert len(str(refused.value)) < 300
    assert as_force_input(cell("ACME,1"), "./cell.py").identity == "ACME,1"


@pytest.mark.parametrize("kind", [RigFault, Silent, LeaseExpired, lambda text: Refused(text, 3)])
def test_the_words_of_a_driver_are_one_line_of_bounded_length(kind):
    assert str(kind("over\ntemperature\r\n at\x1b[2J  the shunt")) == r"over temperature at\x1b[2J the shunt"
    assert len(str(kind("x\n" * 100_000))) <= LONGEST_LINE
    assert str(kind("too hot").at_zero()) == "too hot The current is at zero."


def test_a_fault_with_further_arguments_is_one_too():
    assert str(pickle.loads(pickle.dumps(Silent("no reply", 3)))) == "('no reply', 3)"


def test_why_a_source_is_not_off_is_one_line():
    output = SimpleNamespace(arm=lambda: None, tripped="", off=lambda: "still\non\n" * 1000)
    assert len(PolledSource(output).off()) <= LONGEST_LINE
    output.off = lambda: "still\non"
    assert PolledSource(output).off() == "still on"


def test_a_unit_of_many_lines_is_shown_on_one():
    laser = SimpleNamespace(identity="laser", unit="mm\n" * 1000, position=lambda: 1.0, close=lambda: None)
    with pytest.raises(ConfigError, match=r"^laser measures in mm mm") as refused:
        as_position_sensor(laser, "./laser.py", load_rig("one_wire_serial"))
    assert "\n" not in str(refused.value)
    assert len(str(refused.value)) < 300
