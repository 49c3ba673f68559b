"""Mapping files: what the columns of somebody else's data mean (configs/imports/NAME.toml).

Knows the schema and its internal consistency. Refuses to know any data, and to guess a unit.
"""

import re
from pathlib import Path
from typing import Literal

from pydantic import Field, model_validator

from smarig.config import locate
from smarig.core import ConfigError, TomlTable, UsageError, load_toml
from smarig.exchange.unit_conversion import dimension

ChannelName = Literal[
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


class TextLayout(TomlTable):
    """[file]: ``names`` where there is no header row; ``header_starts`` for files of several tables."""

    names: tuple[str, ...] = ()  # of the columns, where there is no header row
    delimiter: Literal["", "comma", "semicolon", "tab", "space"] = ""  # of columns; empty: found by itself
    decimal: Literal[".", ","] = "."  # sign before the decimals
    header_starts: str = ""  # how the header of each table begins, in files of several
    table: int = Field(default=1, ge=1)  # which of them, counted from 1


class MatLayout(TomlTable):
    """[mat]: variables of MATLAB files instead of columns of a text.

    ``files``: names that belong together and lie side by side, '*' standing for the same text in each;
    ``loops``: whether each column or each row of the variables' matrices is one loop, or they are vectors.
    """

    files: tuple[str, ...] = ()  # names that belong together, * standing for the same text
    loops: Literal["none", "columns", "rows"] = "none"  # whether a column or a row of the matrices is a loop

    @model_validator(mode="after")
    def _patterns(self) -> "MatLayout":
        for pattern in self.files:
            if pattern.count("*") != 1 or "/" in pattern or "\\" in pattern:
                raise ValueError(f"files: '{pattern}' is not a file name with one '*'")
        return self


class TimeAxis(TomlTable):
    """[time]: a column, or a period (rows_per_period rows each, the column then counting within it)."""

    column: str = ""  # of the times
    unit: str = "s"  # of the column
    period_s: float | None = Field(default=None, gt=0)  # time of a period, where the column counts within one
    rows_per_period: int = Field(default=1, ge=1)  # rows of a period
    repeated: Literal["refuse", "mean", "keep_order"] = "refuse"  # what becomes of rows of one time

    @model_validator(mode="after")
    def _has_a_clock(self) -> "TimeAxis":
        _expect(self.unit, "time", "unit")
        if not self.column and self.period_s is None:
            raise ValueError("give 'column' or 'period_s'; data without time have no [time] table at all")
        return self


class Column(TomlTable):
    """One channel: value = scale × cell + offset, in ``unit``."""

    column: str  # its name in the file
    unit: str  # of scale × cell + offset
    scale: float = Field(default=1.0, allow_inf_nan=False)  # first multiplied
    offset: float = Field(default=0.0, allow_inf_nan=False)  # then added


class Branch(TomlTable):
    """One branch of data that keep several branches on one row; unfolded in the order of the file."""

    direction: Literal["up", "down"]  # of the input along it
    columns: dict[ChannelName, Column] = Field(min_length=1)  # of this branch, by channel


class MappedQuantity(TomlTable):
    """What input or output is, and the unit it is stored in."""

    quantity: str  # what it is, in words
    unit: str  # it is stored in


class InputChannel(MappedQuantity):
    """[input]: the channel that drives the hysteresis."""

    channel: ChannelName  # that drives the hysteresis


class SensorComparison(TomlTable):
    """Two columns that should agree: rows further apart than ``within`` lose the ``blames`` channels."""

    columns: tuple[str, str]  # two that should agree
    within: float = Field(gt=0)  # how far apart they may be
    unit: str  # of that
    blames: tuple[ChannelName, ...] = ()  # channels that are lost where they do not agree


class MappingFile(TomlTable):
    """configs/imports/NAME.toml"""

    name: str  # of the file
    summary: str  # one line, for smarig list
    source: str  # where the data come from
    input: InputChannel  # what drives the hysteresis
    output: MappedQuantity | None = None  # what position is
    file: TextLayout = TextLayout()  # how the text is laid out
    mat: MatLayout | None = None  # variables of MATLAB files
    time: TimeAxis | None = None  # left out where data have none
    columns: dict[ChannelName, Column] = Field(default_factory=dict)  # what the columns are, by channel
    branch: tuple[Branch, ...] = ()  # in place of columns: several branches on one row
    conditions: dict[str, Column] = Field(default_factory=dict)  # kept with the run: a load, …
    ignore: dict[str, str] = Field(default_factory=dict)  # columns not used, each with the reason
    compare: tuple[SensorComparison, ...] = ()  # columns that should agree
    steps: Literal["none", "rows"] = "none"  # whether every row is a settled step
    initial: Literal["", "negative", "positive", "anhysteretic"] = ""  # where the data begin; empty: unknown
    notes: str = ""  # a remark

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

    def tables(self) -> list[tuple[str, dict[ChannelName, Column]]]:
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
    mapping = load_toml(MappingFile, path)
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
