"""A serial port, or anything pyserial takes for one (``socket://``, ``rfc2217://``), with either framing on it."""

import contextlib
import importlib
import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec

import serial

from smarig.wire import lines, rtu
from smarig.wire.blame import Garbled, Silent
from smarig.wire.exchange import Exchange, Refusal

_TERMIOS = (importlib.import_module("termios").error,) if find_spec("termios") else ()
GONE = (
    serial.SerialException,
    OSError,
    ValueError,
    re.error,
    *_TERMIOS,
)  # an unplugged port raises any of these
LONGEST = 4096  # bytes of noise that are kept


@dataclass(frozen=True)
class Framing:
    """How an exchange becomes bytes and is found in bytes again."""

    request: Callable[[Exchange], bytes]
    find: Callable[[Exchange, bytes], list[int] | Refusal | None]


TEXT = Framing(lines.request, lines.find)


def rtu_framing(address: int) -> Framing:
    """Modbus RTU to one address."""
    return Framing(lambda e: rtu.request(address, e), lambda e, data: rtu.find(address, e, data))


class SerialLine:
    """A port that is opened for itself alone, and at once read as far as a reply goes."""

    def __init__(self, url: str, framing: Framing, timeout_s: float, baud: int = 115200) -> None:
        self.where, self._framing, self._timeout_s, self._baud = url, framing, timeout_s, baud
        self._port: serial.Serial | None = None
        self._heard = b""
        self.reopen()

    def exchange(self, exchange: Exchange) -> list[int] | Refusal:
        """Send and wait; what was heard before is thrown away."""
        try:
            port = self._opened()
            self._heard = b""
            port.reset_input_buffer()
            port.write(self._framing.request(exchange))
        except GONE as error:
            raise self._gone(error) from None
        return self.more(exchange)

    def more(self, exchange: Exchange) -> list[int] | Refusal:
        """Listen until a reply is whole or time is over."""
        end = time.monotonic() + self._timeout_s
        heard_any = bool(self._heard)
        while True:
            try:
                left = end - time.monotonic()
                data = self._read(left) if left > 0 else b""
            except GONE as error:
                raise self._gone(error) from None
            if not data:
                kind = Garbled if heard_any else Silent
                raise kind(
                    f"{self.where}: {'no whole reply' if heard_any else 'no answer'} within {self._timeout_s:g} s. "
                    f"{kind.remedy}"
                )
            heard_any = True
            self._heard = (self._heard + data)[-LONGEST:]
            found = self._framing.find(exchange, self._heard)
            if found is not None:
                self._heard = b""
                return found

    def _read(self, left_s: float) -> bytes:
        """A first byte when it comes, then what is there: a reply may come in pieces."""
        port = self._opened()
        port.timeout = left_s
        first = port.read(1)
        if not first:
            return b""
        waiting = min(port.in_waiting, LONGEST)
        return first + (port.read(waiting) if waiting else b"")

    def reopen(self) -> None:
        """Close and open; Silent where there is no such port."""
        self.close()
        try:
            self._port = serial.serial_for_url(
                self.where,
                baudrate=self._baud,
                timeout=0.1,
                write_timeout=None if self.where.startswith("rfc2217:") else self._timeout_s,  # it knows none
                do_not_open=True,
            )
            with contextlib.suppress(*GONE):
                self._port.exclusive = True  # sockets have no such thing
            self._port.open()
        except GONE as error:
            self.close()
            raise self._gone(error) from None

    def close(self) -> None:
        """Let go of the port."""
        port, self._port = self._port, None
        if port is not None:
            with contextlib.suppress(*GONE):
                port.close()

    def _opened(self) -> serial.Serial:
        if self._port is None:
            raise Silent(f"{self.where} is not open. {Silent.remedy}")
        return self._port

    def _gone(self, error: BaseException) -> Silent:
        return Silent(f"{self.where} cannot be used: {error}. {Silent.remedy}")
