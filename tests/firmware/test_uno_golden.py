"""The golden exchanges on the Uno's own program: its compiled functions are called in the emulated chip.

Exchanges of the text framing are asked as Modbus RTU, the board's only framing; what only text can say is left out.
The Uno keeps 32 samples, so the exchanges about full rings of 256 and 1024 samples end where the 33rd sample comes.
"""

import json
import re

import pytest

from firmware.firmware_build import frame
from firmware.test_golden import GOLDEN
from smarig.device.encoding.crc import crc16

RING = 32
LINE = re.compile(r"(?:w ([0-9A-Fa-f]+)((?: [0-9A-Fa-f]{1,4})+))? ?(?:r ([0-9A-Fa-f]+) ([0-9A-Fa-f]+))?$")
LONGEST_CALL = (
    1000  # hexadecimal digits of a frame that the emulator takes; longer ones are cut, and as wrong
)


def as_rtu(address, line, reply):
    """Request and reply of a line as frames; None if only text can say them."""
    body = line.split(" *")[0]
    match = LINE.fullmatch(body) if body else None
    refused = reply is None or reply.startswith("!")
    code = int(reply.split()[1]) if reply and refused else 0
    if not match or reply is None or code in (8, 9):
        return None
    words = [int(word, 16).to_bytes(2, "big") for word in (match[2] or "").split()]
    function = 3 if not words else 23 if match[3] else 16
    read = b"".join(int(n, 16).to_bytes(2, "big") for n in match.group(3, 4)) if match[3] else b""
    start = int(match[1], 16).to_bytes(2, "big") if words else b""
    write = (
        start + len(words).to_bytes(2, "big") + bytes([2 * len(words)]) + b"".join(words) if words else b""
    )
    request = frame(bytes([address, function]) + read + write)
    if code:
        return request, frame(bytes([address, function | 0x80, code]))
    data = b"".join(int(word, 16).to_bytes(2, "big") for word in reply.split(" *")[0].split()[1:])
    said = start + len(words).to_bytes(2, "big") if function == 16 else bytes([len(data)]) + data
    return request, frame(bytes([address, function]) + said)


def exchanges(golden):
    """The steps of a script that this board can take."""
    ticks = 0
    for step in golden["script"]:
        ticks += "tick" in step
        if ticks > RING:
            return
        if "request" not in step:
            yield step
        elif golden["framing"] == "rtu":
            yield {"request": step["request"][:LONGEST_CALL], "reply": step["reply"] or ""}
        elif both := as_rtu(golden["address"], step["request"], step["reply"]):
            yield {"request": both[0].hex(), "reply": both[1].hex()}


@pytest.fixture(scope="module")
def board(uno_folder, tmp_path_factory):
    from firmware.uno_emulator import Uno

    board = Uno(uno_folder, tmp_path_factory.mktemp("golden") / "trace.txt")
    board.tell("hold")  # no tick of its own between those of a script
    board.go(50)
    yield board
    board.close()


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_golden(board, path):
    golden = json.loads(path.read_text("utf-8"))
    device = "amp" if golden["device"] == "amplifier" else "daq"
    assert board.told(f"boot {device} {golden['boot_count']}") == ["done"]
    compared = 0
    for number, step in enumerate(exchanges(golden)):
        if "tick" in step:
            board.told(f"tick {device} {' '.join(map(str, step['tick']))}")
        elif "now" in step:
            board.told(f"now {step['now']}")
        else:
            reply = board.told(f"answer {device} {golden['address']} {step['request']}")[1:]
            assert "".join(reply) == step["reply"], f"step {number}: {step['request']}"
            compared += 1
    assert compared or path.stem == "daq_ring"


def test_frames_are_transcribed():
    request, reply = as_rtu(65, "w 0100 0001 r 0000 0001 *ABCD", "= 0001 *91C0")
    assert request[:-2].hex() == "4117" + "00000001" + "0100" + "0001" + "02" + "0001"
    assert crc16(request[:-2]) == int.from_bytes(request[-2:], "little")
    assert reply[:-2].hex() == "411702" + "0001"
    assert as_rtu(65, "r 0 1 *0000", "! 8 *0000") is None
