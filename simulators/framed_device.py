"""A device behind a framing: bytes of a request in, bytes of a reply out. It is written in Python or in C."""

from typing import Protocol

from simulators.amplifier import Amplifier
from simulators.encoder_daq import EncoderDaq
from simulators.framing import ServerFraming, answer


class Station(Protocol):
    """The interface of any device."""

    framing: ServerFraming

    def boot(self, boot_count: int) -> None:
        """Boot the device."""
        ...

    def answer(self, request: bytes) -> bytes | None:
        """The reply to one request, or None."""
        ...

    @property
    def echo(self) -> int:
        """The sequence of the last executed command."""
        ...

    @property
    def boot_count(self) -> int:
        """Boots so far."""
        ...

    @property
    def newest_tick(self) -> int:
        """Samples since boot."""
        ...


class AmplifierStation(Station, Protocol):
    """The interface of an amplifier."""

    def tick(self, current_uA: int, voltage_uV: int, temperature: int, hardware: int) -> None:
        """Process the readings of a period."""
        ...

    @property
    def output_uA(self) -> int:
        """The present output."""
        ...

    @property
    def state(self) -> str:
        """The state by its name in the register map."""
        ...

    @property
    def trip(self) -> str:
        """The trip by its name in the register map, "" for none."""
        ...


class DaqStation(Station, Protocol):
    """The interface of an encoder DAQ."""

    def tick(self, raw_counts: int, ambient: int, hardware: int) -> None:
        """Store the sample of a period."""
        ...

    def now(self, raw_counts: int) -> None:
        """Update the present position."""
        ...


class PythonAmplifier(Amplifier):
    """The state machine of amplifier.py behind a framing."""

    def __init__(self, framing: ServerFraming) -> None:
        self.framing = framing
        super().__init__()

    def answer(self, request: bytes) -> bytes | None:
        """The reply to one request, or None."""
        return answer(self, self.framing, request)


class PythonDaq(EncoderDaq):
    """The state machine of encoder_daq.py behind a framing."""

    def __init__(self, framing: ServerFraming) -> None:
        self.framing = framing
        super().__init__()

    def answer(self, request: bytes) -> bytes | None:
        """The reply to one request, or None."""
        return answer(self, self.framing, request)
