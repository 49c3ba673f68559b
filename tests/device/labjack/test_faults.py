"""Faults of a LabJack and of its line: each is one sentence, or is repaired, and the output is at zero."""

import math
import time

import pytest

from device.labjack.boxes import SPEED, faulty_line, link_of, rig, running_box
from smarig.core.errors import ConfigError
from smarig.device import Garbled, Silent, WrongDevice
from smarig.device.drivers.labjack_output import labjack_output
from smarig.device.drivers.labjack_position import labjack_position
from smarig.device.drivers.labjack_temperature import labjack_temperature
from smarig.device.links import shared_link


@pytest.fixture
def box():
    with running_box() as found:
        yield found
    assert not shared_link._LINKS._open  # every test leaves the connection


@pytest.fixture
def line(box):
    with faulty_line(box.url) as found:
        yield found


def output_on(url, **changed):
    file = rig(url, **changed)
    return labjack_output(link_of(file, "amplifier").model_copy(update={"timeout_s": 0.05}), file)


@pytest.fixture
def output(line):
    found = output_on(line.url)
    found.arm()
    yield found
    found.close()


def test_nobody_listens():
    with pytest.raises(Silent, match="the connection was not accepted"):
        output_on("tcp://127.0.0.1:1")


def test_a_box_of_another_product_is_left_alone(box):
    box.wire.box.product = 9
    with pytest.raises(WrongDevice, match=r"product number 9\. A LabJack T4, T7 or T8 is required"):
        output_on(box.url)
    assert box.wire.box.flash_writes == 0


@pytest.mark.parametrize("fault", ["swallow", "garble"])
def test_a_lost_or_changed_reply_costs_one_repetition(output, line, box, fault):
    output.set_current(0.3)
    setattr(line, fault, 1)
    output.set_current(0.4)
    assert box.wire.box.dac_V[0] == pytest.approx(1.6, abs=0.01)
    assert not output.tripped


def test_a_dac_that_was_left_on_is_off_before_anything_else(box):
    box.wire.box.dac_V[0] = 3.0
    with pytest.raises(ConfigError, match="needs 20 V at DAC0"):
        output_on(box.url, links={"amplifier": {"settings": {"amperes_per_volt": 0.05}}})
    assert box.wire.box.dac_V[0] == 0.0


def test_a_line_that_is_cut_during_a_run_is_opened_again(output, line, box):
    output.set_current(0.3)
    line.cut()
    output.set_current(0.2)
    assert box.wire.box.dac_V[0] == pytest.approx(0.8, abs=0.01)


@pytest.mark.parametrize(("fault", "error"), [("swallow", Silent), ("garble", Garbled)])
def test_a_line_that_stays_bad_is_one_fault_and_the_watchdog_acts(output, line, box, fault, error):
    output.set_current(0.3)
    setattr(line, fault, 10_000)
    with pytest.raises(error):
        output.measure()
    assert "Its watchdog sets it to 0 V within 2 s" in output.off()
    line.close()
    time.sleep(3.5 / SPEED)
    assert box.wire.box.dac_V[0] == 0.0


def test_a_slow_box_still_serves(output, box):
    box.delay_s = 0.02
    output.set_current(0.1)
    assert box.wire.box.dac_V[0] == pytest.approx(0.4, abs=0.01)


def test_a_restart_of_the_box_is_a_trip(output, box):
    output.set_current(0.3)
    box.wire.box.restart()
    output.set_current(0.3)
    assert "went from 1.2 V to 0 V by itself" in output.tripped
    assert box.wire.box.dac_V[0] == 0.0
    output.arm()
    assert not output.tripped
    assert output.has_lease


def test_another_program_that_moves_the_dac_is_noticed_and_switched_off(output, box):
    output.set_current(0.1)
    box.wire.box.dac_V[0] = 3.0
    output.measure()
    assert "is at 3 V instead of 0.4" in output.tripped
    assert box.wire.box.dac_V[0] == 0.0


def test_the_flash_is_written_only_where_it_differs(output, box):
    written = box.wire.box.flash_writes
    assert 0 < written <= 6
    for _ in range(3):
        output.arm()
    assert box.wire.box.flash_writes == written


def test_a_box_that_does_not_keep_its_watchdog_gives_no_lease(output, box, monkeypatch):
    monkeypatch.setattr(box.wire.box, "write", lambda *_: 0)
    output._timeout_s = 5  # so that it differs
    with pytest.raises(Garbled, match="does not keep the settings of its watchdog"):
        output.arm()
    assert not output.has_lease


def test_without_watchdog_there_is_no_lease_and_off_says_so(line, box):
    settings = {"links": {"amplifier": {"settings": {"watchdog": False}}}}
    output = output_on(line.url, **settings)
    output.arm()
    assert not output.has_lease
    assert box.wire.box.flash_writes == 0
    line.swallow = 10_000
    assert "switch the amplifier off by hand now" in output.off()
    output.close()


def test_a_laser_out_of_range_gives_no_position(box, monkeypatch):
    file = rig(box.url)
    sensor = labjack_position(link_of(file, "encoder_daq"), file)
    assert abs(sensor.position()) < 0.01
    monkeypatch.setattr(box.wire.box, "_volts", lambda channel: 10.5)
    assert math.isnan(sensor.position())
    sensor.close()


def test_a_counter_continues_when_it_wraps_and_a_restart_loses_it(box):
    links = {"encoder_daq": ("labjack_position", {"counter_line": 2})}
    file = rig(box.url, links)
    sensor = labjack_position(link_of(file, "encoder_daq"), file)
    counts = 0
    box.wire.box._counts = lambda: counts
    zero = sensor.position()
    for counts in (-5, 2**31 - 10, 2**32 - 20, 2**32 + 7):
        assert sensor.position() - zero == counts
    box.wire.box.restart()
    assert math.isnan(sensor.position())
    sensor.close()


def test_two_roles_share_one_connection_and_the_last_closes_it(box):
    file = rig(box.url)
    output = labjack_output(link_of(file, "amplifier"), file)
    sensor = labjack_position(link_of(file, "encoder_daq"), file)
    ((_, users),) = shared_link._LINKS._open.values()
    assert users == 2
    output.close()
    output.close()
    assert abs(sensor.position()) < 0.01
    with pytest.raises(Silent, match="is not open"):
        output.measure()
    sensor.close()


def test_a_failed_opening_leaves_the_connection(box):
    file = rig(box.url, {"encoder_daq": ("labjack_position", {"counter_line": 1})})
    with pytest.raises(ConfigError, match="start at 0, 2, 6"):
        labjack_position(link_of(file, "encoder_daq"), file)


def test_a_feature_that_is_not_configured_gives_no_temperature(box):
    file = rig(
        box.url, {"thermometer": ("labjack_temperature", {"feature": {"channel": 5, "configured": True}})}
    )
    thermometer = labjack_temperature(link_of(file, "thermometer"), file)
    assert math.isnan(thermometer.temperature_degC())
    thermometer.close()
