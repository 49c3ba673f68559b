"""The golden exchanges, byte by byte over the serial line of an emulated chip whose ticks the script gives.

Each program replays the scripts of its framing; those of Modbus RTU also the scripts of text, as frames.
simavr's program cannot be held. On an AVR the exchanges run as calls of the Uno's functions, see test_uno_golden.
"""

import json

import pytest

from firmware.architectures import cortex_m
from firmware.held_chip import HeldChip
from firmware.test_golden import GOLDEN
from firmware.test_uno_golden import as_rtu

SCRIPTS = [json.loads(path.read_text("utf-8")) for path in GOLDEN]
# device, framing, and how many requests there are for it: none is forgotten
KINDS = [
    ("amplifier", "rtu", 299),
    ("amplifier", "lines", 135),
    ("encoder_daq", "rtu", 28),
    ("encoder_daq", "lines", 22),
]


def requests(golden, framing):
    """The steps of a script in a framing, their requests as bytes."""
    for step in golden["script"]:
        if "request" not in step:
            yield step
        elif golden["framing"] == framing == "rtu":
            yield {"request": bytes.fromhex(step["request"]), "reply": bytes.fromhex(step["reply"] or "")}
        elif golden["framing"] == framing:
            reply = f"{step['reply']}\n" if step["reply"] else ""
            yield {"request": f"{step['request']}\n".encode("latin-1"), "reply": reply.encode()}
        elif framing == "rtu" and (both := as_rtu(golden["address"], step["request"], step["reply"])):
            yield dict(zip(("request", "reply"), both, strict=True))


@pytest.mark.parametrize(("device", "framing", "expected"), KINDS)
def test_golden(device, framing, expected, build_folder):
    chip = cortex_m(build_folder, f"{device}_{framing}", lambda _: "in 0 0 0 0")
    try:
        held = HeldChip(chip)
        scripts = [golden for golden in SCRIPTS if golden["device"] == device]
        assert sum(replayed(held, golden, framing) for golden in scripts) == expected
    finally:
        chip.close()


def replayed(held, golden, framing):
    """How many requests of a script were answered as it says."""
    held.boot(golden["boot_count"])
    compared = 0
    for number, step in enumerate(requests(golden, framing)):
        if "tick" in step:
            held.tick(*step["tick"])
        elif "now" in step:
            held.now(step["now"])
        elif step["request"]:
            assert held.answer(step["request"]) == step["reply"], f"{golden['title']} step {number}"
            compared += 1
    return compared
