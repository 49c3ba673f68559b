"""What both devices have in common: an exchange is checked, executed completely or not at all, and answered."""

from collections import deque
from typing import NamedTuple

from simulators.layout import RegisterLayout
from smarig.device import Exchange, RawValues, Refusal, RegisterMap, load_register_map, to_words

SEQUENCE_AHEAD = 256  # commands that may have been lost on the line


class RegisterDevice:
    """A device with a register map and a ring. ``accept`` answers; subclasses define the commands."""

    def __init__(self, name: str, boot_count: int, ring_samples: int) -> None:
        self.map: RegisterMap = load_register_map(name)
        self._layout = RegisterLayout(self.map)
        self._ring_samples = ring_samples
        status = self.map.blocks["status"]
        self._header = tuple((r.name, r.words) for r in status if not r.field)
        self._window_words = status[-1].words
        self._read_as_safe = {"order", "nonce"} & self.map.registers.keys()
        device = self.map.device
        self._always = {"kind": device.kind, "version": device.version, "map_hash": self.map.hash}
        self.boot(boot_count)

    def boot(self, boot_count: int) -> None:
        """Restart with nothing remembered except the boot count."""
        self.boot_count = boot_count & 0xFFFF
        self.echo = 0
        self.ring = Ring(self._ring_samples)
        self.stored = RawValues(
            (r.name, r.safe or 0) for r in self.map.registers.values() if r.access == "rw"
        )
        self._window: RingWindow = EMPTY_WINDOW

    @property
    def newest_tick(self) -> int:
        """Samples since boot."""
        return self.ring.newest

    def accept(self, exchange: Exchange) -> list[int] | Refusal:
        """Write, then read. A refused exchange changes nothing."""
        refusal = self._layout.refuses(exchange)
        if refusal is None and exchange.words:
            refusal = self._write(exchange)
        return refusal or self._read(exchange)

    def _write(self, exchange: Exchange) -> Refusal | None:
        values = self._layout.values(exchange)
        if isinstance(values, Refusal):
            return values
        return self._command(values) if "sequence" in values else self._settings(values)

    def _settings(self, values: RawValues) -> Refusal | None:
        refusal = self.refuses_settings(values)
        if refusal is None:
            self.stored.update(values)
        return refusal

    def _command(self, values: RawValues) -> Refusal | None:
        if not is_new(values["sequence"], self.echo):  # repeated or late: only its window may differ
            values = RawValues(
                (name, raw) for name, raw in values.items() if name in ("ring_next", "ring_want")
            )
        else:
            refusal = self.refuses_command(values)
            if refusal:
                return refusal
            self.carry_out(values)
            self.echo = values["sequence"]
        self.stored.update(values)
        for name in self._read_as_safe:  # executed or used up
            self.stored[name] = self.map[name].safe or 0
        self._window = self.ring.window(self.stored["ring_next"], self.stored["ring_want"])
        return None

    def _read(self, exchange: Exchange) -> list[int]:
        if not exchange.count:
            return []
        block = self._layout.block(exchange.read_at)
        words = self._status_words() if block == "status" else self._stored_words(block)
        at = exchange.read_at - self._layout.starts[block]
        return words[at : at + exchange.count]

    def _stored_words(self, block: str) -> list[int]:
        return self.map.encode(block, {name: self.stored[name] for name in self.map.names[block]})

    def _status_words(self) -> list[int]:
        window = self._window
        values = RawValues(
            **self._always,
            echo=self.echo,
            boot_count=self.boot_count,
            tick=self.newest_tick,
            ring_first=window.first,
            ring_count=window.count,
            **self.status(),
        )
        words: list[int] = []
        for name, size in self._header:
            words += to_words(values[name], size)
        return words + window.words + [0] * (self._window_words - len(window.words))

    def status(self) -> dict[str, int]:
        """The registers of the status block that only this device has."""
        raise NotImplementedError

    def refuses_command(self, values: dict[str, int]) -> Refusal | None:
        """Why the command cannot be executed now, or None."""
        raise NotImplementedError

    def refuses_settings(self, values: dict[str, int]) -> Refusal | None:
        """Why these settings cannot be written now, or None."""
        del values
        return None

    def carry_out(self, values: dict[str, int]) -> None:
        """Execute a new command."""
        raise NotImplementedError


def is_new(sequence: int, last: int) -> bool:
    """Whether a sequence word is one of the next after the last accepted one; 1 follows 65535.

    >>> is_new(1, 0), is_new(1, 65535), is_new(7, 7), is_new(6, 7), is_new(300, 7)
    (True, True, False, False, False)
    """
    return 1 <= (sequence - last) % 0xFFFF <= SEQUENCE_AHEAD


class RingWindow(NamedTuple):
    """A part of the ring as it was when it was requested."""

    first: int
    count: int
    words: list[int]


EMPTY_WINDOW = RingWindow(0, 0, [])


class Ring:
    """A ring of samples. Ticks count from 1."""

    def __init__(self, samples: int) -> None:
        self._samples: deque[list[int]] = deque(maxlen=samples)
        self.newest = 0

    def put(self, words: list[int]) -> None:
        """Store the sample of the next tick."""
        self._samples.append(words)
        self.newest += 1

    def window(self, first: int, want: int) -> RingWindow:
        """Samples from tick ``first`` on, or from the oldest stored one; empty if ``first`` is in the
        future."""
        oldest = self.newest - len(self._samples) + 1
        if first > self.newest or not self._samples:
            return RingWindow(first, 0, [])
        first = max(first, oldest)
        count = min(want, self.newest - first + 1)
        words = [word for k in range(first - oldest, first - oldest + count) for word in self._samples[k]]
        return RingWindow(first, count, words)
