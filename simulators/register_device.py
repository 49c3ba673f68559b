"""What both devices do alike: judge an exchange, carry it out or not at all, answer from registers.

Knows maps, sequence words and ring windows. Refuses to know what orders and settings mean, and how words travel.
"""

from collections import deque
from typing import NamedTuple

from simulators.layout import RegisterLayout
from smarig.device import Exchange, RawValues, Refusal, RegisterMap, load_register_map, to_words


class RegisterDevice:
    """A device with a map, a ring and no time of its own; ``accept`` answers, subclasses say what is done."""

    def __init__(self, name: str, boot_count: int, ring_samples: int) -> None:
        self.map: RegisterMap = load_register_map(name)
        self._layout = RegisterLayout(self.map)
        self._ring_samples = ring_samples
        status = self.map.blocks["status"]
        self._header = tuple((r.name, r.words) for r in status if not r.field)
        self._window_words = status[-1].words
        device = self.map.device
        self._always = {"kind": device.kind, "version": device.version, "map_hash": self.map.hash}
        self.boot(boot_count)

    def boot(self, boot_count: int) -> None:
        """Begin anew, with nothing remembered but how often that has happened."""
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
        """Write, then read; a refusal leaves everything as it was."""
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
        refusal = self.refuses_settings()
        if refusal is None:
            self.stored.update(values)
        return refusal

    def _command(self, values: RawValues) -> Refusal | None:
        if values["sequence"] == self.echo:  # heard before: only the window may be another
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
        self.stored["order"] = self.map["order"].safe or 0  # done with; reads as none
        self.on_command()
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
        """Registers of the status block that only this device has."""
        raise NotImplementedError

    def refuses_command(self, values: dict[str, int]) -> Refusal | None:
        """Why what is written to the command block cannot be done now."""
        raise NotImplementedError

    def refuses_settings(self) -> Refusal | None:
        """Why settings cannot be written now."""
        return None

    def carry_out(self, values: dict[str, int]) -> None:
        """Do what a new command says."""
        raise NotImplementedError

    def on_command(self) -> None:
        """A sequence word was accepted, new or not."""


class RingWindow(NamedTuple):
    """A stretch of the ring as it was when it was asked for."""

    first: int
    count: int
    words: list[int]


EMPTY_WINDOW = RingWindow(0, 0, [])


class Ring:
    """As many samples as fit; ticks count from 1."""

    def __init__(self, samples: int) -> None:
        self._samples: deque[list[int]] = deque(maxlen=samples)
        self.newest = 0

    def put(self, words: list[int]) -> None:
        """The sample of the next tick."""
        self._samples.append(words)
        self.newest += 1

    def window(self, first: int, want: int) -> RingWindow:
        """From tick ``first`` on, or from the oldest that is still there; empty where that is in the future."""
        oldest = self.newest - len(self._samples) + 1
        if first > self.newest or not self._samples:
            return RingWindow(first, 0, [])
        first = max(first, oldest)
        count = min(want, self.newest - first + 1)
        words = [word for k in range(first - oldest, first - oldest + count) for word in self._samples[k]]
        return RingWindow(first, count, words)
