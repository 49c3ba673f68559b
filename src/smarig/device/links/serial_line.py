"""A serial port or a line on the network (``tcp://``, ``rfc2217://``), with either framing."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from smarig.device.encoding import lines, rtu
from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.device.encoding.link_faults import Garbled, Silent
from smarig.device.links.port_url import send
from smarig.device.links.serial_port import PORT_ERRORS, SerialPort

LONGEST = 4096  # largest number of received bytes that are kept


@dataclass(frozen=True)
class Framing:
    """Encodes an exchange as bytes and finds its reply in received bytes."""

    request: Callable[[Exchange], bytes]
    find: Callable[[Exchange, bytes], list[int] | Refusal | None]


TEXT = Framing(lines.request, lines.find)


def rtu_framing(address: int) -> Framing:
    """Modbus RTU to one address."""
    return Framing(lambda e: rtu.request(address, e), lambda e, data: rtu.find(address, e, data))


class SerialLine:
    """The line to one device: a port that is read until a reply is complete."""

    def __init__(
        self,
        url: str,
        framing: Framing,
        timeout_s: float,
        baud: int = 115200,
        clock: Callable[[], float] = time.monotonic,
        port: SerialPort | None = None,
        serial_format: str = "8N1",
    ) -> None:
        self.where, self._framing, self._timeout_s = url, framing, timeout_s
        self._clock = clock
        self._port = port or SerialPort(url, baud, timeout_s, serial_format)
        self._received = b""
        self._port.open()

    def exchange(self, exchange: Exchange) -> list[int] | Refusal:
        """Send and wait. Bytes received before are discarded."""
        try:
            port = self._port.opened()
            self._received = b""
            port.reset_input_buffer()
            send(port, self._framing.request(exchange))
        except PORT_ERRORS as error:
            raise self._port.unusable(error) from None
        return self.more(exchange)

    def more(self, exchange: Exchange) -> list[int] | Refusal:
        """Read until a reply is complete or the time is over."""
        end = self._clock() + self._timeout_s
        received_any = bool(self._received)
        while True:
            try:
                left = end - self._clock()
                data = self._read(left) if left > 0 else b""
            except PORT_ERRORS as error:
                raise self._port.unusable(error) from None
            if not data:
                kind = Garbled if received_any else Silent
                raise kind(
                    f"{self.where}: {'no complete reply' if received_any else 'no reply'} within "
                    f"{self._timeout_s:g} s. {kind.remedy}"
                )
            received_any = True
            self._received = (self._received + data)[-LONGEST:]
            found = self._framing.find(exchange, self._received)
            if found is not None:
                self._received = b""
                return found

    def _read(self, left_s: float) -> bytes:
        """Wait for a first byte, then take all that are available: a reply may come in pieces."""
        port = self._port.opened()
        port.timeout = left_s
        first = port.read(1)
        if not first:
            return b""
        waiting = min(port.in_waiting, LONGEST)
        return first + (port.read(waiting) if waiting else b"")

    def reopen(self) -> None:
        """Close and open. Raises Silent if there is no such port."""
        self._port.reopen()

    def close(self) -> None:
        """Close the port."""
        self._port.close()
