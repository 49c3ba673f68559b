"""A running MCU: the AVR firmware's ELF under simavr, with its serial line as a pty and its hardware set by
the test."""

import contextlib
import os
import select
import subprocess
import threading

from firmware.firmware_build import read_line, sealed

AVR = ("avr-gcc", "avr-nm")
SIMAVR = ("gcc", "/usr/include/simavr/sim_avr.h", "/usr/include/libelf.h")


class Chip:
    """A running MCU: its serial line, and an environment that sets the readings for its output current."""

    def __init__(self, runner, elf, world):
        symbols = subprocess.run(["avr-nm", elf], capture_output=True, text=True, check=True).stdout
        plant = next(line.split()[0] for line in symbols.splitlines() if line.endswith(" plant"))
        self._process = subprocess.Popen(
            [runner, elf, plant], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0
        )
        self.path = self._process.stdout.readline().split()[1].decode()
        self._line = os.open(self.path, os.O_RDWR | os.O_NOCTTY)
        self.driven_uA = []
        self.behind_ms = 0  # real time that a busy machine did not let it have
        self._world = threading.Thread(target=self._answer_ticks, args=(world,))
        self._world.start()

    def _answer_ticks(self, world):
        for line in self._process.stdout:
            if line.startswith(b"behind"):
                self.behind_ms += int(line.split()[1])
                continue
            self.driven_uA.append(int(line.split()[1]))
            with contextlib.suppress(OSError, ValueError):  # it is being closed
                self.tell(world(self.driven_uA[-1]))

    def tell(self, line):
        self._process.stdin.write(f"{line}\n".encode())

    def ask(self, request, ended, patience_s=60.0):
        """The reply, complete when `ended` says so, or what arrived before the time-out."""
        os.write(self._line, request)
        reply = b""
        while not ended(reply) and select.select([self._line], [], [], patience_s)[0]:
            reply += os.read(self._line, 4096)
        return reply

    def line(self, body):
        return read_line(
            self.ask(f"{sealed(body)}\n".encode(), lambda reply: reply.endswith(b"\n")).decode().strip()
        )

    def close(self):
        self._process.stdin.close()
        assert self._process.wait(60) == 0
        self._world.join(60)
        self._process.stdout.close()
        os.close(self._line)
