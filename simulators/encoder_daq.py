"""The data acquisition of the encoder as a state machine: counts sampled by its own clock, kept in a ring."""

from simulators.register_device import RegisterDevice
from smarig.device import Refusal, from_words, load_register_map, to_words

RING_SAMPLES = 1024
INDEX, ILLEGAL_STEP, NO_SUPPLY = 1, 2, 4  # bits of a tick's ``hardware``

_MAP = load_register_map("encoder_daq")
_ORDER = {int(number): name for number, name in _MAP["order"].values.items()}
_FAULT = {fault.name: code for code, fault in _MAP.faults.items()}
_MARK = {name: 1 << int(bit) for bit, name in _MAP["ring"].field[-1].flags.items()}


class EncoderDaq(RegisterDevice):
    """An encoder whose position since the last zero is sampled in every tick and can be read at any time."""

    def __init__(self, boot_count: int = 1) -> None:
        super().__init__("encoder_daq", boot_count, RING_SAMPLES)

    def boot(self, boot_count: int) -> None:
        """Boot: the zero is at count 0, and there are no samples."""
        super().boot(boot_count)
        self._raw_counts = self._zero_counts = 0
        self._index_count = self._fault = 0

    def tick(self, raw_counts: int, ambient: int, hardware: int) -> None:
        """Store the sample of the period that has passed."""
        self._raw_counts = raw_counts
        self._index_count = (self._index_count + bool(hardware & INDEX)) & 0xFFFF
        self._fault = _FAULT["no_supply"] if hardware & NO_SUPPLY else 0
        marks = _MARK["index"] if hardware & INDEX else 0
        marks |= _MARK["illegal_step"] if hardware & ILLEGAL_STEP else 0
        self.ring.put([*to_words(raw_counts - self._zero_counts, 2), ambient & 0xFFFF, marks])

    def now(self, raw_counts: int) -> None:
        """Update the present position between two samples."""
        self._raw_counts = raw_counts

    def status(self) -> dict[str, int]:
        """Fault, present position and index pulses."""
        counts = from_words(
            to_words(self._raw_counts - self._zero_counts, 2), "i32"
        )  # wraps around like the register
        return {"fault": self._fault, "counts": counts, "index_count": self._index_count}

    def refuses_command(self, values: dict[str, int]) -> Refusal | None:
        """Refuse nothing: every value in range is allowed."""
        del values
        return None

    def carry_out(self, values: dict[str, int]) -> None:
        """Set the zero at the present position."""
        if _ORDER[values.get("order", 0)] == "zero":
            self._zero_counts = self._raw_counts
