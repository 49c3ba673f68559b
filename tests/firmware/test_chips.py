"""The firmware as an ELF under the emulator of its chip, used over a pty: an AVR under simavr, a Cortex-M3 under QEMU.

Time is counted in the chip's ticks. Their real duration is checked with ``SMARIG_LONG``.
"""

import os
import time

from firmware.codes import ARMED, LEASE, NONE, REARM, TRIPPED
from firmware.firmware_build import frame, read_line, sealed, status_of
from smarig.device.encoding.register import from_words, load_register_map, to_words

MAP = load_register_map("amplifier")
WORDS = MAP.size("status")
LONG = bool(os.environ.get("SMARIG_LONG"))  # and a machine that keeps real time
PATIENCE_S = 60.0  # ends a test that has failed


def command(epoch, sequence, order, current, ring_next=0, nonce=0):
    words = [
        *to_words(sequence, 2),
        *to_words(epoch, 2),
        order,
        *to_words(current, 2),
        *to_words(ring_next, 2),
    ]
    return f"w 100 {' '.join(f'{word:x}' for word in (*words, 12, *to_words(nonce, 2)))} r 0 {WORDS:x}"


def nonce_of(chip):
    high, low = chip.line("r 15 2").words
    return high << 16 | low


def silent_until_tripped(chip, sequence):
    """Arms with 0.5 A, then only reads; the status when armed and the seconds until it tripped."""
    asked_s = time.monotonic()
    arming = command(_boots(chip), sequence, REARM, 500_000, nonce=nonce_of(chip))
    armed = status_of(MAP, chip.line(arming).words)
    assert (armed["echo"], armed["state"], armed["output"]) == (sequence, ARMED, 500_000)
    _until(lambda: chip.line("r 0 1").words != [ARMED])
    return armed, time.monotonic() - asked_s


def one_ohm(driven_uA):
    return f"in {driven_uA} {driven_uA} 2150 0"


def test_the_amplifier_on_its_chip(start):
    chip = start("amplifier_lines", one_ohm, watched=True)
    hello = chip.line("r 1 6").words
    assert hello[:4] == [0x5341, 5, *to_words(MAP.hash, 2)]
    limits = {r.name: r.safe for r in MAP.blocks["settings"]}
    limits |= {"current_max": 10**6, "slew_max": 10**5, "heat_max": 10**7}
    settings = MAP.encode("settings", limits)
    assert chip.line(f"w 200 {' '.join(f'{word:x}' for word in settings)}").code == 0

    for sequence in (1, 2, 3):  # again where other work holds up this process or the chip's
        armed, seconds = silent_until_tripped(chip, sequence)
        if 0.5 <= seconds <= 0.7 or not LONG:
            break
    assert 0.5 <= seconds <= 0.7 or not LONG
    assert (chip.line("r 0 1").words, chip.line("r 9 1").words) == ([TRIPPED], [LEASE])

    ended = status_of(MAP, chip.line(command(_boots(chip), 4, NONE, 0, ring_next=armed["tick"] + 1)).words)
    assert [marks for *_, marks in ended.samples[:6]] == [0] * 5 + [2]  # the lease lasts five ticks
    assert ended.samples[5][:4] == (500_000, 500_000, 500_000, 2150)

    boots = _boots(chip)
    chip.tell("hang")  # with interrupts still running: only the watchdog helps
    _until(lambda: _boots(chip) == boots + 1)
    chip.tell("reset")
    _until(lambda: _boots(chip) == boots + 2)
    _until(lambda: chip.driven_uA[-1] == 0)


def test_frames_end_by_silence(start):
    chip = start("encoder_daq_rtu", lambda _: "in -5 2000 4")
    request = frame(bytes.fromhex("64 03 000B 0002"))
    expected = frame(bytes.fromhex("64 03 04 FFFF FFFB"))

    def whole(reply):
        return len(reply) == len(expected)

    _until(lambda: chip.ask(request, whole, patience_s=0.5) == expected)  # it has been sampled
    assert (
        chip.ask(request + request, whole, patience_s=0.1) == b""
    )  # without a silence it is one frame, a wrong one
    assert chip.ask(bytes(300), whole, patience_s=0.1) == b""
    assert chip.ask(request, whole) == expected


def _boots(chip):
    """The boot count of a chip; 0 while there is no reply."""
    heard = chip.ask(f"{sealed('r 5 2')}\n".encode(), lambda reply: reply.endswith(b"\n"), patience_s=0.5)
    return from_words(read_line(heard.decode().strip()).words, "u32") if heard.startswith(b"=") else 0


def _until(holds):
    end_s = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < end_s
        time.sleep(0.005)
