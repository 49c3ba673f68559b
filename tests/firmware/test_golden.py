"""Exchanges that the Python devices and the C firmware both reproduce byte by byte."""

import json

import pytest

from firmware.firmware_build import FIRMWARE, RTU, Device

GOLDEN = sorted((FIRMWARE.parent / "golden").glob("*.json"))


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_golden(library, path):
    golden = json.loads(path.read_text("utf-8"))
    device = Device(library, golden["device"], golden["boot_count"])
    for number, step in enumerate(golden["script"]):
        if "tick" in step:
            device.tick(*step["tick"])
        elif "now" in step:
            device.now(step["now"])
        else:
            assert reply(device, golden, step["request"]) == step["reply"], (
                f"step {number}: {step['request']}"
            )


def reply(device, golden, request):
    if golden["framing"] == "lines":
        return device.line(request)
    assert golden["framing"] == "rtu"
    return device.answer(bytes.fromhex(request), RTU, golden["address"]).hex() or None
