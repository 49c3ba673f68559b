"""A reply that arrives after its timeout is never taken for the reply to another request, on any line.

The tests use a line with a simulated clock, on which Hypothesis chooses the delays, and then real ptys and
sockets, on which the test decides when the timeout expires and what arrives afterwards. Nothing depends on
the speed of a machine.
"""

import contextlib
import os
import select
import socket
import struct
import threading
import tty
from functools import partial

import pytest
import serial
from hypothesis import example, given
from hypothesis import strategies as st

from device.drivers.late_line import LOST, LatePort
from device.drivers.supply import Supply
from simulators.framed_device import PythonAmplifier
from simulators.lines import TextFraming
from simulators.modbus import Rtu
from smarig.device.drivers._conversation import Conversation
from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.device.encoding.link_faults import Garbled, Refused, Silent, Stale
from smarig.device.encoding.register import load_register_map
from smarig.device.links.modbus_tcp import ModbusTcp
from smarig.device.links.serial_line import TEXT, SerialLine, rtu_framing
from smarig.device.links.text_line import TextLine

MAP = load_register_map("amplifier")
TIMEOUT_S = 0.3
NEVER_S = 30.0  # time-out that only the test ends
FRAMINGS = {"lines": (TextFraming(), TEXT), "modbus_rtu": (Rtu(65), rtu_framing(65))}
SAFE = {r.name: r.safe for r in MAP.blocks["settings"]} | {"current_max": 1_000_000, "slew_max": 100_000}
NONE, ARM, OFF = 0, 1, 2
ARMING = {"order": ARM, "nonce": 1 << 16}  # of boot 1, before any order


class Device(PythonAmplifier):
    """Notes what it has answered to what."""

    def __init__(self, framing) -> None:
        super().__init__(framing)
        self.answered: list[tuple[Exchange, list[int] | Refusal]] = []
        self.done: list[int] = []

    def accept(self, exchange):
        answer = super().accept(exchange)
        self.answered.append((exchange, answer))
        return answer

    def carry_out(self, values):
        self.done.append(values["sequence"])
        super().carry_out(values)

    def reply(self, data: bytes) -> bytes | None:
        (request,) = self.framing.receiver().take(data)
        return self.answer(request)


class Watched(Conversation):
    """Compares what it believes with what the device has answered to this very exchange, while it was made."""

    device: Device

    def _insisted(self, e, sequence=None):
        before, believed = len(self.device.answered), None
        try:
            words, retried = super()._insisted(e, sequence)
            believed = words
            return words, retried
        except Refused as refused:
            believed = Refusal(refused.code)
            raise
        finally:
            own = [answer for asked, answer in self.device.answered[before:] if asked == e]
            assert believed is None or believed in own, f"{believed} was no answer to {e}"


def operations(talk):
    """The operations of a host in a session: accepted, refused for two reasons, with and without sequence
    words."""
    settings = partial(talk.settings, SAFE)
    return (
        talk.handshake,
        partial(talk.settings, SAFE | {"lease": 900}),
        partial(talk.command, {"current": 1}),  # refused: not armed
        settings,
        partial(talk.command, ARMING),
        partial(talk.command, {"current": 5_000_000}),  # refused: too much
        partial(talk.command, {"current": 70_000}),
        settings,  # refused: armed
        partial(talk.command, {"current": 50_000}, 4),
        talk.handshake,
        partial(talk.command, {"order": OFF}),
        settings,
        talk.handshake,
        partial(talk.command, {}),
    )


def opened(port, monkeypatch):
    monkeypatch.setattr(serial, "serial_for_url", lambda *_, **__: port)


@pytest.fixture
def late(monkeypatch):
    """A conversation over a LatePort, by framing and delays."""

    def made(framing, delays_s):
        of_device, of_host = FRAMINGS[framing]
        device = Device(of_device)
        port = LatePort(device.reply, delays_s)
        opened(port, monkeypatch)
        talk = Watched(SerialLine("/dev/late", of_host, TIMEOUT_S, clock=port.clock), MAP)
        talk.device = device
        return talk, device, port

    return made


def sit(talk, device) -> list[str]:
    """Execute the whole session; every command is executed at most once."""
    told = []
    for operation in operations(talk):
        try:
            operation()
            told.append("done")
        except (Refused, Silent, Garbled, Stale) as error:
            told.append(type(error).__name__)
    assert len(device.done) == len(set(device.done))
    return told


ON_TIME = [
    *("done", "done", "Refused", "done", "done", "Refused", "done"),
    *("Refused", "done", "done", "done", "done", "done", "done"),
]


