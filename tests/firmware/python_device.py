"""The devices in Python behind the interface of those in C, so that one test holds for both."""

from firmware.firmware_build import LINES, Device
from simulators import framing as framings
from simulators.amplifier import Amplifier
from simulators.encoder_daq import EncoderDaq
from simulators.lines import TextFraming
from simulators.modbus import Rtu

MAKERS = {"amplifier": Amplifier, "encoder_daq": EncoderDaq}


class PythonDevice(Device):
    """A device of simulators/, asked and ticked like a ``Device`` of the library.

    ``sequence`` and ``tick``: where counting begins at boot, as FIRST_SEQUENCE and FIRST_TICK of the library.
    """

    def __init__(
        self, boot_count: int = 7, name: str = "amplifier", sequence: int = 0, tick: int = 0
    ) -> None:
        self._first = (sequence, tick)
        self._device = MAKERS[name]()
        super().__init__(None, name, boot_count)

    def _call(self, what: str, *arguments):
        """What ``Device`` asks of the library."""
        del what, arguments
        return 1

    @property
    def output_uA(self) -> int:
        return self._device.output_uA

    def boot(self, boot_count: int) -> None:
        self._sequence, self._epoch = 0, boot_count
        self._device.boot(boot_count)
        self._device.start_at(*self._first)

    def tick(self, *inputs: int, times: int = 1) -> None:
        for _ in range(times):
            self._device.tick(*inputs)

    def now(self, raw_counts: int) -> None:
        self._device.now(raw_counts)

    def answer(self, request: bytes, framing: int, address: int | None = None, room: int = 0) -> bytes:
        del room
        if framing == LINES:
            return framings.answer(self._device, TextFraming(), request.removesuffix(b"\n")) or b""
        used = Rtu(self.map.device.default_address if address is None else address)
        return framings.answer(self._device, used, request) or b""
