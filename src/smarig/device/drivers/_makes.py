"""The commands of the makes of laboratory supplies: ``makes.toml``, or a file of the user's own."""

import re
from pathlib import Path
from typing import Any

from pydantic import Field

from smarig.core import ConfigError, TomlTable, check_table, read_toml, suggestion

SHIPPED = Path(__file__).with_name("makes.toml")


class SetAndQuery(TomlTable):
    """A setting that can be read back."""

    set: str
    query: str


class SetOnly(TomlTable):
    """A setting."""

    set: str


class OutputCommands(TomlTable):
    """Output on, off, and its state."""

    on: str
    off: str
    query: str


class MeasureCommands(TomlTable):
    """One query each, or one that answers voltage and current in this order. ``while_off``: also of an output that is
    off; one that answers no number then has no current.
    """

    current: str = ""
    voltage: str = ""
    both: str = ""
    while_off: bool = True


class ProtectionQuery(TomlTable):
    """A query whose answer says that a protection has disabled the output: any of ``bits``; 0 for any answer but 0."""

    query: str
    bits: int = Field(ge=0)


class WatchdogCommands(TomlTable):
    """Arm it, query its state, query its time in seconds."""

    arm: tuple[str, ...]
    query: str
    time: str


class Make(TomlTable):
    """One make. See the comment at the head of makes.toml."""

    idn: str
    source: str
    bipolar: bool
    current: SetAndQuery
    voltage: SetOnly
    output: OutputCommands
    measure: MeasureCommands
    prepare: tuple[str, ...] = ()
    protection: ProtectionQuery | None = None
    watchdog: WatchdogCommands | None = None


def makes(file: str = "") -> dict[str, Make]:
    """The makes by name: those of ``file`` first, then the shipped ones. ConfigError for a wrong file."""
    found: dict[str, Make] = {}
    for path in [Path(file)] * bool(file) + [SHIPPED]:
        for name, table in read_toml(path).items():
            found.setdefault(name, check_table(Make, table, f"{path}: make '{name}'"))
    return found


def may_be_supply(identity: str, file: str = "") -> bool:
    """Whether an answer is an SCPI identity, whose fields commas separate, or that of a known make."""
    own = (make.idn for make in makes(file).values())
    return identity.count(",") >= 2 or any(re.search(idn, identity, re.IGNORECASE) for idn in own)


def make_of(identity: str, named: str, file: str = "") -> tuple[str, Make]:
    """The make that is named, or whose pattern is in the identity. Raises ConfigError naming those that are known."""
    known = makes(file)
    if named:
        if named not in known:
            raise ConfigError(f"No make '{named}' of supplies{suggestion(named, list(known))}.")
        return named, known[named]
    for name, make in known.items():
        if re.search(make.idn, identity, re.IGNORECASE):
            return name, make
    raise ConfigError(
        f"'{identity}' is of no known make. The makes are: {', '.join(known)}. Give settings.make, or a file with its "
        "commands in settings.makes."
    )


def filled(command: str, **values: Any) -> str:
    """The command with its values: {channel}, {value}, {lease}, {largest}."""
    return command.format(**values)
