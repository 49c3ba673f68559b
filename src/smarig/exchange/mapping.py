"""Mapping files: what the columns of somebody else's data mean (configs/imports/NAME.toml).

Knows the schema and its internal consistency. Refuses to know any data, and to guess a unit.
"""

import re
from pathlib import Path
from typing import Literal

from pydantic import Field, model_validator

from smarig.config import locate
from smarig.errors import ConfigError, UsageError
from smarig.exchange.units import dimension
from smarig.toml_file import Section, load

Channel = Literal[
    "current_command_A",
    "current_A",
    "voltage_V",
    "temperature_degC",
    "input",
    "position",
    "ambient_degC",
]
CHANNEL_UNITS = {
    "current_command_A": "A",
    "current_A": "A",
    "voltage_V": "V",
    "temperature_degC": "degC",
    "ambient_degC": "degC",
}


class TextLayout(Section):
    """[file]: ``names`` where there is no header row; ``header_starts`` for files of several tables."""

    names: tuple[str, ...] = ()
    delimiter: Literal["", "comma", "semicolon", "tab", "space"] = ""
    decimal: Literal[".", ","] = "."
    header_starts: str = ""
    table: int = Field(default=1, ge=1)


class MatLayout(Section):
    """[mat]: variables of MATLAB files instead of columns of a text.

    ``files``: names that belong together and lie side by side, '*' standing for the same text in each;
    ``loops``: whether each column or each row of the variables' matrices is one loop, or they are vectors.
    """

    files: tuple[str, ...] = ()
    loops: Literal["none", "columns", "rows"] = "none"

    @model_validator(mode="after")
    def _patterns(self) -> "MatLayout":
        for pattern in self.files:
            if pattern.count("*") != 1 or "/" in pattern or "\\" in pattern:
                raise ValueError(f"files: '{pattern}' is not a file name with one '*'")
        return self


class TimeAxis(Section):
    """[time]: a column, or a period (rows_per_period rows each, the column then counting within it)."""

    column: str = ""
    unit: str = "s"
    period_s: float | None = Field(default=None, gt=0)
    rows_per_period: int = Field(default=1, ge=1)
    repeated: Literal["refuse", "mean", "keep_order"] = "refuse"

    @model_validator(mode="after")
    def _has_a_clock(self) -> "TimeAxis":
        _expect(self.unit, "time", "unit")
        if not self.column and self.period_s is None:
            raise ValueError("give 'column' or 'period_s'; data without time have no [time] table at all")
        return self


class Column(Section):
    """One channel: value = scale × cell + offset, in ``unit``."""

    column: str
    unit: str
    scale: float = Field(default=1.0, allow_inf_nan=False)
    offset: float = Field(default=0.0, allow_inf_nan=False)


class Branch(Section):
    """One branch of data that keep several branches on one row; unfolded in the order of the file."""

    direction: Literal["up", "down"]
    columns: dict[Channel, Column] = Field(min_length=1)


class Quantity(Section):
    """What input or output is, and the unit it is stored in."""

    quantity: str
    unit: str


class Input(Quantity):
    """[input]: the channel that drives the hysteresis."""

    channel: Channel


class Compare(Section):
    """Two columns that should agree: rows further apart than ``within`` lose the ``blames`` channels."""

    columns: tuple[str, str]
    within: float = Field(gt=0)
    unit: str
    blames: tuple[Channel, ...] = ()


