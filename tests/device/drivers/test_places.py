"""Addresses of links: an invalid address gives an error message before anything is opened."""

import pytest

from smarig.config import load_rig
from smarig.core.errors import ConfigError
from smarig.device.links.opening import opened


@pytest.mark.parametrize(
    ("framing", "url"),
    [
        ("modbus_tcp", "tcp://[bad:502"),
        ("modbus_tcp", "tcp://a..b:502"),
        ("modbus_tcp", f"tcp://{'a' * 64}:502"),
        ("modbus_tcp", "tcp://h:0"),
        ("modbus_tcp", "tcp://h:99999"),
        ("modbus_tcp", "/dev/ttyUSB0"),
        ("lines", "socket://h"),
        ("lines", "socket://h:99999"),
        ("modbus_rtu", "rfc2217://[h"),
    ],
)
def test_an_invalid_address_is_reported(framing, url):
    links = load_rig("bench_one_wire").links
    with pytest.raises(ConfigError, match="is not an address of .*://HOST:PORT"):
        opened(links.amplifier.model_copy(update={"framing": framing, "url": url}), 65)


def test_a_pattern_that_is_none_is_a_line_that_is_not_there():
    links = load_rig("bench_one_wire").links
    with pytest.raises(Exception, match="Check its power"):
        opened(links.amplifier.model_copy(update={"framing": "lines", "url": "hwgrep://["}), 65)
