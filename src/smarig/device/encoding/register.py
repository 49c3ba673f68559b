"""A device's register map: read from firmware_protocol/NAME.toml, checked and hashed.

value = word × lsb        in ``unit``; ``none`` is the word that means "no reading"
"""

import hashlib
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Annotated, Literal

from pydantic import Field, model_validator

from smarig.core import NAN, TomlTable, UsageError, load_toml, shipped, suggestion

VALUE_RANGES = {
    "u16": (0, 0xFFFF),
    "i16": (-0x8000, 0x7FFF),
    "u32": (0, 0xFFFFFFFF),
    "i32": (-0x80000000, 0x7FFFFFFF),
}
WordType = Literal["u16", "i16", "u32", "i32"]
NumberNames = Mapping[str, str]  # names of values or flags, by number


class Value(TomlTable):
    """A number and its encoding in words."""

    name: str
    type: WordType
    text: str
    lsb: Annotated[float, Field(gt=0)] = 1.0
    unit: str = ""
    none: int | None = None
    flags: NumberNames = Field(default_factory=dict)

    @cached_property
    def words(self) -> int:
        """One or two."""
        return 2 if self.type.endswith("32") else 1

    @cached_property
    def per_unit(self) -> float:
        """Words per unit. Division by a whole number rounds correctly; multiplication by 1e-6 does not."""
        return round(1 / self.lsb) if self.lsb < 1 else 1 / self.lsb

    @property
    def span(self) -> tuple[int, int]:
        """Smallest and largest raw value."""
        return VALUE_RANGES[self.type]

    def decode(self, raw: int) -> float:
        """The value in ``unit``; NaN if there is no reading."""
        return NAN if raw == self.none else raw / self.per_unit

    def encode(self, value: float) -> int:
        """The nearest raw value. Raises UsageError if the value is out of range."""
        low, high = self.span
        if not low - 0.5 <= value * self.per_unit <= high + 0.5:
            raise UsageError(
                f"{self.name} = {value:g} {self.unit} must be between {low * self.lsb:g} and {high * self.lsb:g}."
            )
        return min(max(round(value * self.per_unit), low), high)

    def rounded(self, value: float) -> float:
        """The value after encoding and decoding; NaN stays NaN."""
        return value if value != value else self.encode(value) / self.per_unit


class Register(TomlTable):
    """One value, or ``count`` records of ``field``."""

    name: str
    address: int = Field(ge=0, le=0xFFFF)
    type: Literal["u16", "i16", "u32", "i32", "record"]
    access: Literal["r", "rw"]
    text: str
    lsb: Annotated[float, Field(gt=0)] = 1.0
    unit: str = ""
    range: tuple[int, int] | None = None
    values: NumberNames = Field(default_factory=dict)
    safe: int | None = None
    none: int | None = None
    since: int = 0  # version of the map that added it; 0: not later than ``Device.since``
    count: int = Field(default=1, ge=1)
    field: tuple[Value, ...] = ()

    @model_validator(mode="after")
    def _check_record(self) -> "Register":
        if (self.type == "record") != bool(self.field):
            raise ValueError(f"{self.name}: type 'record' requires fields, and no other type may have them")
        if self.access == "rw" and self.safe is None:
            raise ValueError(f"{self.name} may be written, so 'safe' is required")
        return self

    @cached_property
    def value(self) -> Value:
        """Its value. Raises UsageError for a ring."""
        if self.type == "record":
            raise UsageError(f"Register {self.name} is a ring buffer of records, not a number.")
        return Value(
            name=self.name, type=self.type, text=self.text, lsb=self.lsb, unit=self.unit, none=self.none
        )

    @cached_property
    def record_words(self) -> int:
        """Words of one record."""
        return sum(f.words for f in self.field)

    @cached_property
    def words(self) -> int:
        """Number of addresses."""
        return self.count * self.record_words if self.type == "record" else self.value.words

    @property
    def limits(self) -> tuple[int, int]:
        """Smallest and largest raw value that may be written."""
        if self.values:
            return min(map(int, self.values)), max(map(int, self.values))
        return self.range or VALUE_RANGES[self.type]


class DeviceFault(TomlTable):
    """A fault that a device can report."""

    name: str
    code: int = Field(ge=1, le=0xFFFF)
    cause: str
    remedy: str
    since: int = 0  # as of a register


class Device(TomlTable):
    """The device of a map."""

    name: str
    kind: int
    version: int = Field(ge=1)
    since: int = 0  # first version that talks with this one, in which registers were added only; 0: this one
    default_address: int = Field(ge=1, le=247)
    summary: str


class Block(TomlTable):
    """Consecutive registers that are transmitted together, by the names of the first and the last."""

    first: str
    last: str


class _RegisterMapFile(TomlTable):
    device: Device
    blocks: dict[Literal["status", "command", "settings"], Block]
    register_: tuple[Register, ...] = Field(alias="register", min_length=1)
    fault: tuple[DeviceFault, ...] = ()


class RawValues(dict[str, int]):
    """Raw values by register. Raises UsageError for an unknown name."""

    def __missing__(self, name: str) -> int:
        raise UsageError(f"There is no register '{name}'{suggestion(name, list(self))}.")


