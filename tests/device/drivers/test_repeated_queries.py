"""A query that only reads and is not answered, or not by a reading, is asked once more, a command never; a broken line
is opened again.
"""

import contextlib
import socket
import threading

import pytest
import serial

from device.drivers.late_line import LOST, LatePort
from smarig.device.encoding.link_faults import Garbled, Silent
from smarig.device.links.query import only_reads
from smarig.device.links.text_line import TextLine

TIMEOUT_S = 0.3
NAME = "ACME,BOX-1,42,1.0"


class Box:
    """Acknowledges every line but its name's with the number of lines that it has heard, or with ``garbage``."""

    def __init__(self) -> None:
        self.heard: list[str] = []
        self.garbage: list[str] = []

    def reply(self, data: bytes) -> bytes:
        self.heard.append(data.decode().strip())
        if self.heard[-1] == "*IDN?":
            return f"{NAME}\n".encode()
        return f"{self.garbage.pop() if self.garbage else len(self.heard)}\n".encode()


@pytest.fixture
def line(monkeypatch):
    box = Box()
    port = LatePort(box.reply)
    port.timeout = TIMEOUT_S
    monkeypatch.setattr(serial, "serial_for_url", lambda *_, **__: port)
    line = TextLine("/dev/late", 9600, TIMEOUT_S)
    line.identify()
    box.heard.clear()
    return line, box, port


@pytest.mark.parametrize("late_s", [LOST, 1.3 * TIMEOUT_S])
def test_a_reading_that_is_lost_or_late_is_asked_once_more(line, late_s):
    line, box, port = line
    port.will_delay([late_s])
    assert line.number("MEAS:CURR?") == 3, "the answer to the second query"
    assert box.heard == ["MEAS:CURR?", "*IDN?", "MEAS:CURR?"]
    assert line.repeats == 1
    assert line.number("MEAS:CURR?") == 4
    assert line.repeats == 1


def test_a_reading_is_asked_twice_and_not_more_often(line):
    line, box, port = line
    port.will_delay([LOST, 0.0, LOST])
    with pytest.raises(Silent, match="does not answer MEAS:CURR"):
        line.ask("MEAS:CURR?")
    assert box.heard == ["MEAS:CURR?", "*IDN?", "MEAS:CURR?"]


GARBAGE = ["#@!!", "nan", "inf", "1.2.3", "ERR 42", "9" * 30, "9.91E37"]


@pytest.mark.parametrize("garbage", GARBAGE)
def test_a_reply_that_is_no_reading_is_asked_once_more(line, garbage):
    line, box, _ = line
    box.garbage = [garbage]
    assert line.number("MEAS:CURR?") == 3, "the answer to the second query"
    assert box.heard == ["MEAS:CURR?", "*IDN?", "MEAS:CURR?"]
    assert line.repeats == 1


@pytest.mark.parametrize("garbage", GARBAGE)
def test_and_not_more_often(line, garbage):
    line, box, _ = line
    box.garbage = [garbage] * 2
    with pytest.raises(Garbled, match="answers '.*' to MEAS:CURR.*Check baud rate"):
        line.number("MEAS:CURR?")
    assert box.heard == ["MEAS:CURR?", "*IDN?", "MEAS:CURR?"]


def test_a_garbled_acknowledgement_repeats_no_command(line):
    line, box, _ = line
    box.garbage = ["#@!!"]
    with pytest.raises(Garbled):
        line.number("SET 1")
    assert box.heard == ["SET 1"]


def test_a_command_that_is_acknowledged_may_come_first(monkeypatch):
    """The line then asks for the identity, so that no acknowledgement is taken for it."""
    box = Box()
    port = LatePort(box.reply)
    port.timeout = TIMEOUT_S
    monkeypatch.setattr(serial, "serial_for_url", lambda *_, **__: port)
    line = TextLine("/dev/late", 9600, TIMEOUT_S)
    assert line.ask("CURR 0", reads=False) == "2"
    assert (box.heard, line.identity) == (["*IDN?", "CURR 0"], NAME)


def test_a_network_has_no_baud_rate():
    with socket.create_server(("127.0.0.1", 0)) as server:
        box = Box()
        box.garbage = ["ERR 42"] * 2
        threading.Thread(target=_cuts_once, args=(server, box), daemon=True).start()
        line = TextLine(f"tcp://127.0.0.1:{server.getsockname()[1]}", 9600, 5.0)
        line.identify()
        with pytest.raises(Garbled) as error:
            line.number("MEAS:CURR?")
        line.close()
    assert "baud" not in str(error.value)
    assert str(error.value).endswith(Garbled.network_remedy)


def test_a_dead_line_is_given_up_soon(line):
    """The current may flow meanwhile: the lease or the next attempt to switch off must not wait for long."""
    line, _, port = line
    port.will_delay([LOST] * 20)
    begin_s = port.now_s
    with pytest.raises(Silent, match="does not answer MEAS:CURR"):
        line.ask("MEAS:CURR?")
    assert port.now_s - begin_s <= 3 * TIMEOUT_S + 1e-9


@pytest.mark.parametrize(
    "command", ["CURR 0.5", "CURR 0.5;CURR?", "set 1", "*TST?", "*ESR?", "OUTP?;OUTP ON", "MEAS"]
)
def test_a_command_is_sent_once(line, command):
    line, box, port = line
    assert not only_reads(command)
    port.will_delay([LOST])
    with pytest.raises(Silent):
        line.ask(command)
    assert box.heard == [command]
    assert line.repeats == 0


def test_the_driver_may_know_better(line):
    line, box, port = line
    port.will_delay([LOST])
    assert line.ask("r 1 5", reads=True) == "3"
    port.will_delay([LOST])
    with pytest.raises(Silent):
        line.ask("SYST:ERR?", reads=False)
    assert box.heard.count("SYST:ERR?") == 1


def test_a_connection_that_was_cut_is_opened_again_for_a_reading():
    with socket.create_server(("127.0.0.1", 0)) as server:
        box = Box()
        thread = threading.Thread(target=_cuts_once, args=(server, box), daemon=True)
        thread.start()
        line = TextLine(f"tcp://127.0.0.1:{server.getsockname()[1]}", 9600, 5.0)
        line.identify()
        assert line.number("MEAS:CURR?") == 2
        assert line.number("MEAS:CURR?") > 2, "over a new connection"
        assert line.reconnections == 1
        line.close()
        with pytest.raises(Silent):
            line.write("CURR 0")
        with pytest.raises(Silent):
            line.write("CURR 0")  # closed on purpose: it stays closed
        thread.join(60)


def _cuts_once(server, box):
    for answers in (2, 100):
        connection, _ = server.accept()
        with connection, connection.makefile("rb") as lines, contextlib.suppress(OSError):
            for _, text in zip(range(answers), lines):
                connection.sendall(box.reply(text))
