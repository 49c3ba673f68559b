"""A LabJack T4 or T7 as a register memory with analogue inputs, DACs, a quadrature counter and a watchdog.

The addresses are those of LabJack's Modbus map. Written without the driver's code, so that both can be compared.
"""

import struct
from collections.abc import Callable, Sequence

PRODUCT, FIRMWARE, SERIAL = 60000, 60004, 60028
ILLEGAL_FUNCTION, ILLEGAL_ADDRESS = 1, 2
DAC_STEP_V = {4: 5.0 / 1024, 7: 5.0 / 4096}
DAC_0, DAC_1 = 1000, 1002
CHANNELS = 14
FLASH = (61600, 61660)  # what a restart does not clear
ENABLE, TIMEOUT, STRICT, RESET = 61600, 61604, 61610, 61620
DAC_ENABLE, DAC_VALUE = (61640, 61650), (61642, 61652)
COUNTER, EF_ENABLE, EF_INDEX = 3000, 44000, 44100
FEATURE, FEATURE_INDEX = 7000, 9000
NO_RESULT = -9999.0

# First address, one past the last, for what can be written besides the DACs.
WRITABLE = (
    (40000, 40000 + 2 * CHANNELS),
    (41000, 41000 + CHANNELS),
    (41500, 41500 + CHANNELS),
    (FEATURE_INDEX, FEATURE_INDEX + 2 * CHANNELS),
    (9300, 9300 + 2 * CHANNELS),
    (9600, 9600 + 2 * CHANNELS),
    (EF_ENABLE, EF_ENABLE + 46),
    (EF_INDEX, EF_INDEX + 46),
    FLASH,
)


def as_words(value: float) -> list[int]:
    """A FLOAT32 as two registers."""
    return list(struct.unpack(">2H", struct.pack(">f", value)))


def as_float(words: Sequence[int]) -> float:
    """Two registers as a FLOAT32."""
    return struct.unpack(">f", struct.pack(">2H", *words))[0]


class LabJackBox:
    """``volts``, ``degC``: signal of an input. ``counts``: of the encoder. Time is given in seconds of the box."""

    def __init__(
        self,
        volts: Callable[[int], float],
        degC: Callable[[int], float],
        counts: Callable[[], int],
        product: int = 7,
    ) -> None:
        self._volts, self._degC, self._counts = volts, degC, counts
        self.product = product
        self._memory: dict[int, int] = dict.fromkeys(range(*FLASH), 0)
        self.dac_V = [0.0, 0.0]
        self.fired = 0  # how often the watchdog acted
        self.silent_s = 0.0  # how long nothing had been received when it last acted
        self.flash_writes = 0
        self._last_request_s = 0.0
        self._counter_zero = 0

    def restart(self) -> None:
        """Power off and on: only the flash is kept."""
        self._memory = {at: word for at, word in self._memory.items() if FLASH[0] <= at < FLASH[1]}
        self.dac_V = [0.0, 0.0]

    def pass_time(self, now_s: float) -> None:
        """Let the watchdog act if nothing was received for its time."""
        timeout_s = self._whole(TIMEOUT)
        if not self._whole(ENABLE) or now_s - self._last_request_s <= timeout_s:
            return
        self.silent_s = now_s - self._last_request_s
        self._last_request_s, self.fired = now_s, self.fired + 1
        for k in (0, 1):
            if self._whole(DAC_ENABLE[k]):
                self.dac_V[k] = as_float([self._memory[DAC_VALUE[k]], self._memory[DAC_VALUE[k] + 1]])
        if self._whole(RESET):
            self.restart()

    def read(self, at: int, count: int, now_s: float) -> list[int] | int:
        """The registers, or the code of a refusal."""
        self._last_request_s = now_s
        words: list[int] = []
        while len(words) < count:
            found = self._register(at + len(words))
            if found is None:
                return ILLEGAL_ADDRESS
            words += found
        return words[:count]

    def write(self, at: int, words: Sequence[int], now_s: float) -> int:
        """Write registers; 0, or the code of a refusal."""
        self._last_request_s = now_s
        if at in (DAC_0, DAC_1) and len(words) == 2:
            step_V = DAC_STEP_V[self.product]
            volts = min(max(as_float(words), 0.0), 5.0)
            self.dac_V[at // 2 % 2] = round(volts / step_V) * step_V
            return 0
        if not any(first <= at and at + len(words) <= end for first, end in WRITABLE):
            return ILLEGAL_ADDRESS
        if FLASH[0] <= at < FLASH[1]:
            self.flash_writes += 1
        if EF_ENABLE <= at < EF_ENABLE + 46 and words[-1]:
            self._counter_zero = self._counts()
        self._memory |= {at + k: word for k, word in enumerate(words)}
        return 0

    def _register(self, at: int) -> list[int] | None:
        """The value that starts at an address; None where there is none."""
        if 0 <= at < 2 * CHANNELS:
            return as_words(self._volts(at // 2))
        if at in (DAC_0, DAC_1):
            return as_words(self.dac_V[at // 2 % 2])
        if FEATURE <= at < FEATURE + 2 * CHANNELS:
            channel = (at - FEATURE) // 2
            return as_words(self._degC(channel) if self._whole(FEATURE_INDEX + 2 * channel) else NO_RESULT)
        if COUNTER <= at < COUNTER + 46:
            return self._counted(at - COUNTER)
        known = {PRODUCT: float(self.product), FIRMWARE: 1.0292}
        if at in known:
            return as_words(known[at])
        if at == SERIAL:
            return [470 >> 16, 47010]
        if any(first <= at < end for first, end in WRITABLE):
            return [self._memory.get(at, 0)]
        return None

    def _counted(self, line: int) -> list[int] | None:
        """The quadrature counter, if both lines of the pair have the feature."""
        pair = (line, line + 2)
        if not all(self._whole(EF_ENABLE + k) == 1 and self._whole(EF_INDEX + k) == 10 for k in pair):
            return None
        counted = (self._counts() - self._counter_zero) % (1 << 32)
        return [counted >> 16, counted & 0xFFFF]

    def _whole(self, at: int) -> int:
        return self._memory.get(at, 0) << 16 | self._memory.get(at + 1, 0)
