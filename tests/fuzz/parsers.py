"""Coverage-guided fuzzing of every Python parser of bytes with atheris: each finds a reply, refuses, or
finds nothing.

python tests/fuzz/parsers.py CORPUS -max_total_time=60
"""

import sys
from pathlib import Path

import atheris

sys.path.append(str(Path(__file__).resolve().parents[2]))

with atheris.instrument_imports(include=["smarig.device.encoding", "simulators"]):
    from simulators.amplifier import Amplifier
    from simulators.encoder_daq import EncoderDaq
    from simulators.framing import answer
    from simulators.lines import TextFraming
    from simulators.modbus import Rtu, Tcp
    from smarig.device.encoding import lines, rtu
    from smarig.device.encoding.crc import crc16
    from smarig.device.encoding.exchange import Exchange, Refusal

ADDRESS = 65
FRAMINGS = (TextFraming(), Rtu(ADDRESS), Tcp(ADDRESS))
ASKED = (Exchange(0, 18, 0x100, (1, 2, 3)), Exchange(0, 1), Exchange(0, 0, 0x200, (7,)))


def one(data: bytes) -> None:
    """One input: its first byte selects the parser, the rest is the received data."""
    if len(data) < 2:
        return
    how, heard = data[0], data[1:]
    if how & 4:
        body = heard[:-1] if how & 8 else heard
        check = crc16(body)
        heard = body + (f" *{check:04X}\n".encode() if how & 1 else check.to_bytes(2, "little"))
    if how & 2:
        reply(ASKED[how % 3], heard, text=bool(how & 1))
    else:
        request(Amplifier() if how & 16 else EncoderDaq(), FRAMINGS[how // 32 % 3], heard)


def reply(e: Exchange, heard: bytes, *, text: bool) -> None:
    """The host's parser: words of the requested length, a refusal, or nothing."""
    found = lines.find(e, heard) if text else rtu.find(ADDRESS, e, heard)
    if found is not None and not isinstance(found, Refusal):
        assert len(found) == e.count, "another length than was asked for"
        assert all(0 <= word <= 0xFFFF for word in found)


def request(device, framing, heard: bytes) -> None:
    """The device's parser: a reply or nothing, and never a current without arming."""
    receiver = framing.receiver()
    for whole in [*receiver.take(heard), *receiver.silence()]:
        if whole:
            said = answer(device, framing, whole)
            assert said is None or said
    assert getattr(device, "output_uA", 0) == 0 or device.state == "armed"


if __name__ == "__main__":
    atheris.Setup(sys.argv, one)
    atheris.Fuzz()