class MappingFile(Section):
    """configs/imports/NAME.toml"""

    name: str
    summary: str
    source: str
    input: Input
    output: Quantity | None = None
    file: TextLayout = TextLayout()
    mat: MatLayout | None = None
    time: TimeAxis | None = None
    columns: dict[Channel, Column] = Field(default_factory=dict)
    branch: tuple[Branch, ...] = ()
    conditions: dict[str, Column] = Field(default_factory=dict)
    ignore: dict[str, str] = Field(default_factory=dict)
    compare: tuple[Compare, ...] = ()
    steps: Literal["none", "rows"] = "none"
    initial: Literal["", "negative", "positive", "anhysteretic"] = ""
    notes: str = ""

    @model_validator(mode="after")
    def _consistent(self) -> "MappingFile":
        if bool(self.columns) == bool(self.branch):
            raise ValueError("give either [columns] or [[branch]], not both and not neither")
        if self.mat and ("file" in self.model_fields_set or self.branch):
            raise ValueError("[mat] goes with [columns] alone: [file] and [[branch]] describe a text table")
        if self.mat and self.mat.loops != "none" and (self.time or self.steps != "none"):
            raise ValueError("[mat] loops have a number instead of a time: leave out [time] and steps")
        for where, columns in self.tables():
            if self.input.channel not in columns:
                raise ValueError(f"{where} has no '{self.input.channel}', which [input] names as its channel")
            if ("position" in columns) != (self.output is not None):
                raise ValueError(f"[output] and {where}.position belong together: give both or neither")
            for channel, column in columns.items():
                _expect(column.unit, dimension(self.unit_of(channel)), f"{where}.{channel}.unit")
        return self

    def tables(self) -> list[tuple[str, dict[Channel, Column]]]:
        """Column tables in the order in which they are unfolded, with their names."""
        if self.columns:
            return [("columns", self.columns)]
        return [(f"branch.{k}.columns", b.columns) for k, b in enumerate(self.branch)]

    def unit_of(self, channel: str) -> str:
        """Unit a channel is stored in."""
        if channel == "position" and self.output:
            return self.output.unit
        return CHANNEL_UNITS.get(channel, self.input.unit)

    def used(self) -> dict[str, str]:
        """Column names of the file, each with what it is used for."""
        use = {c.column: channel for _, columns in self.tables() for channel, c in columns.items()}
        use |= {c.column: name for name, c in self.conditions.items()}
        use |= {column: "comparison" for c in self.compare for column in c.columns if column not in use}
        if self.time and self.time.column:
            use[self.time.column] = "time"
        return use


def load_mapping(name: str) -> MappingFile:
    """A mapping by shipped name or path; ``NAME:4`` picks the fourth table of a file of several."""
    plain, table = name, None
    if match := re.fullmatch(r"(.+):(\d+)", name):
        plain, table = match[1], int(match[2])
    path = locate("imports", plain)
    mapping = load(MappingFile, path)
    if table is None:
        return mapping
    if not mapping.file.header_starts or not table:
        raise UsageError(f"Mapping {plain} reads files of one table; ':{table}' has no meaning there.")
    return mapping.model_copy(update={"file": mapping.file.model_copy(update={"table": table})})


def mapping_text(name: str) -> str:
    """The mapping file itself, for the record."""
    return locate("imports", re.sub(r":\d+$", "", name)).read_text(encoding="utf-8")


def require_columns(mapping: MappingFile, names: list[str], path: Path, noun: str = "column") -> None:
    """Every column of the file must be used or ignored, every used column must be there; ConfigError.

    ``noun``: what the file calls a column.
    """
    used = mapping.used()
    for column, use in used.items():
        if column not in names:
            raise ConfigError(
                f"{path} has no {noun} '{column}', which mapping {mapping.name} uses as {use}; "
                f"the file has: {', '.join(names)}."
            )
    unknown = [name for name in names if name not in used and name not in mapping.ignore]
    if unknown:
        raise ConfigError(
            f"{path}: {noun} '{unknown[0]}' is not in mapping {mapping.name}; "
            f"map it, or list it under [ignore] with the reason."
        )


def _expect(unit: str, expected: str, key: str) -> None:
    try:
        found = dimension(unit)
    except UsageError as error:
        raise ValueError(f"{key}: {error}") from None
    if found != expected:
        raise ValueError(f"{key}: '{unit}' is a {found}, a {expected} was expected")
