"""The C firmware in place of the Python devices, called through its shared library."""

import ctypes
from pathlib import Path

from simulators.framing import ServerFraming
from smarig.core import UsageError, check_file
from smarig.device import from_words, load_register_map

_RTU, _LINE = 0, 1  # the library's numbers of the framings
_NUMBERS = {"modbus_rtu": _RTU, "lines": _LINE}
_ROOM = 2048  # bytes for a reply; the longest line is shorter than 700


def open_library(path: Path) -> ctypes.CDLL:
    """Load the library and declare its functions. Raises UsageError if it is not the firmware's library."""
    check_file(path)  # the loader would wait for a pipe for ever
    try:
        library = ctypes.CDLL(str(path.resolve()))
        for short, ticked in (("amp", (ctypes.c_int32,) * 2), ("daq", (ctypes.c_int32,))):
            getattr(library, f"{short}_size").restype = ctypes.c_size_t
            getattr(library, f"{short}_boot").argtypes = (ctypes.c_void_p, ctypes.c_uint32)
            tick = (ctypes.c_void_p, *ticked, ctypes.c_int16, ctypes.c_uint16)
            getattr(library, f"{short}_tick").argtypes = tick
            answer = getattr(library, f"{short}_answer")
            data, size = ctypes.c_char_p, ctypes.c_uint16
            answer.argtypes = (ctypes.c_void_p, ctypes.c_int, ctypes.c_uint8, data, size, data, size)
            answer.restype = ctypes.c_uint16
        library.amp_output.argtypes = (ctypes.c_void_p,)
        library.amp_output.restype = ctypes.c_int32
        library.daq_now.argtypes = (ctypes.c_void_p, ctypes.c_int32)
    except (OSError, AttributeError) as error:
        raise UsageError(f"{path} is not the firmware's library: {error}.") from None
    return library


class _Firmware:
    """One device with its own memory."""

    def __init__(self, library: ctypes.CDLL, short: str, name: str, framing: ServerFraming) -> None:
        if framing.name not in _NUMBERS:
            raise UsageError(
                f"The C firmware does not support {framing.name}. Use one of {', '.join(_NUMBERS)}."
            )
        self.framing, self._library, self._short = framing, library, short
        self._map = load_register_map(name)
        self._memory = ctypes.create_string_buffer(self._call("size"))
        self._reply = ctypes.create_string_buffer(_ROOM)
        self.boot(1)

    def boot(self, boot_count: int) -> None:
        """Boot the device."""
        self._call("boot", self._memory, boot_count & 0xFFFFFFFF)

    def answer(self, request: bytes) -> bytes | None:
        """The reply to one request, or None."""
        number = _NUMBERS[self.framing.name]
        return self._answer(number, request + b"\n" if number == _LINE else request)

    def _answer(self, number: int, request: bytes) -> bytes | None:
        address = getattr(self.framing, "address", self._map.device.default_address)
        arguments = (number, address, request, len(request), self._reply, _ROOM)
        length = self._call("answer", self._memory, *arguments)
        return self._reply.raw[:length] or None

    def _call(self, what: str, *arguments) -> int:
        return getattr(self._library, f"{self._short}_{what}")(*arguments)

    def _register(self, name: str) -> int:
        """The value of a register, read over the text framing; reading changes nothing."""
        r = self._map[name]
        line = self._answer(_LINE, b"r %X %X\n" % (r.address, r.words)) or b""
        return from_words([int(word, 16) for word in line.split()[1:-1]], r.type)

    @property
    def echo(self) -> int:
        """The sequence of the last executed command."""
        return self._register("echo")

    @property
    def boot_count(self) -> int:
        """Boots so far."""
        return self._register("boot_count")

    @property
    def newest_tick(self) -> int:
        """Samples since boot."""
        return self._register("tick")


class FirmwareAmplifier(_Firmware):
    """The amplifier in C."""

    def __init__(self, library: ctypes.CDLL, framing: ServerFraming) -> None:
        super().__init__(library, "amp", "amplifier", framing)

    def tick(self, current_uA: int, voltage_uV: int, temperature: int, hardware: int) -> None:
        """Process the readings of a period."""
        self._call("tick", self._memory, current_uA, voltage_uV, temperature, hardware)

    @property
    def output_uA(self) -> int:
        """The present output."""
        return self._call("output", self._memory)

    @property
    def state(self) -> str:
        """The state by its name in the register map."""
        return self._map["state"].values[str(self._register("state"))]

    @property
    def trip(self) -> str:
        """The trip by its name in the register map, "" for none."""
        code = self._register("trip")
        return self._map.faults[code].name if code else ""


class FirmwareDaq(_Firmware):
    """The encoder DAQ in C."""

    def __init__(self, library: ctypes.CDLL, framing: ServerFraming) -> None:
        super().__init__(library, "daq", "encoder_daq", framing)

    def tick(self, raw_counts: int, ambient: int, hardware: int) -> None:
        """Store the sample of a period."""
        self._call("tick", self._memory, raw_counts, ambient, hardware)

    def now(self, raw_counts: int) -> None:
        """Update the present position."""
        self._call("now", self._memory, raw_counts)
