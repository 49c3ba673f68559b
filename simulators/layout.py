"""Which words of a device can be read and written together. Requests are checked here before any part is
executed."""

from collections.abc import Iterator

from smarig.device import Exchange, RawValues, Refusal, Register, RegisterMap

NO_FUNCTION, NO_REGISTER, BAD_VALUE, NOT_NOW, BAD_CHECK, NOT_READABLE = 1, 2, 3, 4, 8, 9  # codes of refusals
MOST_READ, MOST_WRITTEN = 125, 121  # words in one exchange


class RegisterLayout:
    """The blocks of a register map and the boundaries of the values in them."""

    def __init__(self, m: RegisterMap) -> None:
        self._map = m
        self.starts = {name: m.start(name) for name in m.blocks}
        ends = {name: m.start(name) + m.size(name) for name in m.blocks}
        self._spans = tuple((name, self.starts[name], ends[name]) for name in m.blocks)
        self._written = {self.starts[name]: name for name in m.blocks if m.blocks[name][0].access == "rw"}
        self._borders = {start for _, start, _ in self._spans}
        for r in m.registers.values():
            self._borders.update(_ends(r))
        self._limits = {r.name: r.limits for r in m.registers.values() if r.access == "rw"}

    def refuses(self, e: Exchange) -> Refusal | None:
        """Why the addresses of an exchange are not allowed, or None. ``values`` checks the words."""
        if not fits(e):
            return Refusal(BAD_VALUE)
        if e.count and not self._readable(e.read_at, e.count):
            return Refusal(NO_REGISTER)
        if e.words and (e.write_at not in self._written or not self._readable(e.write_at, len(e.words))):
            return Refusal(NO_REGISTER)
        return None

    def values(self, e: Exchange) -> RawValues | Refusal:
        """The written values by register, or a refusal if a word is out of range."""
        values = self._map.decode(self._written[e.write_at], e.words)
        for name, raw in values.items():
            low, high = self._limits[name]
            if not low <= raw <= high:
                return Refusal(BAD_VALUE)
        return values

    def block(self, address: int) -> str:
        """Name of the block that contains an address."""
        return next(name for name, start, end in self._spans if start <= address < end)

    def _readable(self, at: int, count: int) -> bool:
        """Whether the words start and end at boundaries of values within one block."""
        return (
            at in self._borders
            and at + count in self._borders
            and any(start <= at and at + count <= end for _, start, end in self._spans)
        )


def fits(e: Exchange) -> bool:
    """Whether the exchange has something to do and not too many words."""
    return len(e.words) <= MOST_WRITTEN and e.count <= MOST_READ and bool(e.words or e.count)


def _ends(r: Register) -> Iterator[int]:
    """The ends of a register's values. The records of a ring are values field by field."""
    at = r.address
    for _ in range(r.count):
        for words in [f.words for f in r.field] or [r.words]:
            at += words
            yield at
