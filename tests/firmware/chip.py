"""A running MCU under an emulator: its serial line as a pty, its hardware set by the test."""

import contextlib
import os
import queue
import re
import select
import subprocess
import threading

from firmware.firmware_build import read_line, sealed

PATIENCE_S = 60.0


class Chip:
    """A running MCU: its serial line, and an environment that sets the readings for its output current.

    ``command`` starts the emulator, which first says the path of its pty; ``ends_itself`` once its input is closed.
    """

    def __init__(self, command, world, ends_itself):
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0)
        self._ends_itself = ends_itself
        self.path = re.search(r"/dev/\S+", self._process.stdout.readline().decode())[0]
        self._line = os.open(self.path, os.O_RDWR | os.O_NOCTTY)
        self.driven_uA = []
        self.behind_ms = 0  # real time that a busy machine did not let it have
        self._said = queue.Queue()
        self._ticks = threading.Event()
        self._world = threading.Thread(target=self._answer_ticks, args=(world,))
        self._world.start()
        assert self._ticks.wait(PATIENCE_S)  # what is sent before its ports are open is lost

    def _answer_ticks(self, world):
        for line in self._process.stdout:
            word, *numbers = line.decode().split()
            if word == "behind":
                self.behind_ms += int(numbers[0])
            elif word == "out":
                self.driven_uA.append(int(numbers[0]))
                self._ticks.set()
                with contextlib.suppress(OSError, ValueError):  # it is being closed
                    self.tell(world(self.driven_uA[-1]))
            else:
                self._said.put((word, *map(int, numbers)))

    def tell(self, line):
        self._process.stdin.write(f"{line}\n".encode())

    def said(self, patience_s=PATIENCE_S):
        """The next line of the chip about neither ticks nor time, as its word and its numbers."""
        return self._said.get(timeout=patience_s)

    def send(self, request):
        """Bytes for the serial line, whose reply is read later."""
        os.write(self._line, request)

    def receive(self, count):
        """So many bytes of the serial line."""
        return self.ask(b"", lambda reply: len(reply) >= count)

    def ask(self, request, ended, patience_s=PATIENCE_S):
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
        if not self._ends_itself:
            self._process.terminate()
        assert self._process.wait(60) == 0
        self._world.join(60)
        self._process.stdout.close()
        os.close(self._line)
