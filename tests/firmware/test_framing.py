"""Both framings in C: which requests are answered, and how."""

import pytest

from firmware.firmware_build import LINES, RTU, frame, read_line, sealed

READ_STATE = bytes.fromhex("41 03 0000 0001")
SEVEN = "0000 0007 0000 0007"  # sequence 7 in boot 7
SEALED = sealed("w 100 0 7 0 7")
ARMING = f"{SEVEN} 0001 0000 0000 0000 0000 0000 0007 0000"  # arm, and the nonce of boot 7
WRITE = bytes.fromhex(f"41 10 0100 000C 18 {ARMING}")
BOTH = bytes.fromhex(f"41 17 0007 0002 0100 0005 0A {SEVEN} 0001")


def rtu(device, body):
    """The reply to a frame, without its check word, which is proved."""
    reply = device.answer(frame(body), RTU)
    assert reply == (frame(reply[:-2]) if reply else b"")
    return reply[:-2].hex()


def test_a_frame_that_others_have_published(amp):
    request = bytes.fromhex("01 03 0000 000A C5CD")
    reply = amp.answer(request, RTU, address=1)
    assert reply[:3].hex() == "010314"
    assert amp.answer(request, RTU) == b""  # for another address


def test_functions(amp):
    assert rtu(amp, READ_STATE) == "4103020000"
    assert rtu(amp, WRITE) == "41100100000c"
    assert rtu(amp, READ_STATE) == "4103020001"
    assert rtu(amp, BOTH) == "41170400000007"


@pytest.mark.parametrize(
    ("body", "reply"),
    [
        ("41 06 0100 0001", "418601"),
        ("41 83", "418301"),
        ("41 03 0079 0001", "418302"),
        ("41 03 0000 0000", "418303"),
        ("41 03 0000 007E", "418303"),
        ("41 03 0008", "418303"),
        ("41 03 0008 0001 00", "418303"),
        ("41 10 0100 0000 00", "419003"),
        ("41 10 0100 0002 03 0000 00", "419003"),
        ("41 10 0100 0002 06 0000 0007 0000", "419003"),
        ("41 10 0100 0002 04 0000", "419003"),
        ("41 10 0100 0001 02 0000 0007", "419003"),
        ("41 10 0100 0002 04 0000 0000", "419003"),
        ("41 10 0100 0001 02 0007", "419002"),  # half a sequence
        ("41 10 0000 0001 02 0007", "419002"),
        ("41 10 0100 0002 04 0000 0007 00", "419003"),
        (f"41 17 0000 0000 0100 0004 08 {SEVEN}", "419703"),
        ("41 17 0000 0001 0100 0000 00", "419703"),
        (f"41 17 0000 0001 0100 0007 0E {SEVEN} 0000 0000 0001", "419704"),
        (f"41 17 0000 0001 0100 0005 0A {SEVEN} 0001", "419704"),  # arm without a nonce
    ],
)
def test_exceptions_change_nothing(amp, body, reply):
    before = amp.memory
    assert rtu(amp, bytes.fromhex(body)) == reply
    assert amp.memory == before


def test_the_most_words_of_a_frame(amp):
    assert (
        rtu(amp, bytes.fromhex("41 10 0100 0079 F2") + bytes(242)) == "419002"
    )  # 121 fit, the block does not
    assert rtu(amp, bytes.fromhex("41 10 0100 007A F4") + bytes(244)) == "419003"
    assert rtu(amp, bytes.fromhex("41 03 0000 0079"))[:6] == "4103f2"


