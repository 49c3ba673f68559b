"""Frames said again to emulated chips whose counting begins just below a wrap: on an AVR and on a Cortex-M3.

Ticks are given by the test: on the AVR the functions of the Uno's program are called in the chip, the Cortex-M3 runs
its program held. Then both architectures run their programs in their own time, and count their own boots.
"""

import os
import time

import pytest

from firmware.architectures import ARCHITECTURES, AVR, CORTEX_M, cortex_m
from firmware.codes import ARM, LEASE, OFF, TRIPPED
from firmware.firmware_build import make
from firmware.held_chip import HeldChip
from firmware.replayed_day import ADDRESS, LAST, MAP, survive
from firmware.uno_emulator import Uno, build
from smarig.device.encoding.register import from_words

EXCHANGES = int(os.environ.get("SMARIG_EXCHANGES", "60"))  # a day at 10 Hz: 864,000
AHEAD = 400  # lines: they and their answers fit into a pipe
PATIENCE_S = 60.0  # ends a test that has failed
WRAPS = {
    "a word": (2**16 - 20, 2**16 - 15, (7, 8)),
    "half of all": (2**31 - 20, 2**31 - 15, (7, 7 + 2**16)),
    "the end of all": (LAST - EXCHANGES, 2**32 - 15, (2**32 - 1, 0)),
}


def one_of(names, always=None):
    """All of them; all but one where there is time (``SMARIG_LONG``, as in ``.ci/long``)."""
    long = pytest.mark.long("takes up to ten seconds")
    return [name if name == always else pytest.param(name, marks=long) for name in names]


def begun(folder, wrap):
    """A folder to build in, the Makefiles' variables, and the two boots of a campaign."""
    sequence, tick, boots = WRAPS[wrap]
    return folder / f"{sequence}", (f"FIRST_SEQUENCE={sequence}", f"FIRST_TICK={tick}"), boots


class Called:
    """The amplifier of an Uno, whose functions are called in the chip."""

    def __init__(self, board):
        self._board = board
        board.tell("hold")
        board.go(50)

    def boot(self, boot_count):
        assert self._board.told(f"boot amp {boot_count}") == ["done"]

    def tick(self, *inputs):
        self.carry_out([inputs])

    def answer(self, request):
        return self.carry_out([request])[0]

    def carry_out(self, steps):
        """The replies to frames, with ticks between them; the board reads ahead."""
        replies = []
        for start in range(0, len(steps), AHEAD):
            some = steps[start : start + AHEAD]
            self._board.tell("\n".join(self._line(s) for s in some))
            said = [self._board.process.stdout.readline().split() for _ in some]
            assert all(w[0] == (b"reply" if isinstance(s, bytes) else b"done") for w, s in zip(said, some))
            replies += [
                bytes.fromhex(b"".join(w[1:]).decode()) for w, s in zip(said, some) if isinstance(s, bytes)
            ]
        return replies

    def _line(self, step):
        if isinstance(step, bytes):
            return f"answer amp {ADDRESS} {step.hex()}"
        return f"tick amp {' '.join(map(str, step))}"


@pytest.mark.parametrize("wrap", one_of(WRAPS, "a word"))
def test_no_frame_is_new_again_on_an_avr(build_folder, tmp_path, wrap):
    folder, variables, boots = begun(build_folder / "uno", wrap)
    build(folder, "uno_emulator")
    build(folder, "uno.elf", *variables)
    board = Uno(folder, tmp_path / "trace.txt")
    said = survive(Called(board), EXCHANGES, boots)
    board.close()
    assert said >= 2 * EXCHANGES


@pytest.mark.parametrize("wrap", one_of(WRAPS, "the end of all"))
def test_no_frame_is_new_again_on_a_cortex_m(build_folder, wrap):
    folder, variables, boots = begun(build_folder / "cortex_m", wrap)
    make(folder, "cortex_m_amplifier_rtu.elf", CORTEX_M, *variables)
    chip = cortex_m(folder, "amplifier_rtu", lambda _: "in 0 0 0 0")
    try:
        said = survive(HeldChip(chip), EXCHANGES, boots)
    finally:
        chip.close()
    assert said >= 2 * EXCHANGES


