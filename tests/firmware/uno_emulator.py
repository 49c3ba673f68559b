"""An Uno on its bench: the firmware of boards/uno under simavr with its sensors, its power stage and a wire."""

import contextlib
import os
import select
import subprocess
import threading
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from firmware.architectures import SIMAVR
from firmware.firmware_build import FIRMWARE, Status, frame, make, status_of
from smarig.device.encoding.register import from_words, load_register_map, to_words

UNO = FIRMWARE.parent / "boards" / "uno"
NEEDS = ("avr-gcc", "avr-size", *SIMAVR)
AMPLIFIER, DAQ = load_register_map("amplifier"), load_register_map("encoder_daq")
WAIT_MS = 80  # of device time for an exchange: a measurement of 25 ms, and request and reply of 243 bytes
PATIENCE_S = 60.0


def build(folder: Path, target: str, *variables: str) -> Path:
    """One product of the board's Makefile; skips, saying so, without compilers or simavr."""
    return make(folder, target, NEEDS, *variables, source=UNO)


class Trace(NamedTuple):
    """The wire's current by device millisecond, in uA, and the time of the host's last byte in ms."""

    ms: np.ndarray
    mean_uA: np.ndarray
    least_uA: np.ndarray
    largest_uA: np.ndarray
    led: np.ndarray
    last_byte_ms: np.ndarray


