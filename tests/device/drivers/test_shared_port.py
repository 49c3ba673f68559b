"""Two devices of Modbus RTU on one serial port: each by its address, one after the other."""

import pytest

from device.drivers.two_units import Two, where
from smarig.config import LinkFile
from smarig.core import ConfigError
from smarig.device.encoding.exchange import Exchange
from smarig.device.encoding.link_faults import Silent
from smarig.device.links.opening import opened

E_ = Exchange(0, 2)


@pytest.fixture
def two():
    with Two() as devices:
        yield devices


def test_each_device_answers_for_itself(two):
    a, b = opened(where(two), 65), opened(where(two), 100)
    assert [a.exchange(E_), b.exchange(E_), a.exchange(E_)] == [[65, 65], [100, 100], [65, 65]]
    a.close()
    assert b.exchange(E_) == [100, 100], "the port stays open for the other device"
    with pytest.raises(Silent, match="not open"):
        a.exchange(E_)
    b.close()


def test_a_late_reply_of_one_device_is_not_a_reply_of_the_other(two):
    a, b = opened(where(two), 65), opened(where(two), 100)
    two.late = True
    with pytest.raises(Silent):
        a.exchange(E_)
    two.late = False
    assert b.exchange(E_) == [100, 100]
    a.close()
    b.close()


def test_reopening_serves_both(two):
    a, b = opened(where(two), 65), opened(where(two), 100)
    a.reopen()
    assert [b.exchange(E_), a.exchange(E_)] == [[100, 100], [65, 65]]
    a.close()
    b.close()


def test_one_address_has_one_link(two):
    a = opened(where(two), 65)
    with pytest.raises(Silent, match="address 65"):
        opened(where(two), 65)
    assert a.exchange(E_) == [65, 65]
    a.close()
    opened(where(two), 65).close()


def test_one_port_has_one_baud_rate(two):
    a = opened(where(two), 65)
    with pytest.raises(ConfigError, match="115200"):
        opened(where(two, baud=9600), 100)
    a.close()


def test_one_port_has_one_format(two):
    a = opened(where(two), 65)
    with pytest.raises(ConfigError, match="open as 8N1 and cannot be opened as 8E1"):
        opened(where(two).model_copy(update={"serial_format": "8E1"}), 100)
    a.close()


def test_another_process_is_kept_out(two):
    a = opened(where(two), 65)
    lines = LinkFile(driver="smarig_amplifier", framing="lines", url=two.path)
    with pytest.raises(Silent):
        opened(lines, 65)  # a port of its own, as another process would open it
    a.close()
