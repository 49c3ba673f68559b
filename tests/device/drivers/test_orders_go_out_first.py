"""An order to zero is on the wire before anything else, whatever was lost; its acknowledgement is no answer."""

import contextlib
import threading
import time

import pytest
import serial
from hypothesis import given
from hypothesis import strategies as st

from device.drivers.late_line import LOST, LatePort
from simulators.text_instrument import SimulatedBox
from smarig.cli import run as cli
from smarig.config import LinkFile, load_rig
from smarig.core.catalogue import own_files
from smarig.device.encoding.link_faults import Garbled, Silent
from smarig.device.links.text_line import TextLine
from smarig.rig.open_rig import instrument_of

TIMEOUT_S = 0.3
NAME = "ACME,BOX-1,42,1.0"
RIG = load_rig("bench_one_wire")


class Acknowledges(SimulatedBox):
    """It answers each command with OK and has no watchdog. ``mute``: its answers are lost, and it still obeys."""

    def __init__(self) -> None:
        self.mute, self.heard, self.zeroed = False, [], threading.Event()
        super().__init__(1.0, lambda _: None, lambda: 5.0, lambda: 2.0)

    def _answer(self, line):
        self.heard.append((time.monotonic(), line))
        found = super()._answer(line)
        if line == "CURR 0":
            self.zeroed.set()
        return None if self.mute else found or "OK"

    @property
    def lines(self):
        return [line for _, line in self.heard]


@pytest.fixture
def box():
    made = Acknowledges()
    yield made
    made.close()


@pytest.fixture
def opened(box, tmp_path, monkeypatch):
    """How the driver of ``smarig new driver`` opens the box, once changed as its comments say."""
    monkeypatch.chdir(tmp_path)
    assert cli(["new", "driver", "deaf"]) == 0
    file = tmp_path / "deaf.py"
    text = file.read_text()
    watchdog = text[
        text.index('        self.line.write(\n            f"SYST:WDOG') : text.index("    def set_current")
    ]
    assert text.count("acknowledged=False") == 1
    file.write_text(text.replace("acknowledged=False", "acknowledged=True").replace(watchdog, "\n"))
    link = LinkFile(driver=str(file), framing="lines", url=box.url, timeout_s=TIMEOUT_S)
    with own_files():
        yield lambda: instrument_of(link, RIG)


def test_zero_arrives_at_once_though_every_reply_is_lost(box, opened):
    source = opened()
    source.arm()
    source.set_current(0.4)
    assert source.measure()[:2] == (pytest.approx(0.4), pytest.approx(2.0))
    box.mute = True
    with pytest.raises(Silent):
        source.measure()
    assert box.flows_A == 0.4
    for _ in range(2):  # as often as it is asked to
        box.heard.clear()
        begin_s = time.monotonic()
        assert "It has no lease: switch it off by hand now." in source.off()
        arrived_s, first = box.heard[0]
        assert first == "CURR 0"
        assert arrived_s - begin_s < TIMEOUT_S
        assert box.lines.count("CURR 0") == box.lines.count("OUTP OFF") == 2
        assert box.flows_A == 0.0
    box.mute = False
    assert source.off() == ""
    source.arm()
    source.set_current(0.3)
    assert source.measure()[:2] == (pytest.approx(0.3), pytest.approx(1.5)), "no acknowledgement is a reading"
    source.close()


def test_an_output_that_was_left_on_goes_off_before_anybody_answers(box, opened):
    source = opened()
    source.arm()
    source.set_current(0.4)
    source.close()  # the host was killed
    box.mute = True
    box.heard.clear()
    with pytest.raises(Silent):
        opened()
    assert box.lines[0] == "OUTP OFF"
    assert box.flows_A == 0.0


def test_a_command_that_is_asked_goes_out_in_the_end(box):
    line = TextLine(box.url, 9600, 0.05)
    line.identify()
    box.mute = True
    for _ in range(2):
        box.zeroed.clear()
        with pytest.raises(Silent):
            line.ask("CURR 0", reads=False)
        assert box.zeroed.wait(60.0)
    line.close()


class Counts:
    """Acknowledges every line but its name's with the number of lines that it has heard, after ``says``."""

    def __init__(self, says: str) -> None:
        self.says, self.heard = says, []

    def reply(self, data: bytes) -> bytes:
        self.heard.append(data.decode().strip())
        said = self.says if self.heard[-1] == "CURR 0" else ""
        return f"{NAME if self.heard[-1] == '*IDN?' else f'{said}{len(self.heard)}'}\n".encode()


def counted(delays_s=(), says=""):
    box = Counts(says)
    port = LatePort(box.reply, delays_s)
    port.timeout = TIMEOUT_S
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(serial, "serial_for_url", lambda *_, **__: port)
        return TextLine("/dev/late", 9600, TIMEOUT_S, acknowledged=True), box, port


def test_an_acknowledgement_costs_no_query():
    line, box, _ = counted()
    line.identify()
    line.write("CURR 0")
    assert line.number("MEAS?") == 3
    assert box.heard == ["*IDN?", "CURR 0", "MEAS?"]


@pytest.mark.parametrize("late_s", [0.0, 0.9 * TIMEOUT_S, LOST])
def test_an_acknowledgement_is_no_identity(late_s):
    line, box, _ = counted([late_s], says="OK ")
    line.write("CURR 0")
    line.write("CURR 0")
    assert line.identify() == NAME
    assert box.heard[0] == "CURR 0"
    assert line.number("MEAS?") == len(box.heard)


ORDERS_AND_QUERIES = st.lists(st.sampled_from(["CURR 0", "MEAS?"]), min_size=1, max_size=8)
TIMEOUTS = st.lists(st.sampled_from([0.0, 0.0, 0.5, 1.2, 2.5, LOST]), max_size=20)


@given(ORDERS_AND_QUERIES, TIMEOUTS)
def test_orders_go_out_at_once_and_no_reading_is_an_acknowledgement(sent, timeouts):
    line, box, port = counted()
    line.identify()
    port.will_delay([t * TIMEOUT_S for t in timeouts])
    for text in sent:
        if text == "CURR 0":
            before, begin_s = len(box.heard), port.now_s
            line.write(text)
            assert box.heard[before:] == [text], "first, and once"
            assert port.now_s - begin_s <= TIMEOUT_S + 1e-9
            continue
        with contextlib.suppress(Silent, Garbled):
            assert line.number(text) == len(box.heard)
