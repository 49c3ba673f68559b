"""A device behind a framing: bytes of a request in, bytes of a reply out. Python or C, the world cannot tell."""

from typing import Protocol

from simulators.amplifier import Amplifier
from simulators.encoder_daq import EncoderDaq
from simulators.framing import ServerFraming, answer


class Station(Protocol):
    """What the world needs of any device."""

    framing: ServerFraming

    def boot(self, boot_count: int) -> None:
        """Begin anew."""
        ...

    def answer(self, request: bytes) -> bytes | None:
        """The reply to one request, or silence."""
        ...

    @property
    def echo(self) -> int:
        """The sequence word accepted last."""
        ...

    @property
    def newest_tick(self) -> int:
        """Samples since boot."""
        ...


class AmplifierStation(Station, Protocol):
    """An amplifier, whoever wrote it."""

    def tick(self, current_uA: int, voltage_uV: int, temperature: int, hardware: int) -> None:
        """A period has passed."""
        ...

    @property
    def output_uA(self) -> int:
        """What it drives."""
        ...

    @property
    def state(self) -> str:
        """By the map's name."""
        ...

    @property
    def trip(self) -> str:
        """By the map's name, "" for none."""
        ...


class DaqStation(Station, Protocol):
    """An encoder DAQ, whoever wrote it."""

    def tick(self, raw_counts: int, ambient: int, hardware: int) -> None:
        """A period has passed."""
        ...

    def now(self, raw_counts: int) -> None:
        """Where the encoder stands."""
        ...


class PythonAmplifier(Amplifier):
    """The state machine of amplifier.py, spoken to in bytes."""

    def __init__(self, framing: ServerFraming) -> None:
        self.framing = framing
        super().__init__()

    def answer(self, request: bytes) -> bytes | None:
        """The reply to one request, or silence."""
        return answer(self, self.framing, request)


class PythonDaq(EncoderDaq):
    """The state machine of encoder_daq.py, spoken to in bytes."""

    def __init__(self, framing: ServerFraming) -> None:
        self.framing = framing
        super().__init__()

    def answer(self, request: bytes) -> bytes | None:
        """The reply to one request, or silence."""
        return answer(self, self.framing, request)