@dataclass(frozen=True, eq=False)
class RegisterMap:
    """A device's registers by name and its faults by code."""

    device: Device
    registers: Mapping[str, Register]
    blocks: Mapping[str, tuple[Register, ...]]
    faults: Mapping[int, DeviceFault]

    def __getitem__(self, name: str) -> Register:
        if name not in self.registers:
            raise UsageError(f"The {self.device.name} has no register '{name}'.")
        return self.registers[name]

    @cached_property
    def names(self) -> Mapping[str, Set[str]]:
        """Names of the registers of each block."""
        return {block: {r.name for r in registers} for block, registers in self.blocks.items()}

    @cached_property
    def hash(self) -> int:
        """First 32 bits of the SHA-256 of ``canonical``."""
        return int.from_bytes(hashlib.sha256(self.canonical.encode()).digest()[:4])

    @property
    def canonical(self) -> str:
        """The text on which both sides must agree: one line for the device and for each register, field and fault.

        Without what was added since the first version that this one talks with: a side that does not know an addition
        does not use it.
        """
        lines = [f"device {self.device.name} {self.first_version}"]
        for r in self.registers.values():
            lines += _lines(r) if r.since <= self.first_version else []
        faults = (f for f in self.faults.values() if f.since <= self.first_version)
        return "\n".join([*lines, *(f"fault {f.name} {f.code}" for f in faults)]) + "\n"

    @property
    def first_version(self) -> int:
        """The first version that talks with this one."""
        return self.device.since or self.device.version

    def start(self, block: str) -> int:
        """Address of a block's first word."""
        return self.blocks[block][0].address

    def size(self, block: str, version: int | None = None) -> int:
        """Words of a block, as a version of the map has it: what a version adds is at the end of a block."""
        last = [r for r in self.blocks[block] if version is None or r.since <= version][-1]
        return last.address + last.words - self.start(block)

    def encode(self, block: str, values: Mapping[str, int]) -> list[int]:
        """Raw values as the words of a block; registers not given are 0. Raises UsageError for an unknown name."""
        words: list[int] = []
        if not values.keys() <= self.names[block]:
            unknown = min(values.keys() - self.names[block])
            raise UsageError(f"The {self.device.name} has no register '{unknown}' in its {block} block.")
        for r in self.blocks[block]:
            words += to_words(values.get(r.name, 0), r.words)
        return words

    def decode(self, block: str, words: Sequence[int]) -> RawValues:
        """Raw values of a block's registers by name, without its ring."""
        start = self.start(block)
        return RawValues(
            (r.name, from_words(words[r.address - start : r.address - start + r.words], r.type))
            for r in self.blocks[block]
            if not r.field and r.address - start + r.words <= len(words)
        )

    def fields(self, *names: str) -> tuple[Value, ...]:
        """The fields of a sample. Raises UsageError if they differ from ``names``."""
        found = self["ring"].field
        if tuple(f.name for f in found) != names:
            field_names = ", ".join(f.name for f in found)
            raise UsageError(f"Samples of the {self.device.name} have {field_names}, not {', '.join(names)}.")
        return found

    def records(self, words: Sequence[int], count: int) -> list[tuple[int, ...]]:
        """Raw values of the first ``count`` records of the ring, from the words of the status block."""
        ring = self.blocks["status"][-1]
        at, found = ring.address - self.start("status"), []
        for _ in range(count):
            row = []
            for f in ring.field:
                row.append(from_words(words[at : at + f.words], f.type))
                at += f.words
            found.append(tuple(row))
        return found


def _lines(r: Register) -> list[str]:
    many = [f"field {f.name} {f.type} {f.lsb!r} {f.unit} {f.none} {_numbered(f.flags)}" for f in r.field]
    what = f"{r.type} {r.access} {r.lsb!r} {r.unit} {r.count}"
    written = f" {r.limits} {_numbered(r.values)}" if r.access == "rw" else ""
    return [f"register {r.name} {r.address:04X} {what}{written}", *many]


def _numbered(names: NumberNames) -> str:
    return ",".join(f"{number}={name}" for number, name in names.items())


def to_words(raw: int, words: int) -> list[int]:
    """Words of a raw value, high word first.

    >>> to_words(-2, 2), to_words(5, 1)
    ([65535, 65534], [5])
    """
    return [(raw >> 16) & 0xFFFF, raw & 0xFFFF] if words == 2 else [raw & 0xFFFF]


def from_words(words: Sequence[int], kind: str) -> int:
    """The raw value of one or two words.

    >>> from_words([65535, 65534], "i32"), from_words([65535, 65534], "u32")
    (-2, 4294967294)
    """
    raw = (words[0] << 16 | words[1]) if kind.endswith("32") else words[0]
    bits = 32 if kind.endswith("32") else 16
    return raw - (1 << bits) if kind.startswith("i") and raw >> (bits - 1) else raw


@cache
def load_register_map(name: str) -> RegisterMap:
    """The map of a device by name. Raises ConfigError for an invalid file.

    >>> load_register_map("amplifier")["current"].lsb
    1e-06
    """
    file = load_toml(_RegisterMapFile, shipped("firmware_protocol") / f"{name}.toml")
    ordered = sorted(file.register_, key=lambda r: r.address)
    for before, after in zip(ordered, ordered[1:]):
        if before.address + before.words > after.address:
            raise UsageError(f"{name}.toml: registers {before.name} and {after.name} overlap.")
    blocks: dict[str, tuple[Register, ...]] = {key: _between(ordered, b) for key, b in file.blocks.items()}
    return RegisterMap(file.device, {r.name: r for r in ordered}, blocks, {f.code: f for f in file.fault})


def _between(ordered: list[Register], block: Block) -> tuple[Register, ...]:
    names = [r.name for r in ordered]
    return tuple(ordered[names.index(block.first) : names.index(block.last) + 1])
