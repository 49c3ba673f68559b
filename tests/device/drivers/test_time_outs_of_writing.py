"""A time-out of writing tells a line that takes no bytes from a computer that was late itself."""

import os
import socket
import threading
import tty

import pytest
import serial

from simulators.framed_device import PythonAmplifier
from simulators.lines import TextFraming
from smarig.device.encoding.exchange import Exchange
from smarig.device.encoding.link_faults import Silent
from smarig.device.links.serial_line import TEXT, SerialLine
from smarig.device.links.text_line import TextLine


@pytest.fixture
def pty():
    ours, theirs = os.openpty()
    tty.setraw(theirs)
    yield ours, os.ttyname(theirs)
    os.close(ours)
    os.close(theirs)


@pytest.fixture
def late_computer(monkeypatch):
    """Whenever pyserial looks at the time after it has sent, the time for it is over."""
    monkeypatch.setattr(serial.serialutil.Timeout, "expired", lambda self: self.duration is not None)


def test_a_late_computer_asks_and_hears_a_device(pty, late_computer):
    ours, path = pty
    device = PythonAmplifier(TextFraming())
    line = SerialLine(path, TEXT, 5.0)

    def answer():
        (request,) = device.framing.receiver().take(os.read(ours, 1000))
        os.write(ours, device.answer(request))

    threading.Thread(target=answer, daemon=True).start()
    assert len(line.exchange(Exchange(read_at=0, count=2))) == 2
    line.close()


def test_a_late_computer_commands_an_instrument_on_a_socket(late_computer):
    with socket.create_server(("127.0.0.1", 0)) as server:
        line = TextLine(f"tcp://127.0.0.1:{server.getsockname()[1]}", 9600, 5.0)
        line.write("CURR 0.1")
        connection, _ = server.accept()
        assert connection.recv(100) == b"CURR 0.1\n"
        connection.close()
        line.close()


def test_a_line_that_takes_nothing_is_named(pty):
    _, path = pty
    line = TextLine(path, 9600, 0.05)
    with pytest.raises(Silent, match="the device reads nothing, or its flow control holds the line"):
        line.write("X" * 100_000)
    line.close()
