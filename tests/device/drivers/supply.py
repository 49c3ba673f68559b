"""A laboratory supply of another make behind a pty: it speaks SCPI and stores its commands."""

import contextlib
import os
import select
import threading
import tty
from collections.abc import Callable


class Supply:
    """A supply of another make: it stores its commands and measures the current through 4 Ω."""

    def __init__(self, identity: str = "ACME,PS-3005,0,1.0", takes: float = 1.0) -> None:
        self.master, slave = os.openpty()
        tty.setraw(self.master)
        tty.setraw(slave)
        self.port, self._slave = os.ttyname(slave), slave
        self.identity, self.takes = identity, takes
        self.heard: list[str] = []
        self.current, self.on, self.stuck = 0.0, False, False
        self.watchdog = "0"
        self._over = False
        self._keeping, self._kept = 0, list[bytes]()
        self._then: Callable[[], None] = lambda: None
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _serve(self) -> None:
        buffer = b""
        with contextlib.suppress(OSError):
            while not self._over:
                if not select.select([self.master], [], [], 0.02)[0]:
                    continue
                buffer += os.read(self.master, 256)
                while b"\n" in buffer:
                    line, buffer = buffer.split(b"\n", 1)
                    answer = self._answer(line.decode())
                    if answer is not None:
                        self._send(f"{answer}\n".encode())

    def keep_back(self, answers: int, then: Callable[[], None]) -> None:
        """So many of the next answers come late, before the one after them; ``then``: done whenever one is kept."""
        self._keeping, self._then = answers, then

    def _send(self, answer: bytes) -> None:
        self._kept.append(answer)
        if self._keeping:
            self._keeping -= 1
            self._then()
            return
        for one in self._kept:
            os.write(self.master, one)
        self._kept = []

    def _answer(self, line: str) -> str | None:
        self.heard.append(line)
        match line.split():
            case ["*IDN?"]:
                return self.identity
            case ["CURR", amount]:
                self.current = float(amount) * self.takes
            case ["OUTP", state]:
                self.on = state == "ON" or self.stuck
            case ["OUTP?"]:
                return str(int(self.on))
            case ["SYST:WDOG", seconds]:
                self.watchdog = seconds
            case ["SYST:WDOG?"]:
                return self.watchdog
            case ["CURR?"]:
                return f"{self.current:.6f}"  # "nan" where it takes nan
            case ["MEAS:CURR?"]:
                return f"{self.current * self.on:.6f}"
            case ["MEAS:VOLT?"]:
                return f"{4 * self.current * self.on:.6f}"
        return None

    def close(self) -> None:
        self._over = True
        self._thread.join()  # before the next test's descriptors have the same numbers
        os.close(self._slave)
        os.close(self.master)
