"""The amplifier in Python behind the interface of the one in C, so that one test holds for both."""

from firmware.firmware_build import LINES, Device
from simulators import framing as framings
from simulators.amplifier import Amplifier
from simulators.lines import TextFraming
from simulators.modbus import Rtu


class PythonDevice(Device):
    """An amplifier of simulators/, asked and ticked like a ``Device`` of the library."""

    def __init__(self, boot_count: int = 7) -> None:
        self._amplifier = Amplifier()
        super().__init__(None, "amplifier", boot_count)

    def _call(self, what: str, *arguments):
        """What ``Device`` asks of the library."""
        del what, arguments
        return 1

    @property
    def output_uA(self) -> int:
        return self._amplifier.output_uA

    def boot(self, boot_count: int) -> None:
        self._sequence = 0
        self._amplifier.boot(boot_count)

    def tick(self, *inputs: int, times: int = 1) -> None:
        for _ in range(times):
            self._amplifier.tick(*inputs)

    def answer(self, request: bytes, framing: int, address: int | None = None, room: int = 0) -> bytes:
        del room
        if framing == LINES:
            return framings.answer(self._amplifier, TextFraming(), request.removesuffix(b"\n")) or b""
        used = Rtu(self.map.device.default_address if address is None else address)
        return framings.answer(self._amplifier, used, request) or b""
