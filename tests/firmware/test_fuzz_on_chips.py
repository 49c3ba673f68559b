"""Damaged, foreign and valid requests over the serial line of an emulated Cortex-M3: it answers each as the same
firmware does that was built for this machine, with ticks in between."""

import json
import random

import pytest

from firmware.architectures import cortex_m
from firmware.firmware_build import LINES, RTU, Device
from firmware.held_chip import HeldChip
from firmware.test_golden import GOLDEN
from firmware.test_golden_on_chips import requests
from firmware.test_uno_fuzz import damaged

SCRIPTS = [json.loads(path.read_text("utf-8")) for path in GOLDEN]
BOOT_COUNT = 7  # of the scripts, whose nonces begin with it
FOREIGN = 0.3  # of all frames come from no script
SPOILT = 0.4  # of the others are changed


def valid(device, framing):
    """The requests of the scripts."""
    scripts = [golden for golden in SCRIPTS if golden["device"] == device]
    steps = [step for golden in scripts for step in requests(golden, framing)]
    return [step["request"] for step in steps if step.get("request")]


def spoilt(chance, request):
    """One byte another, or the end missing; a line ends where it did."""
    body, end = (request[:-1], b"\n") if request.endswith(b"\n") else (request, b"")
    if not body or chance.random() < 0.2:
        return body[: len(body) // 2] + (end or b"\0")
    at = chance.randrange(len(body))
    byte = bytes([chance.choice([c for c in range(256) if c != ord("\n")])])
    return body[:at] + byte + body[at + 1 :] + end


def requests_of(chance, device, framing, count):
    known = valid(device, framing)
    for _ in range(count):
        if framing == "rtu" and chance.random() < FOREIGN:
            yield damaged(chance)
        else:
            request = chance.choice(known)
            yield spoilt(chance, request) if chance.random() < SPOILT else request


def inputs(chance, device):
    """Measurements of a tick: mostly quiet ones, so that not every tick trips."""
    first = chance.choice((0, 500_000, 1_000_000, chance.randrange(-(2**31), 2**31)))
    more = (5 * first % 2**31,) if device == "amplifier" else ()
    return (first, *more, chance.choice((2150, -32768)), chance.choice((0, 0, 0, 1, 2, 4)))


@pytest.mark.parametrize(
    "count",
    [700, pytest.param(20_000, marks=pytest.mark.long("a minute each"))],
)
@pytest.mark.parametrize(
    ("device", "framing"),
    [
        ("amplifier", "rtu"),
        ("encoder_daq", "lines"),
        pytest.param("amplifier", "lines", marks=pytest.mark.long("the library reads both framings alike")),
        pytest.param("encoder_daq", "rtu", marks=pytest.mark.long("the library reads both framings alike")),
    ],
)
def test_it_answers_as_the_library_does(device, framing, count, library, build_folder):
    chip = cortex_m(build_folder, f"{device}_{framing}", lambda _: "in 0 0 0 0")
    try:
        chance, twin = random.Random(f"{device} {framing}"), Device(library, device)
        accepted, refused = same(chance, HeldChip(chip), twin, framing, count)
    finally:
        chip.close()
    print(f"{count} requests: {accepted} accepted, {refused} refused")
    assert min(accepted, refused) > count / 20, "requests that are not understood test nothing"


def same(chance, chip, twin, framing, count):
    """Chip and library are given the same and reply the same; how many requests were accepted and refused."""
    device, measured = twin.map.device.name, (0,)
    chip.boot(BOOT_COUNT)
    replies = []
    for request in requests_of(chance, device, framing, count):
        if chance.random() < 0.1:
            measured = inputs(chance, device)
            chip.tick(*measured)
            twin.tick(*measured)
        if device == "encoder_daq":  # the program reads its counter before each reply; the library is told
            twin.now(measured[0])
        replies.append(twin.answer(request, LINES if framing == "lines" else RTU))
        assert chip.answer(request) == replies[-1], request
    bad = [reply[:1] == b"!" if framing == "lines" else bool(reply[1] & 0x80) for reply in replies if reply]
    return len(bad) - sum(bad), sum(bad)
