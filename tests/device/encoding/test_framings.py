"""Requests and replies as bytes: known vectors, round trips with independent code, and arbitrary bytes."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymodbus.framer import FramerRTU
from pymodbus.pdu import DecodePDU
from pymodbus.pdu.register_message import (
    ReadHoldingRegistersRequest,
    ReadWriteMultipleRegistersRequest,
    WriteMultipleRegistersRequest,
)

from smarig.device.encoding import lines, rtu
from smarig.device.encoding.crc import crc16
from smarig.device.encoding.exchange import Exchange, Refusal

WORD = st.integers(0, 0xFFFF)
EXCHANGES = st.one_of(
    st.builds(Exchange, WORD, st.integers(1, 125)),
    st.builds(Exchange, st.just(0), st.just(0), WORD, st.lists(WORD, min_size=1, max_size=121).map(tuple)),
    st.builds(Exchange, WORD, st.integers(1, 125), WORD, st.lists(WORD, min_size=1, max_size=121).map(tuple)),
)


def framed(body: bytes) -> bytes:
    return body + struct.pack(
        "<H", FramerRTU.compute_CRC(body) >> 8 | (FramerRTU.compute_CRC(body) & 0xFF) << 8
    )


def granted(address: int, e: Exchange, words: list[int]) -> bytes:
    """The reply of a device, as the Modbus specification has it."""
    if not e.count:
        return framed(struct.pack(">BBHH", address, 16, e.write_at, len(e.words)))
    return framed(struct.pack(f">BBB{len(words)}H", address, 23 if e.words else 3, 2 * len(words), *words))


def text_reply(words: list[int]) -> bytes:
    body = "=" + "".join(f" {word:04X}" for word in words)
    return f"{body} *{crc16(body.encode()):04X}\n".encode()


def test_the_check_word_is_that_of_the_modbus_specification():
    assert crc16(b"123456789") == 0x4B37
    assert crc16(bytes.fromhex("02 07")) == 0x1241  # the specification's own example, low byte 41 first


@given(EXCHANGES, st.integers(1, 247))
def test_pymodbus_reads_our_requests(e, address):
    body = rtu.request(address, e)
    assert framed(body[:-2]) == body
    pdu = DecodePDU(True).decode(body[1:-2])
    if not e.words:
        assert isinstance(pdu, ReadHoldingRegistersRequest)
        assert (pdu.address, pdu.count) == (e.read_at, e.count)
    elif not e.count:
        assert isinstance(pdu, WriteMultipleRegistersRequest)
        assert (pdu.address, tuple(pdu.registers)) == (e.write_at, e.words)
    else:
        assert isinstance(pdu, ReadWriteMultipleRegistersRequest)
        assert (pdu.read_address, pdu.read_count) == (e.read_at, e.count)
        assert (pdu.write_address, tuple(pdu.write_registers)) == (e.write_at, e.words)


@given(EXCHANGES, st.data())
def test_a_reply_is_found_in_noise_but_not_before_it_is_whole(e, data):
    words = data.draw(st.lists(WORD, min_size=e.count, max_size=e.count))
    noise = data.draw(st.binary(max_size=9))
    cut = data.draw(st.integers(1, 5))
    for reply, find in (
        (granted(65, e, words), lambda received: rtu.find(65, e, received)),
        (text_reply(words), lambda received: lines.find(e, received)),
    ):
        assert find(noise.replace(b"\n", b"") + reply) == words
        assert find(reply[:-cut]) is None


@pytest.mark.parametrize("code", [1, 2, 3, 4])
def test_a_refusal_is_distinguished_from_a_reply(code):
    e = Exchange(0, 10, 0x100, (7,))
    assert rtu.find(65, e, b"\x00\xff1" + framed(bytes([65, 23 | 0x80, code]))) == Refusal(code)
    body = f"! {code}"
    assert lines.find(e, f"{body} *{crc16(body.encode()):04X}\r\n".encode()) == Refusal(code)


def test_replies_of_others_to_others_and_of_other_lengths_are_none():
    e = Exchange(0, 2)
    assert rtu.find(65, e, granted(66, e, [1, 2])) is None
    assert rtu.find(65, e, granted(65, Exchange(0, 3), [1, 2, 3])) is None
    assert rtu.find(65, e, granted(65, Exchange(0, 2, 0x100, (1,)), [1, 2])) is None
    assert lines.find(e, text_reply([1, 2, 3])) is None


@given(EXCHANGES, st.binary(max_size=300))
def test_any_bytes_are_a_reply_or_none(e, received):
    for found in (rtu.find(65, e, received), lines.find(e, received)):
        assert found is None or isinstance(found, Refusal) or len(found) == e.count


@given(EXCHANGES, st.data())
def test_one_wrong_bit_is_no_reply(e, data):
    """A check word of 16 bits finds every single wrong bit."""
    words = data.draw(st.lists(WORD, min_size=e.count, max_size=e.count))
    for reply, find in (
        (granted(65, e, words), lambda received: rtu.find(65, e, received)),
        (text_reply(words)[:-1], lambda received: lines.find(e, received + b"\n")),
    ):
        bit = data.draw(st.integers(0, 8 * len(reply) - 1))
        wrong = bytearray(reply)
        wrong[bit // 8] ^= 1 << bit % 8
        assert find(bytes(wrong)) is None
