"""One transaction with a device, the same in every framing: write a block, then read one."""

from dataclasses import dataclass

REFUSALS = {
    1: "unknown function",
    2: "the register does not exist or cannot be written",
    3: "a value is out of its range",
    4: "not possible in this state (not armed, tripped, or armed where it must be off)",
    8: "the check word is wrong",
    9: "the line cannot be parsed",
}


@dataclass(frozen=True, slots=True)
class Exchange:
    """Write ``words`` from ``write_at`` on (none: write nothing), then read ``count`` words from ``read_at`` on."""

    read_at: int = 0
    count: int = 0
    write_at: int = 0
    words: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Refusal:
    """The refusal of a device, by its code."""

    code: int

    def __str__(self) -> str:
        return REFUSALS.get(self.code, f"code {self.code}")
