"""Random bytes and damaged frames on the Uno's line: no current, no reset, no overflow of the stack.

``SMARIG_LONG=1`` sends a million bytes and 4,000 frames, the default 6,000 and 60.
"""

import os
import random

import pytest

from firmware.codes import IS_OFF
from firmware.firmware_build import frame
from firmware.uno_emulator import AMPLIFIER

LONG = bool(os.environ.get("SMARIG_LONG"))
BYTES, FRAMES = (1_000_000, 4_000) if LONG else (6_000, 60)
CHUNK = 1000
LEAST_FREE = 48  # bytes of RAM


def damaged(chance):
    """A frame for one of both devices with random words, often with one wrong bit or cut short."""
    words = [
        chance.choice((0, 1, 2, 3, 100, 0xFFFF, chance.randrange(65536)))
        for _ in range(chance.randrange(1, 20))
    ]
    at = chance.choice((0x100, 0x200, chance.randrange(65536)))
    head = [0, chance.choice((1, 23, 119, chance.randrange(300))), at, len(words)]
    body = bytes([chance.choice((65, 100, 0, 7)), chance.choice((3, 16, 23, 23, chance.randrange(256)))])
    if body[1] != 16:
        body += b"".join(word.to_bytes(2, "big") for word in head[:2])
    if body[1] != 3:
        body += b"".join(word.to_bytes(2, "big") for word in (*head[2:],)) + bytes([2 * len(words)])
        body += b"".join(word.to_bytes(2, "big") for word in words)
    whole = bytearray(frame(body))
    if chance.random() < 0.3:
        whole[chance.randrange(len(whole))] ^= 1 << chance.randrange(8)
    return bytes(whole[: chance.randrange(1, len(whole))] if chance.random() < 0.2 else whole)


@pytest.mark.long("takes three seconds")
def test_a_request_during_a_reply_is_lost_and_does_not_change_it(uno):
    board = uno("--speed", "0.02")  # slow enough to speak in between on a busy machine
    request = frame(bytes([65, 3, 0, 0, 0, AMPLIFIER.size("status")]))
    length = 5 + 2 * AMPLIFIER.size("status")
    reply = board.ask(request, 1)
    reply += board.ask(frame(bytes([65, 3, 0, 0, 0, 1])), length - len(reply), begins=False)
    assert reply == frame(reply[:-2])
    assert board.ask(b"", 1, patience_s=0.5) == b""
    assert (len(reply), reply[:2]) == (length, bytes([65, 3]))


@pytest.mark.long("takes three seconds")
def test_noise_and_damaged_frames(uno):
    board, chance = uno(), random.Random(5)
    replies = 0
    for _ in range(BYTES // CHUNK):
        board.ask(chance.randbytes(CHUNK), 1, patience_s=0)
        board.go(CHUNK // 11)
    board.go(100)
    for _ in range(FRAMES):
        board.ask(damaged(chance), 1, patience_s=0)
        board.go(60)
        replies += bool(board.heard())
    board.go(100)
    board.heard()
    status = board.command_after_noise()
    assert (status["boot_count"], status["state"], status["output"]) == (1, IS_OFF, 0)
    free = board.free_ram()
    print(f"{replies} frames were answered; {free} bytes of RAM were never used")
    assert free >= LEAST_FREE
    assert replies > FRAMES / 20, "frames that no device answers test nothing"
    trace = board.close()
    assert trace.largest_uA.max() == 0
