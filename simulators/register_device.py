"""What both devices have in common: an exchange is checked, executed completely or not at all, and answered."""

from collections import deque
from collections.abc import Mapping
from typing import NamedTuple

from simulators.layout import RegisterLayout
from smarig.device import Exchange, RawValues, Refusal, RegisterMap, load_register_map, to_words

SEQUENCE_AHEAD = 256  # commands that may have been lost on the line
COUNTED = 2**32  # boots and ticks are counted modulo this


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
        self.boot_count = boot_count % COUNTED
        self.echo = 0
        self.ring = Ring(self._ring_samples)
        self.stored = RawValues(
            (r.name, r.safe or 0) for r in self.map.registers.values() if r.access == "rw"
        )
        self.stored["epoch"] = self.boot_count
        self._window: RingWindow = EMPTY_WINDOW

    @property
    def newest_tick(self) -> int:
        """Samples since boot, modulo 2**32."""
        return self.ring.newest

    def start_at(self, sequence: int, tick: int) -> None:
        """Just after boot: continue as if ``sequence`` and ``tick`` had been reached, for tests of their ends."""
        self.echo = self.stored["sequence"] = sequence
        self.ring.newest = tick

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
        if not is_new(values, self.boot_count, self.echo):  # repeated or late: only its window may differ
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


def is_new(values: Mapping[str, int], boot_count: int, echo: int) -> bool:
    """Whether a command was made for this boot, with one of the numbers that follow ``echo``.

    Numbers do not wrap and boots are counted, so each pair of both is executed once at most: no frame is new again.

    >>> [is_new({"sequence": k, "epoch": 3}, 3, 7) for k in (6, 7, 8, 263, 264)]
    [False, False, True, True, False]
    >>> is_new({"sequence": 8, "epoch": 2}, 3, 7), is_new({"sequence": 8}, 3, 7)
    (False, False)
    """
    return values.get("epoch") == boot_count and 1 <= values["sequence"] - echo <= SEQUENCE_AHEAD


def ticks_after(tick: int, other: int) -> int:
    """How much later a tick is than another, both modulo 2**32; less than 0 if it is earlier.

    >>> ticks_after(5, 3), ticks_after(3, 5), ticks_after(2, 2**32 - 1)
    (2, -2, 3)
    """
    return (tick - other + COUNTED // 2) % COUNTED - COUNTED // 2


class RingWindow(NamedTuple):
    """A part of the ring as it was when it was requested."""

    first: int
    count: int
    words: list[int]


EMPTY_WINDOW = RingWindow(0, 0, [])


class Ring:
    """A ring of samples. Ticks count from 1, modulo 2**32."""

    def __init__(self, samples: int) -> None:
        self._samples: deque[list[int]] = deque(maxlen=samples)
        self.newest = 0

    def put(self, words: list[int]) -> None:
        """Store the sample of the next tick."""
        self._samples.append(words)
        self.newest = (self.newest + 1) % COUNTED

    def window(self, first: int, want: int) -> RingWindow:
        """Samples from tick ``first`` on, or from the oldest stored one; empty if ``first`` is in the
        future."""
        stored = len(self._samples)
        ago = ticks_after(self.newest, first)
        if ago < 0 or not stored:
            return RingWindow(first, 0, [])
        ago = min(ago, stored - 1)
        count = min(want, ago + 1)
        at = stored - 1 - ago
        words = [word for k in range(at, at + count) for word in self._samples[k]]
        return RingWindow((self.newest - ago) % COUNTED, count, words)