@pytest.mark.parametrize("framing", FRAMINGS)
def test_a_session_on_a_good_line_is_the_reference_for_the_others(late, framing):
    talk, device, _ = late(framing, ())
    assert sit(talk, device) == ON_TIME
    assert device.state == "off"


@pytest.mark.parametrize("framing", FRAMINGS)
@pytest.mark.parametrize("timeouts", [1.2, 2.5, 4.5])
def test_one_late_reply_never_answers_another_request(late, framing, timeouts):
    """For any late reply and any delay, the session continues as on a good line."""
    for which in range(30):
        talk, device, _ = late(framing, [0.0] * which + [timeouts * TIMEOUT_S])
        assert sit(talk, device) == ON_TIME, which


DELAYS = st.lists(st.sampled_from([0.0, 0.0, 0.0, 0.5, 1.2, 2.5, 4.5, 7.5, LOST]), max_size=80)


@pytest.mark.parametrize("framing", FRAMINGS)
def test_many_late_and_lost_replies_never_answer_another_request(late, framing):
    @given(DELAYS)
    @example([0, 0, 0, 0, 1.2, 0, 0, LOST, 1.2, 1.2, LOST])
    def holds(timeouts):
        talk, device, _ = late(framing, [t * TIMEOUT_S for t in timeouts])
        with contextlib.suppress(Silent, Garbled, Stale):
            talk.handshake()
            sit(talk, device)

    holds()


@pytest.mark.parametrize("framing", FRAMINGS)
def test_switching_off_does_not_wait_for_a_line_to_be_resynchronised(late, framing):
    """Replies may be lost for good while requests arrive."""
    talk, device, port = late(framing, ())
    talk.handshake()
    talk.settings(SAFE)
    talk.command(ARMING)
    talk.command({"current": 70_000})
    port.will_delay([LOST] * 1000)
    for _ in range(2):
        with pytest.raises(Silent):
            talk.command({})
    before = len(device.answered)
    with pytest.raises(Silent):
        talk.command({"order": OFF})
    assert device.answered[before][0].words[4] == OFF, "the first thing that is said"
    assert (device.state, device.output_uA) == ("off", 0)


# --- real ptys: the test ends the host's time-out and decides what arrives then
# --------------------------------


class Held:
    """Replies of a device behind a real pty. ``script``, per request: True sends what was kept and then the reply,
    None the reply alone, a number so many kept ones alone, and False nothing: the host's patience ends at once."""

    def __init__(self, device: Device) -> None:
        self.device, self.script, self.kept = device, [], []
        self.master, self._slave = os.openpty()
        tty.setraw(self.master)
        tty.setraw(self._slave)
        self.path = os.ttyname(self._slave)
        self.end_of_patience = lambda: None
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _serve(self) -> None:
        receiver = self.device.framing.receiver()
        with contextlib.suppress(OSError):
            while data := os.read(self.master, 4096):
                for request in receiver.take(data):
                    self._answered(self.device.answer(request))

    def _answered(self, reply: bytes) -> None:
        how = self.script.pop(0) if self.script else True
        if how is None:
            os.write(self.master, reply)
            return
        self.kept.append(reply)
        if how is False:
            self.end_of_patience()
            return
        now = self.kept if how is True else self.kept[:how]
        self.kept = [] if how is True else self.kept[how:]
        for one in now:
            os.write(self.master, one)

    def close(self) -> None:
        os.close(self._slave)
        self._thread.join(60)
        os.close(self.master)


@pytest.fixture
def held(monkeypatch):
    """A conversation over a real pty, and who holds the replies back."""
    made = []

    def make(framing):
        of_device, of_host = FRAMINGS[framing]
        there = Held(Device(of_device))
        line = SerialLine(there.path, of_host, NEVER_S)
        there.end_of_patience = lambda: line._port.opened().cancel_read()
        talk = Watched(line, MAP)
        talk.device = there.device
        made.append((there, line))
        talk.handshake()
        talk.settings(SAFE)
        return talk, there

    yield make
    for there, line in made:
        line.close()
        there.close()


@pytest.mark.parametrize("framing", FRAMINGS)
def test_a_late_refusal_is_not_the_next_commands_over_a_real_line(held, framing):
    talk, there = held(framing)
    there.script = [False, 1]  # refused twice; the first refusal comes late, the second is kept
    with pytest.raises(Refused):
        talk.command({"current": 1})
    there.script = [1]  # the next request gets that refusal, and its own reply only with a later request
    status = talk.command(ARMING)
    assert status.values["state"] == 1
    assert there.device.done.count(status.values["echo"]) == 1


