"""Modbus TCP by pymodbus. Its minor version is pinned, because its interface changes between minor versions.

Only this module imports pymodbus.
"""

import contextlib
import logging

from pymodbus import ModbusException
from pymodbus.client import ModbusTcpClient
from pymodbus.exceptions import ModbusIOException
from pymodbus.pdu import ExceptionResponse

from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.device.encoding.link_faults import Garbled, Silent
from smarig.device.encoding.rtu import function as _function

logging.getLogger("pymodbus").setLevel(logging.CRITICAL)  # smarig reports each of its errors once
UNANSWERED = "No response received"  # start of its message after a time-out


class ModbusTcp:
    """A device at a host and port, selected by its Modbus address. Requests are not retried here."""

    def __init__(self, host: str, port: int, address: int, timeout_s: float) -> None:
        self.where = f"tcp://{host}:{port}"
        self._host, self._port, self._address = host, port, address
        self._timeout_s = timeout_s  # of the connection and of each reply
        self._client: ModbusTcpClient | None = None
        self.reopen()

    def exchange(self, exchange: Exchange) -> list[int] | Refusal:
        """Send and wait. A reply after the time-out, whole or partial, finds its connection closed."""
        client = self._connected()
        try:
            reply = self._send_request(client, exchange)
        except (ModbusException, OSError) as error:
            client.close()
            raise self._blamed(error) from None
        if reply.function_code & 0x7F != _function(exchange):
            raise Garbled(
                f"{self.where}: a reply to function {reply.function_code & 0x7F} arrived. {Garbled.network_remedy}"
            )
        if isinstance(reply, ExceptionResponse):
            return Refusal(reply.exception_code)
        words = list(reply.registers) if exchange.count else []
        if len(words) != exchange.count:
            raise Garbled(
                f"{self.where}: received {len(words)} words instead of {exchange.count}. {Garbled.network_remedy}"
            )
        return words

    def _connected(self) -> ModbusTcpClient:
        """The connection, or a new one after a missing reply."""
        client = self._client
        if client is None:
            raise Silent(f"{self.where} is not open. {Silent.remedy}")
        if not client.connect():
            raise self._nobody()
        return client

    def _blamed(self, error: Exception) -> Silent | Garbled:
        if isinstance(error, ModbusIOException) and UNANSWERED in str(error):
            return Silent(f"{self.where}: no reply within {self._timeout_s:g} s. {Silent.remedy}")
        return Garbled(
            f"{self.where}: the reply is incomplete or the connection was cut. {Garbled.network_remedy}"
        )

    def _nobody(self) -> Silent:
        return Silent(f"{self.where}: the connection was not accepted. {Silent.remedy}")

    def _send_request(self, client: ModbusTcpClient, e: Exchange):
        if not e.words:
            return client.read_holding_registers(e.read_at, count=e.count, device_id=self._address)
        if not e.count:
            return client.write_registers(e.write_at, list(e.words), device_id=self._address)
        return client.readwrite_registers(
            read_address=e.read_at,
            read_count=e.count,
            write_address=e.write_at,
            values=list(e.words),
            device_id=self._address,
        )

    def more(self, exchange: Exchange) -> list[int] | Refusal:
        """Raise Silent: a reply carries the number of its request, so late replies are never confused with others."""
        del exchange
        raise Silent(f"{self.where}: no further reply arrived. {Silent.remedy}")

    def reopen(self) -> None:
        """Close and connect. Raises Silent if nothing listens there."""
        self.close()
        client = ModbusTcpClient(self._host, port=self._port, timeout=self._timeout_s, retries=0)
        if not client.connect():
            client.close()
            raise self._nobody()
        self._client = client

    def close(self) -> None:
        """Close the connection."""
        client, self._client = self._client, None
        if client is not None:
            with contextlib.suppress(Exception):
                client.close()