# --- in their own time ---

LEASE_MS, PERIOD_MS = 2000, 100
DRIVEN_uA = 500_000


class Host:
    """A host on the serial line of a chip, that keeps what it says."""

    def __init__(self, chip):
        self._chip, self.said = chip, []
        self._sequence, self._epoch = read(chip, "echo"), read(chip, "boot_count")
        safe = {r.name: r.safe for r in MAP.blocks["settings"]} | {"period": PERIOD_MS, "lease": LEASE_MS}
        limits = safe | {"current_max": 10**6, "slew_max": 10**6, "heat_max": 2**32 - 1}
        assert chip.line(f"w 200 {words('settings', limits)}").code == 0

    def command(self, **values):
        self._sequence += 1
        proof = {"sequence": self._sequence, "epoch": self._epoch}
        self.said.append(f"w 100 {words('command', proof | values)} r 0 1")
        assert self._chip.line(self.said[-1]).code == 0
        assert read(self._chip, "echo") == self._sequence

    def work(self, count):
        self.command(order=OFF)
        self.command(order=ARM, nonce=read(self._chip, "arm_nonce"))
        for _ in range(count):
            self.command(current=DRIVEN_uA)
        assert read(self._chip, "output") == DRIVEN_uA


def words(block, values):
    return " ".join(f"{word:x}" for word in MAP.encode(block, values))


def read(chip, name):
    r = MAP[name]
    return from_words(chip.line(f"r {r.address:x} {r.words:x}").words, r.type)


def dies_among_its_own_frames(chip, said):
    """Until it has tripped, all of them are said again; how many ticks had current since the host was dead."""
    began = len(chip.driven_uA)
    echo, tick = read(chip, "echo"), read(chip, "tick")
    end_s = time.monotonic() + PATIENCE_S
    while read(chip, "state") != TRIPPED:
        for line in said:
            chip.line(line)
        assert time.monotonic() < end_s
    ran = (read(chip, "tick") - tick) % 2**32
    assert ran >= LEASE_MS // PERIOD_MS - 1
    for line in said:
        chip.line(line)
    assert (read(chip, "trip"), read(chip, "output"), read(chip, "echo")) == (LEASE, 0, echo)
    return sum(uA != 0 for uA in chip.driven_uA[began:])


@pytest.mark.parametrize("architecture", one_of(ARCHITECTURES))
def test_nor_in_the_next_boot_of_a_program(build_folder, architecture):
    folder, variables, _ = begun(build_folder / architecture, "a word")
    prefix, needs = {"avr": ("", AVR), "cortex_m": ("cortex_m_", CORTEX_M)}[architecture]
    make(folder, f"{prefix}amplifier_lines.elf", needs, *variables)
    chip = ARCHITECTURES[architecture](
        folder, "amplifier_lines", lambda driven_uA: f"in {driven_uA} {driven_uA} 2150 0"
    )
    try:
        first = Host(chip)
        first.work(30)
        most = LEASE_MS // PERIOD_MS + 2
        assert 0 < dies_among_its_own_frames(chip, first.said) <= most
        boots = read(chip, "boot_count")
        chip.tell("reset")
        end_s = time.monotonic() + PATIENCE_S
        while not (reply := chip.ask(b"r 5 2\n", lambda heard: heard.endswith(b"\n"), 0.5)).startswith(
            b"= %04X %04X" % divmod(boots + 1, 2**16)
        ):
            assert time.monotonic() < end_s, reply
        second = Host(chip)  # its numbers begin where those of the first one did
        second.work(3)
        assert 0 < dies_among_its_own_frames(chip, [*first.said, *second.said]) <= most
    finally:
        chip.close()
