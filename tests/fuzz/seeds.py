"""The golden exchanges as scripts for the guided fuzzer (host/guided.c), so that it starts from active
devices.

python tests/fuzz/seeds.py FOLDER
"""

import json
import sys
from pathlib import Path

GOLDEN = Path(__file__).resolve().parents[2] / "firmware_protocol" / "golden"
ASK, AMPLIFIER, LINES, SEALED = 1, 2, 4, 8  # bits of the first byte of a request; bit 7 makes its length odd
LONGEST = 511  # bytes of a request in a script


def script(golden: dict) -> bytes:
    """Requests one after the other, a tick for each tick."""
    how = (
        ASK
        | (AMPLIFIER if golden["device"] == "amplifier" else 0)
        | (LINES if golden["framing"] == "lines" else 0)
    )
    said = b""
    for step in golden["script"]:
        if "request" in step:
            text = step["request"]
            body = text.encode() + b"\n" if golden["framing"] == "lines" else bytes.fromhex(text)
            if len(body) > LONGEST:
                continue
            said += bytes([how | (len(body) % 2) << 7, len(body) // 2]) + body
        else:
            said += bytes([SEALED]) + bytes(16)  # the current that is asked for flows; nothing else is seen
    return said


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for path in GOLDEN.glob("*.json"):
        (folder / path.stem).write_bytes(script(json.loads(path.read_text("utf-8")))[:4096])