def test_what_is_not_answered(amp):
    before = amp.memory
    for wrong in (
        b"",
        b"\x41",
        frame(b"A"),
        frame(WRITE)[:-1],
        frame(b"\x00" + WRITE[1:]),
        frame(b"\x64" + WRITE[1:]),
    ):
        assert amp.answer(wrong, RTU) == b""
    assert amp.answer(frame(READ_STATE + bytes(300)), RTU) == b""  # longer than a frame can be
    for bit in range(8 * len(frame(WRITE))):  # any flipped bit is seen
        spoilt = bytearray(frame(WRITE))
        spoilt[bit // 8] ^= 1 << bit % 8
        assert amp.answer(bytes(spoilt), RTU) == b""
    assert amp.memory == before


def test_without_room_nothing_is_done(amp):
    before = amp.memory
    assert amp.answer(frame(WRITE), RTU, room=255) == b""
    assert amp.answer(f"{SEALED}\n".encode(), LINES, room=639) == b""
    assert amp.memory == before


def test_the_lines_of_the_contract(amp):
    current = "w 0100 0000 0001 0000 0007 0000 000F 4240 r 0000 000E"
    assert amp.line(sealed(current)) == sealed("! 4")  # understood: it is not armed
    assert amp.line(sealed("w 100 0 0")) == "! 3 *1F78"
    assert amp.line("r 0 12").startswith("! 2 ")
    assert amp.line("r 0 13").startswith("= 0000 5341 0005 ")
    arm = "w 0100 0000 0001 0000 0007 0001 000F 4240 0000 0000 0000 0007 0000 r 0000 000E"
    assert amp.line(sealed(arm)).startswith("= 0001 5341 0005 ")
    assert amp.output_uA == 1_000_000
    assert amp.line(sealed("w 100 0 2 0 7")) == sealed("=")
    assert amp.line(sealed("w 100 0 3 0 7") + "\r") == sealed("=")
    assert amp.line("r 0 1").startswith("= 0001 *")
    assert amp.line("r 7 2").startswith("= 0000 0003 *")


@pytest.mark.parametrize("line", ["", "\r"])
def test_an_empty_line_is_not_answered(amp, line):
    assert amp.line(line) is None


@pytest.mark.parametrize("begun", [b"", b"r 9 1", b"r 9 1\n "])
def test_what_is_no_whole_line_is_not_answered(amp, begun):
    assert amp.answer(begun, LINES) == b""


@pytest.mark.parametrize(
    ("line", "code"),
    [
        (SEALED[:-6], 8),
        (f"{SEALED[:-6]} *0000", 8),
        ("r 9 1 *0000", 8),
        (SEALED + "0", 9),
        (SEALED[:-1], 9),
        (sealed("w 100"), 9),
        (sealed("w"), 9),
        (sealed("r 9"), 9),
        (sealed("r 9 1 1"), 9),
        (sealed("r 9 1 w 100 0 7 0 7"), 9),
        (sealed("w 100 0 7 0 7r 9 1"), 9),
        (sealed("w  100 0 7 0 7"), 9),
        (sealed("w 100 0 7 0 7 "), 9),
        (sealed(" w 100 0 7 0 7"), 9),
        (sealed("w 100 0 7 0 7  r 9 1"), 9),
        (sealed("w 00100 0 7 0 7"), 9),
        (sealed("w 100 0 7 0 x"), 9),
        (sealed("W 100 0 7 0 7"), 9),
        (sealed(""), 9),
        (SEALED + "\r\r", 9),
        (sealed("w 100" + " 1" * 121), 2),
        (sealed("w 100" + " 1" * 122), 3),
        (sealed("w 100" + " 1" * 122)[:-6], 8),
        ("r 9 0", 3),
        ("r 0 7d", 2),
        ("r 0 7e", 3),
        ("r 9 ffff", 3),
        ("\xff\x00\x80", 9),
        ("r 9 1\n", 9),
        ("x" * 1001, 9),
    ],
)
def test_lines_that_are_refused_change_nothing(amp, line, code):
    before = amp.memory
    assert read_line(amp.line(line)).code == code
    assert amp.memory == before


def test_a_thousand_characters_and_no_more(amp):
    long = "w 100" + " 1" * 494  # 993 characters, and 6 of the check word
    assert read_line(amp.line(sealed(long) + "\r")).code == 3
    assert len(sealed(long + "1")) == 1000
    assert read_line(amp.line(sealed(long + "1"))).code == 3
    assert read_line(amp.line(sealed(long + "11"))).code == 9


def test_digits_in_either_case_and_of_any_length(amp):
    for line in ("r c 2", "r C 2", "r 000c 0002", "r 0C 02"):
        assert read_line(amp.line(line)).words == [0, 0]
    lower = sealed("r c 2").lower()
    assert read_line(amp.line(lower)).code == 0
