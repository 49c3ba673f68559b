"""The session in firmware_protocol/README.md, typed by hand: the device replies as printed there."""

from pathlib import Path

from simulators.amplifier import Amplifier
from simulators.framing import answer
from simulators.lines import TextFraming

README = Path(__file__).resolve().parents[2] / "firmware_protocol" / "README.md"


def test_the_documented_session_matches_the_device():
    device, framing = Amplifier(boot_count=1), TextFraming()
    session = [line for line in README.read_text("utf-8").splitlines() if line[:2] in ("> ", "< ", "(t")]
    said = None
    for line in session:
        if line.startswith("("):
            for _ in range(3):
                device.tick(100_000, 480_000, 2200, 0)
        elif line.startswith(">"):
            said = answer(device, framing, line[2:].encode())
        else:
            assert said == f"{line[2:]}\n".encode()
    assert len(session) == 17
    assert device.output_uA == 0
