"""A host at byte level: opens a pty, writes, and reads until a reply is complete or the time-out expires."""

import os
import select
import time
import tty
from functools import partial

from smarig.device.encoding import lines, rtu
from smarig.device.encoding.exchange import Exchange, Refusal

PATIENCE_S = 60.0  # ends a test that has failed


class Talk:
    """One open line; with an address, RTU frames."""

    def __init__(self, path: str, address: int = 0) -> None:
        self._address = address
        self.channel = os.open(path, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.channel)

    def say(self, data: bytes) -> None:
        """As it is."""
        os.write(self.channel, data)

    def hear(self, enough, timeout_s: float = PATIENCE_S) -> bytes:
        """What comes, until ``enough`` of it is true."""
        heard, end_s = b"", time.monotonic() + timeout_s
        while not enough(heard) and (left_s := end_s - time.monotonic()) > 0:
            if select.select([self.channel], [], [], left_s)[0]:
                heard += os.read(self.channel, 4096)
        return heard

    def line(self, text: str) -> str:
        """A line and its reply."""
        self.say(text.encode() + b"\n")
        return self.hear(lambda heard: heard.endswith(b"\n")).decode()

    def ask(self, e: Exchange, timeout_s: float = PATIENCE_S) -> list[int] | Refusal | None:
        """An exchange; None where nothing whole came."""
        if self._address:
            self.say(rtu.request(self._address, e))
            find = partial(rtu.find, self._address, e)
        else:
            self.say(lines.request(e))
            find = partial(lines.find, e)
        return find(self.hear(lambda heard: find(heard) is not None, timeout_s))

    def close(self) -> None:
        """Hang up."""
        os.close(self.channel)
