"""A serial port or a line on the network, opened exclusively; several devices may share it by address."""

import contextlib
import importlib
import re
from importlib.util import find_spec
from pathlib import Path
from typing import ClassVar

import serial

from smarig.core import ConfigError
from smarig.device.encoding.link_faults import Silent
from smarig.device.links.port_url import checked_url, close_port, refusal_of, send_at_once, unopened_port

_TERMIOS = (importlib.import_module("termios").error,) if find_spec("termios") else ()
PORT_ERRORS: tuple[type[Exception], ...] = (
    serial.SerialException,
    OSError,
    ValueError,
    re.error,
    *_TERMIOS,
)  # an unplugged port raises any of these


class SerialPort:
    """A port of this process alone. Closed at first."""

    def __init__(self, url: str, baud: int, write_timeout_s: float, serial_format: str = "8N1") -> None:
        self.where, self.baud, self.serial_format = url, baud, serial_format
        self._url = checked_url(url)
        self._write_timeout_s = write_timeout_s
        self._serial: serial.Serial | None = None

    def open(self) -> None:
        """Open it unless it is open. Raises Silent if there is no such port."""
        if self._serial is None:
            self.reopen()

    def reopen(self) -> None:
        """Close and open. Raises Silent if there is no such port."""
        self.close()
        try:
            self._serial = unopened_port(self._url, self.baud, 0.1, self._write_timeout_s, self.serial_format)
            with contextlib.suppress(*PORT_ERRORS):
                self._serial.exclusive = True  # sockets do not support it
            self._serial.open()
            send_at_once(self._serial)
        except PORT_ERRORS as error:
            self.close()
            raise self.unusable(error) from None

    def close(self) -> None:
        """Close it. Never raises."""
        port, self._serial = self._serial, None
        if port is not None:
            close_port(port)

    def opened(self) -> serial.Serial:
        """The open port. Raises Silent if it is closed."""
        if self._serial is None:
            raise Silent(f"{self.where} is not open. {Silent.remedy}")
        return self._serial

    def unusable(self, error: BaseException) -> Silent:
        """What an error of the port means for an exchange."""
        refused = refusal_of(self.where, error, self.baud, self.serial_format)
        return Silent(f"{self.where} cannot be used: {refused}")


class SharedPort(SerialPort):
    """One device's part of a port: the port closes when the last device closes its part."""

    _by_path: ClassVar[dict[str, tuple[SerialPort, set[int]]]] = {}  # open ports; the addresses that use them

    def __init__(
        self, url: str, baud: int, write_timeout_s: float, address: int, serial_format: str = "8N1"
    ) -> None:
        super().__init__(url, baud, write_timeout_s, serial_format)
        path = Path(url)
        self._path, self._address = str(path.resolve()) if path.exists() else self._url, address
        self._port, self._users = self._by_path.get(
            self._path, (SerialPort(url, baud, write_timeout_s, serial_format), set())
        )
        self._joined = False
        if self._users and self._port.baud != baud:
            raise ConfigError(
                f"{url} is open at {self._port.baud} baud and cannot be opened at {baud}. Give all links of one port "
                "the same baud."
            )
        if self._users and self._port.serial_format != serial_format:
            raise ConfigError(
                f"{url} is open as {self._port.serial_format} and cannot be opened as {serial_format}. Give all links "
                "of one port the same serial_format."
            )

    def open(self) -> None:
        """Join the port, which is opened for its first device. Raises Silent if the address is in use."""
        if self._address in self._users:
            raise Silent(f"{self.where} is in use for the device at address {self._address}. {Silent.remedy}")
        self._port.open()
        self._joined = True
        self._users.add(self._address)
        self._by_path[self._path] = (self._port, self._users)

    def reopen(self) -> None:
        """Close and open the port for all its devices; a device that has left joins it again."""
        if self._joined:
            self._port.reopen()
        else:
            self.open()

    def close(self) -> None:
        """Leave the port; the last device closes it."""
        if not self._joined:
            return
        self._joined = False
        self._users.discard(self._address)
        if not self._users:
            self._port.close()
            self._by_path.pop(self._path, None)

    def opened(self) -> serial.Serial:
        """The open port."""
        if not self._joined:
            raise Silent(f"{self.where} is not open. {Silent.remedy}")
        return self._port.opened()