class Uno:
    """A running board. Device time stops while the test thinks, unless ``options`` say otherwise."""

    def __init__(self, folder: Path, trace: Path, *options: str, wire: Callable[[float], str] | None = None):
        elf, program = folder / "uno.elf", folder / "uno_emulator"
        options = options or ("--speed", "0", "--wait", str(WAIT_MS))
        self._trace = trace
        self.process = subprocess.Popen(
            [program, elf, *options, "--trace", trace],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            bufsize=0,
        )
        self.path = self.process.stdout.readline().split()[1].decode()
        self._line: int | None = None
        self._sequence = {65: 0, 100: 0}
        self._epoch: list[int] = []  # as words
        self._wire: threading.Thread | None = None
        if wire:
            self._wire = threading.Thread(target=self._couple, args=(wire,))
            self._wire.start()

    def _couple(self, wire: Callable[[float], str]) -> None:
        for line in self.process.stdout:
            if line.startswith(b"flowed"):
                with contextlib.suppress(OSError, ValueError):  # it is being closed
                    self.tell(f"wire {wire(float(line.split()[1]))}")

    def tell(self, line: str) -> None:
        """A command of emulator.c."""
        self.process.stdin.write(f"{line}\n".encode())

    def told(self, line: str) -> list[str]:
        """The words of the line that answers a command."""
        self.tell(line)
        return self.process.stdout.readline().decode().split()

    def now(self, then: str = "") -> tuple[int, int]:
        """Device time in ms, and the current of the wire in uA. ``then`` is a command at that moment: between two
        writes of a test, device time may pass.
        """
        _, ms, current_uA = self.told(f"now\n{then}" if then else "now")
        return int(ms), int(current_uA)

    def go(self, ms: int) -> None:
        """Let device time pass without a host."""
        assert self.told(f"go {ms}") == ["went"]

    def ask(
        self, request: bytes, length: int, patience_s: float = PATIENCE_S, *, begins: bool = True
    ) -> bytes:
        """The reply to bytes, complete at ``length`` or when nothing comes any more. ``begins``: it is not the rest
        of one, in which five bytes can look like a refusal.
        """
        if self._line is None:
            self._line = os.open(self.path, os.O_RDWR | os.O_NOCTTY)
        os.write(self._line, request)
        reply = b""
        while len(reply) < length and not (begins and _refused(reply)):
            if not select.select([self._line], [], [], patience_s)[0]:
                break
            reply += os.read(self._line, 4096)
        return reply

    def exchange(self, address: int, at: int, words: list[int], read_at: int, count: int) -> list[int]:
        """Write words, then read; all accepted."""
        data = b"".join(word.to_bytes(2, "big") for word in words)
        head = [read_at, count, at, len(words)]
        body = bytes([address, 23]) + b"".join(word.to_bytes(2, "big") for word in head) + bytes([len(data)])
        reply = self.ask(frame(body + data), 5 + 2 * count)
        assert reply[:3] == bytes([address, 23, 2 * count]), reply.hex()
        return [int.from_bytes(reply[i : i + 2], "big") for i in range(3, 3 + 2 * count, 2)]

    def settings(self, **values: int) -> None:
        """The amplifier's settings: a wire of 5 ohm, ticks of 100 ms, a lease of 500 ms, unless given."""
        wide = {"current_max": 10**6, "slew_max": 10**6, "heat_max": 2**32 - 1, "resistance_min": 4000}
        safe = {r.name: r.safe or 0 for r in AMPLIFIER.blocks["settings"]}
        words = AMPLIFIER.encode("settings", safe | wide | values)
        assert self.exchange(65, 0x200, words, 0x200, len(words)) == words

    def command(self, order: int = 0, current: int = 0, ring_next: int = 0, nonce: int = 0) -> Status:
        """A new command to the amplifier, and its whole status."""
        self._sequence[65] += 1
        words = [*self._proof(65), order, *to_words(current, 2), *to_words(ring_next, 2), 12]
        return status_of(
            AMPLIFIER,
            self.exchange(65, 0x100, [*words, *to_words(nonce, 2)], 0, AMPLIFIER.size("status")),
        )

    def _proof(self, address: int) -> list[int]:
        """What a command begins with: a new sequence, and the boot of the board."""
        self._epoch = self._epoch or self.exchange_read(address, 5, 2)
        return [*to_words(self._sequence[address], 2), *self._epoch]

    def arm(self, current: int = 0) -> Status:
        """Arms with a current in uA."""
        return self.command(order=3, current=current, nonce=self.command().get("arm_nonce", 0))

    def drive(self, current: int, ticks: int) -> Status:
        """Keeps a current for some ticks of 100 ms, command by command."""
        status = self.command(current=current)
        last = status["tick"] + ticks
        while status["tick"] < last:
            status = self.command(current=current, ring_next=max(1, status["tick"] - 10))
        return status

    def heard(self) -> bytes:
        """All bytes that wait on the line."""
        reply = b""
        while select.select([self._line], [], [], 0)[0]:
            reply += os.read(self._line, 4096)
        return reply

    def command_after_noise(self) -> Status:
        """The status after frames of anybody may have been commands."""
        self._sequence[65] = from_words(self.exchange_read(65, 7, 2), "u32")
        return self.command()

    def exchange_read(self, address: int, at: int, count: int) -> list[int]:
        """Read words, without a command."""
        request = bytes([address, 3]) + at.to_bytes(2, "big") + count.to_bytes(2, "big")
        reply = self.ask(frame(request), 5 + 2 * count)
        assert reply[:3] == bytes([address, 3, 2 * count]), reply.hex()
        return [int.from_bytes(reply[i : i + 2], "big") for i in range(3, 3 + 2 * count, 2)]

    def position(self, ring_next: int = 0) -> Status:
        """A new command to the encoder DAQ, and its whole status."""
        self._sequence[100] += 1
        words = [*self._proof(100), 0, *to_words(ring_next, 2), 24]
        return status_of(DAQ, self.exchange(100, 0x100, words, 0, DAQ.size("status")))

    def free_ram(self) -> int:
        """Bytes between the variables and the deepest stack so far."""
        return int(self.told("free")[1])

    def close(self) -> Trace:
        """End it; what flowed."""
        if self._line is not None:
            os.close(self._line)
        self.process.stdin.close()
        assert self.process.wait(PATIENCE_S) == 0
        if self._wire:
            self._wire.join(PATIENCE_S)
        self.process.stdout.close()
        return Trace(*np.loadtxt(self._trace, ndmin=2).T)


def _refused(reply: bytes) -> bool:
    return len(reply) == 5 and reply[1] & 0x80 != 0
