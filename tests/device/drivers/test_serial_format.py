"""Data bits, parity and stop bits of a serial port: read from the rig file, and applied to the port."""

import errno
import os
from types import SimpleNamespace

import pytest

from smarig.config import LinkFile
from smarig.device import Silent
from smarig.device.links import visa_line
from smarig.device.links.opening import opened
from smarig.device.links.shared_text_line import shared_text_line
from smarig.device.links.visa_line import VisaLine

pty = pytest.importorskip("pty", reason="POSIX terminals")
termios = pytest.importorskip("termios")


@pytest.fixture
def url():
    host, device = pty.openpty()
    yield os.ttyname(device)
    os.close(host)
    os.close(device)


def link(url, **values):
    return LinkFile.model_validate({"driver": "./my.py", "framing": "lines", "url": url, **values})


def applied(port):
    return port.bytesize, port.parity, port.stopbits


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({}, (8, "N", 1)),
        ({"serial_format": "7E2"}, (7, "E", 2)),
        ({"serial_format": "8O1.5"}, (8, "O", 1.5)),
    ],
)
def test_a_text_line_has_the_format_of_its_link(url, values, expected):
    line = shared_text_line(link(url, **values))
    port = line.connection._port
    assert applied(port) == expected
    assert bool(termios.tcgetattr(port.fileno())[2] & termios.CSTOPB) == (expected[2] > 1), (
        "on the line itself"
    )
    line.close()


@pytest.mark.parametrize("framing", ["lines", "modbus_rtu"])
def test_a_line_of_registers_has_the_format_of_its_link(url, framing):
    line = opened(link(url, framing=framing, serial_format="7E2"), 65)
    assert applied(line._port.opened()) == (7, "E", 2)
    line.close()


@pytest.mark.parametrize("framing", ["lines", "modbus_rtu"])
def test_a_port_that_does_not_offer_the_format_says_so(url, framing, monkeypatch):
    """As the kernel answers for a port without seven data bits; nothing is wrong with its cable or power."""

    def refuse(*_):
        raise termios.error(errno.EINVAL, "Invalid argument")

    monkeypatch.setattr(termios, "tcsetattr", refuse)
    where = link(url, framing=framing, serial_format="7E1", baud=9600)
    with pytest.raises(
        Silent, match=r"does not offer 9600 baud with 7E1. Give another baud or serial_format.$"
    ):
        shared_text_line(where) if framing == "lines" else opened(where, 65)


def test_a_port_of_visa_has_the_format_of_its_link(url):
    """A pseudo-terminal takes two stop bits; it refuses another number of data bits by itself."""
    pytest.importorskip("pyvisa_py", reason="the extra visa is not installed")
    line = VisaLine(f"ASRL{url}::INSTR", 1.0, backend="@py", serial_format="8N2")
    session = line._manager.visalib.sessions[line._session.session]
    assert applied(session.interface) == (8, "N", 2)
    line.close()


@pytest.mark.parametrize(("resource", "given"), [("ASRL3::INSTR", True), ("TCPIP0::10.0.0.9::INSTR", False)])
def test_only_a_serial_port_of_visa_is_given_a_format(monkeypatch, resource, given):
    constants = pytest.importorskip("pyvisa.constants")
    session = SimpleNamespace(session=1)
    manager = SimpleNamespace(open_resource=lambda *_, **__: session, visalib=None, close=lambda: None)
    monkeypatch.setattr(visa_line, "_manager", lambda _: manager)
    VisaLine(resource, 1.0, serial_format="7E2")
    found = [getattr(session, name, None) for name in ("data_bits", "parity", "stop_bits")]
    assert found == ([7, constants.Parity.even, constants.StopBits.two] if given else [None] * 3)


@pytest.mark.parametrize("text", ["8N", "9N1", "7X1", "8N3", "7e2", "8N1 ", ""])
def test_what_is_no_format_is_one_sentence(text):
    with pytest.raises(ValueError, match=r'is no format of a serial line: write data bits .*, such as "7E2"'):
        link("/dev/ttyS0", serial_format=text)
