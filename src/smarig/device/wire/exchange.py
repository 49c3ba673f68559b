"""One transaction with a device: write a block, then read one. The same in every framing."""

from dataclasses import dataclass

REFUSALS = {
    1: "it does not know the function",
    2: "it has no such register, or it cannot be written",
    3: "a value is out of its range",
    4: "not now: not armed, tripped, or armed where it must be off",
    8: "the check word is wrong",
    9: "the line cannot be read",
}


@dataclass(frozen=True, slots=True)
class Exchange:
    """Words written from ``write_at`` on (none: nothing is written), then ``count`` words read from ``read_at`` on."""

    read_at: int = 0
    count: int = 0
    write_at: int = 0
    words: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Refusal:
    """A device's no, by its code."""

    code: int

    def __str__(self) -> str:
        return REFUSALS.get(self.code, f"code {self.code}")
