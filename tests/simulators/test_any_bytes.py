"""Arbitrary bytes: a reply, a refusal or no answer; rejected bytes change nothing."""

import random

from hypothesis import given
from hypothesis import strategies as st

from simulators.framed_device import PythonAmplifier, PythonDaq
from simulators.lines import TextFraming
from simulators.modbus import Rtu, Tcp
from smarig.device.encoding import lines, rtu
from smarig.device.encoding.crc import crc16
from smarig.device.encoding.exchange import Exchange, Refusal

FRAMINGS = (TextFraming(), Rtu(65), Tcp(65))
bits = st.binary(max_size=300)
words = st.lists(st.integers(0, 0xFFFF), max_size=130).map(tuple)
exchanges = st.builds(
    Exchange,
    st.sampled_from([0, 1, 0x14, 0x100, 0x200, 0xFFFF]),
    st.integers(0, 200),
    st.sampled_from([0, 0x100, 0x101, 0x200]),
    words,
)


def state(device) -> tuple:
    """All that a host could ever learn of a device."""
    blocks = (Exchange(0x100, device.map.size("command")), Exchange(0x200, device.map.size("settings")))
    return tuple(tuple(device.accept(e)) for e in (Exchange(0, device.map.size("status")), *blocks))


@given(st.sampled_from(FRAMINGS), bits)
def test_noise_is_never_an_exception_and_changes_nothing(framing, data):
    for device in (PythonAmplifier(framing), PythonDaq(framing)):
        before = state(device)
        for request in (data, bytes([65]) + data, data + crc16(data).to_bytes(2, "little")):
            reply = device.answer(request)
            assert reply is None or reply
        assert state(device) == before


@given(exchanges)
def test_what_is_refused_has_no_effect(exchange):
    for device in (PythonAmplifier(TextFraming()), PythonDaq(TextFraming())):
        before = state(device)
        if isinstance(device.accept(exchange), Refusal):
            assert state(device) == before


@given(st.sampled_from(FRAMINGS), st.lists(bits, max_size=6))
def test_receivers_take_any_noise(framing, chunks):
    receiver = framing.receiver()
    for chunk in chunks:
        for request in receiver.take(chunk) + receiver.silence():
            framing.decode(request)


@given(st.lists(st.integers(1, 20), min_size=1), st.booleans())
def test_requests_come_whole_however_they_are_cut(sizes, as_text):
    asked = [Exchange(0, 18, 0x100, (k, 0)) for k in range(1, 5)] + [
        Exchange(1, 5),
        Exchange(0, 0, 0x100, (9,)),
    ]
    framing = TextFraming() if as_text else Rtu(65)
    stream = b"".join(lines.request(e) if as_text else rtu.request(65, e) for e in asked)
    receiver, heard, at = framing.receiver(), [], 0
    while at < len(stream):
        size = sizes[at % len(sizes)]
        heard += receiver.take(stream[at : at + size])
        at += size
    assert [framing.decode(request).requested for request in heard] == asked


def test_over_tcp_requests_come_whole_and_a_wrong_header_ends_the_rest():
    request = bytes.fromhex("0102 0000 0006 41 03 0001 0005")
    receiver = Tcp(65).receiver()
    assert receiver.take(request[:3]) == []
    assert receiver.take(request[3:] + request + request[:5]) == [request, request]
    assert receiver.take(request[5:] + bytes.fromhex("0102 0001 0006") + request) == [request]
    assert receiver.take(request) == [request]
    other_unit = bytes.fromhex("0102 0000 0006 42 03 0001 0005")
    assert Tcp(65).decode(other_unit) is None


def test_noise_before_an_rtu_request_ends_with_silence():
    receiver = Rtu(65).receiver()
    request = rtu.request(65, Exchange(1, 5))
    assert receiver.take(random.Random(1).randbytes(5) + request) == []
    assert receiver.waits_for_silence
    (noisy,) = receiver.silence()
    assert Rtu(65).decode(noisy) is None
    assert receiver.take(request) == [request]