@pytest.mark.parametrize("framing", FRAMINGS)
def test_a_late_status_is_not_the_next_handshakes_over_a_real_line(held, framing):
    """Otherwise the first command after it could carry the word that the device has just received, and be
    ignored."""
    talk, there = held(framing)
    there.script = [False, 1]
    talk.handshake()  # by the late reply to its first attempt
    talk.command(ARMING)
    assert talk.handshake()["state"] == 1
    assert talk.command({"order": OFF}).values["state"] == 0


@pytest.mark.parametrize("framing", FRAMINGS)
def test_late_settings_are_not_the_next_ones_over_a_real_line(held, framing):
    talk, there = held(framing)
    there.script = [False, 1]
    talk.settings(SAFE | {"lease": 900})
    talk.settings(SAFE | {"lease": 600})
    assert there.device.stored["lease"] == 600


# --- lines of text that say nothing of their question ----------------------------------------------------------------


class Meter:
    """Counts requests; every reply is different."""

    def __init__(self) -> None:
        self.asked = 0
        self.heard: list[str] = []

    def reply(self, data: bytes) -> bytes | None:
        text = data.decode().strip()
        self.heard.append(text)
        if not text.endswith("?"):
            return None
        self.asked += 1
        return b"ACME,M,0,1.0\n" if text == "*IDN?" else f"{self.asked}\n".encode()


@given(st.lists(st.sampled_from([0.0, 0.0, 0.5, 1.2, 2.5, 4.5, LOST]), max_size=40))
@example([0, 1.2, 0, 0])
@example([0, LOST, 2.5, 1.2, 0, 0])
def test_a_number_is_the_answer_to_its_own_question(timeouts):
    meter = Meter()
    port = LatePort(meter.reply, [0.0, *(t * TIMEOUT_S for t in timeouts)])
    port.timeout = TIMEOUT_S
    with pytest.MonkeyPatch.context() as patch:
        opened(port, patch)
        line = TextLine("/dev/late", 9600, TIMEOUT_S)
    assert line.identify() == "ACME,M,0,1.0"
    answered = 0
    for _ in range(12):
        with contextlib.suppress(Silent):
            assert line.number("MEAS?") == meter.asked
            assert meter.heard[-1] == "MEAS?"
            answered += 1
    assert answered or LOST in timeouts or 4.5 in timeouts or len(timeouts) > 3


def test_replies_requested_by_another_process_are_not_an_identity():
    meter = Meter()
    port = LatePort(meter.reply, [0.1, 0.1])
    port.timeout = TIMEOUT_S
    with pytest.MonkeyPatch.context() as patch:
        opened(port, patch)
        line = TextLine("/dev/late", 9600, TIMEOUT_S)
    port.write(b"MEAS?\n")
    assert line.identify() == "ACME,M,0,1.0"
    assert line.number("MEAS?") == meter.asked == 3


def test_a_late_zero_does_not_confirm_that_a_supply_is_off():
    """A late reading of the current from the time when it was off does not confirm that it is off now."""
    supply = Supply()
    line = TextLine(supply.port, 9600, NEVER_S)
    try:
        assert line.identify() == supply.identity
        supply.keep_back(1, then=lambda: line._port.cancel_read())
        with pytest.raises(Silent):
            line.number("MEAS:CURR?", reads=False)  # asked once
        supply.stuck = True
        line.write("OUTP ON")
        line.write("OUTP OFF")
        assert line.number("OUTP?") == 1
        assert supply.heard[-2:] == ["*IDN?", "OUTP?"]
    finally:
        line.close()
        supply.close()


# --- Modbus TCP ------------------------------------------------------------------------------------------------------


def test_over_tcp_a_late_reply_whole_or_half_comes_to_nobody():
    """Half a reply comes in time; the other half, and a whole late one, only with the third request."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        thread = threading.Thread(target=_answers_late, args=(listening,), daemon=True)
        thread.start()
        link = ModbusTcp("127.0.0.1", listening.getsockname()[1], 65, 0.2)
        for _ in range(2):
            with pytest.raises(Silent):
                link.exchange(Exchange(0, 1))
        link._client.comm_params.timeout_connect = NEVER_S
        assert link.exchange(Exchange(0, 1)) == [3]
        link.close()
        thread.join(60)


def _answers_late(listening):
    channels, late, number = [listening], [], 0
    while number < 3:
        for channel in select.select(channels, [], [])[0]:
            if channel is listening:
                channels.append(listening.accept()[0])
            elif request := channel.recv(1024):
                number += 1
                reply = request[:4] + struct.pack(">HBBBH", 5, 65, 3, 2, number)
                if number == 1:
                    channel.sendall(reply[:7])
                late.append((channel, reply[7:] if number == 1 else reply))
            else:
                channels.remove(channel)
    for channel, reply in late:
        with contextlib.suppress(OSError):
            channel.sendall(reply)
    for channel, _ in late:
        channel.close()
