"""Mapping files (configs/imports/NAME.toml): the meaning of the columns of a data file. Units are never guessed."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from smarig.config import locate
from smarig.core import MAPPING_FILE, ConfigError, TomlTable, UsageError, load_toml, printable, shown
from smarig.exchange.mappings.mapping_layouts import (
    Hdf5Layout,
    MatLayout,
    NpzLayout,
    ParquetLayout,
    RowRange,
    TdmsLayout,
    TextLayout,
    WorkbookLayout,
)
from smarig.exchange.units.unit_conversion import check_same_quantity, check_unit
from smarig.exchange.units.units import spelled

Unit = Annotated[str, AfterValidator(spelled)]
ChannelName = Literal[
    "current_command_A",
    "current_A",
    "voltage_V",
    "temperature_degC",
    "input",
    "position",
    "ambient_degC",
]
_TABLE = re.compile(r"(.+):(\d{1,9})")  # a mapping and the number of a table
CHANNEL_UNITS = {
    "current_command_A": "A",
    "current_A": "A",
    "voltage_V": "V",
    "temperature_degC": "degC",
    "ambient_degC": "degC",
}

CONDITION_UNITS = {
    "stress": "MPa",
    "load": "N",
    "room_temperature": "degC",
    "chamber_temperature": "degC",
    "magnetic_field": "T",
    "frequency": "Hz",
}  # conditions that runs are compared by; a text such as specimen, and other names, are kept and compared too


class TimeAxis(TomlTable):
    """[time]: a column, or a period with ``rows_per_period`` rows, within which the column then counts."""

    column: str = ""  # name of the column of times
    unit: Unit = "s"  # unit of the column
    written: Literal["number", "clock"] = "number"  # "clock": times of day or dates, such as 12:03:04.5
    fraction: str = ""  # name of a column of fractions that are added to whole seconds, such as milliseconds
    fraction_unit: Unit = "ms"  # unit of the fractions
    period_s: float | None = Field(default=None, gt=0)  # duration of a period in which the column counts
    rows_per_period: int = Field(default=1, ge=1)  # rows per period
    repeated: Literal["refuse", "mean", "keep_order"] = "refuse"  # treatment of rows with the same time
    empty: Literal["refuse", "leave out"] = "refuse"  # treatment of rows without a time
    restarts: Literal["refuse", "join"] = "refuse"  # "join": a clock that starts again goes on one step later

    @model_validator(mode="after")
    def _has_a_clock(self) -> "TimeAxis":
        _check_convertible(self.unit, "s", "unit")
        _check_convertible(self.fraction_unit, "s", "fraction_unit")
        if self.fraction and not self.column:
            raise ValueError("'fraction' is added to a column of whole seconds; give 'column' too")
        if not self.column and self.period_s is None:
            raise ValueError("give 'column' or 'period_s', or leave out [time] for data without time")
        if self.written == "clock" and (not self.column or self.unit != "s"):
            raise ValueError('written = "clock" needs a column, and no unit')
        return self


class Column(TomlTable):
    """One channel: value = scale × cell + offset, in ``unit``."""

    column: str  # name of the column in the file
    unit: Unit  # unit of scale × cell + offset
    scale: float = Field(default=1.0, allow_inf_nan=False)  # factor of the cell
    offset: float = Field(default=0.0, allow_inf_nan=False)  # added after scaling


class Condition(TomlTable):
    """A condition of the run: the mean of a column, a constant value, or a text."""

    column: str = ""  # name of the column in the file
    value: float | None = Field(default=None, allow_inf_nan=False)  # in place of a column: constant
    text: str = ""  # in place of a column: a name, for example of the specimen
    unit: str = ""  # unit of scale × cell + offset, or of the value
    scale: float = Field(default=1.0, allow_inf_nan=False)  # factor of the cell
    offset: float = Field(default=0.0, allow_inf_nan=False)  # added after scaling

    @model_validator(mode="after")
    def _one_source(self) -> "Condition":
        if bool(self.column) + (self.value is not None) + bool(self.text) != 1:
            raise ValueError("give exactly one of column, value and text")
        if bool(self.text) == bool(self.unit):
            raise ValueError("a column or a value needs its unit; a text has none")
        return self


class Branch(TomlTable):
    """One branch of data with several branches in one row; unfolded in the order of the file."""

    direction: Literal["up", "down"]  # direction of the input on the branch
    rows: Literal["forward", "backward"] = "forward"  # "backward": read from the last row to the first
    columns: dict[ChannelName, Column] = Field(min_length=1)  # columns of the branch, by channel


class MappedQuantity(TomlTable):
    """The quantity of input or output, and the unit in which it is stored."""

    quantity: str  # name of the quantity
    unit: Unit  # unit in which it is stored


class InputChannel(MappedQuantity):
    """[input]: the channel that drives the hysteresis."""

    channel: ChannelName  # channel that drives the hysteresis


class OutputChannel(MappedQuantity):
    """[output]: quantity and unit of the position."""

    zero: Literal["shared", "own"] = "shared"  # "own": the zero of each file is arbitrary


class SensorComparison(TomlTable):
    """Two columns that should agree: rows that differ by more than ``within`` lose the ``blames`` channels."""

    columns: tuple[str, str]  # two columns that should agree
    within: float = Field(gt=0)  # largest difference allowed
    unit: str  # unit of this difference
    blames: tuple[ChannelName, ...] = ()  # channels left out where the columns disagree


class MappingFile(TomlTable):
    """configs/imports/NAME.toml"""

    file_kind = MAPPING_FILE
    name: str  # name of the mapping
    summary: str  # one line, for smarig list
    source: str  # origin of the data
    own_units: tuple[str, ...] = ()  # unknown units that are close to a known one, and meant
    input: InputChannel  # channel that drives the hysteresis, with quantity and unit
    output: OutputChannel | None = None  # quantity and unit of the position
    file: TextLayout = TextLayout()  # layout of the text
    mat: MatLayout | None = None  # variables of MATLAB files
    workbook: WorkbookLayout | None = None  # sheet of an Excel workbook
    hdf5: Hdf5Layout | None = None  # group of an HDF5 file
    parquet: ParquetLayout | None = None  # columns of a Parquet file
    npz: NpzLayout | None = None  # vectors of a NumPy archive
    tdms: TdmsLayout | None = None  # group of a LabVIEW TDMS file
    rows: RowRange | None = None  # a part of the rows; leave out for all
    time: TimeAxis | None = None  # time axis; leave out if the data have no time
    columns: dict[ChannelName, Column] = Field(default_factory=dict)  # columns, by channel
    branch: tuple[Branch, ...] = ()  # in place of columns: several branches in one row
    conditions: dict[str, Condition] = Field(
        default_factory=dict
    )  # quantities kept with the run, for example a load
    ignore: dict[str, str] = Field(default_factory=dict)  # columns not used, each with the reason
    compare: tuple[SensorComparison, ...] = ()  # pairs of columns that should agree
    steps: Literal["none", "rows"] = "none"  # whether every row is a settled step
    initial: Literal["", "negative", "positive", "anhysteretic"] = ""  # state at the start; empty: unknown
    notes: str = ""  # free text

    @model_validator(mode="after")
    def _consistent(self) -> "MappingFile":
        if bool(self.columns) == bool(self.branch):
            raise ValueError("give exactly one of [columns] and [[branch]]")
        if self.mat and ("file" in self.model_fields_set or (self.branch and self.mat.loops != "none")):
            raise ValueError(
                "[mat] describes no text, and its loops no branches; leave out [file] and [[branch]]"
            )
        places = [
            key
            for key in ("file", "mat", "workbook", "hdf5", "parquet", "npz", "tdms")
            if key in self.model_fields_set
        ]
        if len(places) > 1:
            raise ValueError(f"[{places[0]}] and [{places[1]}] describe different files; give one of them")
        if self.mat and self.mat.loops != "none" and (self.time or self.steps != "none"):
            raise ValueError("the loops of [mat] have a number and no time; leave out [time] and steps")
        for key, unit in self._units():
            _check_unit(unit, self.own_units, key)
        for name, condition in self.conditions.items():
            if expected := CONDITION_UNITS.get(name):
                if condition.text:
                    raise ValueError(f"conditions.{name}: a text was given, but a number was expected")
                _check_convertible(condition.unit, expected, f"conditions.{name}.unit")
        for where, columns in self.tables():
            if self.input.channel not in columns:
                raise ValueError(f"{where} has no '{self.input.channel}', which [input] names as its channel")
            if ("position" in columns) != (self.output is not None):
                raise ValueError(f"[output] and {where}.position belong together; give both or neither")
            for channel, column in columns.items():
                _check_convertible(column.unit, self.unit_of(channel), f"{where}.{channel}.unit")
        return self

    def _units(self) -> Iterator[tuple[str, str]]:
        """Each unit of the file with its key."""
        yield "input.unit", self.input.unit
        if self.output:
            yield "output.unit", self.output.unit
        for where, columns in self.tables():
            yield from ((f"{where}.{channel}.unit", column.unit) for channel, column in columns.items())
        yield from ((f"conditions.{name}.unit", c.unit) for name, c in self.conditions.items())

    @property
    def format(self) -> str:
        """The format of the files that it describes, as import names it."""
        names = {"mat": self.mat, "xlsx": self.workbook, "hdf5": self.hdf5, "parquet": self.parquet}
        names |= {"npz": self.npz, "tdms": self.tdms}
        return next((name for name, layout in names.items() if layout is not None), "csv")

    def tables(self) -> list[tuple[str, dict[ChannelName, Column]]]:
        """Column tables with their names, in the order in which they are unfolded."""
        if self.columns:
            return [("columns", self.columns)]
        return [(f"branch.{k}.columns", b.columns) for k, b in enumerate(self.branch)]

    def unit_of(self, channel: str) -> str:
        """The unit in which a channel is stored."""
        if channel == "position" and self.output:
            return self.output.unit
        return CHANNEL_UNITS.get(channel, self.input.unit)

    def used(self) -> dict[str, str]:
        """Column names of the file with their uses."""
        use = {c.column: channel for _, columns in self.tables() for channel, c in columns.items()}
        use |= {c.column: name for name, c in self.conditions.items() if c.column}
        use |= {column: "comparison" for c in self.compare for column in c.columns if column not in use}
        if self.time and self.time.column:
            use[self.time.column] = "time"
        if self.time and self.time.fraction:
            use[self.time.fraction] = "time"
        return use


def load_mapping(name: str) -> MappingFile:
    """A mapping by shipped name or path; ``NAME:4`` selects the fourth table of a file of several."""
    plain, table = name, None
    if match := _TABLE.fullmatch(name):
        plain, table = match[1], int(match[2])
    path = locate("imports", plain)
    mapping = load_toml(MappingFile, path)
    if table is None:
        return mapping
    if not mapping.file.header_starts or not table:
        raise UsageError(
            f"Mapping {plain} reads files of one table; ':{table}' has no meaning there. Leave it out."
        )
    return mapping.model_copy(update={"file": mapping.file.model_copy(update={"table": table})})


def mapping_text(name: str) -> str:
    """The text of the mapping file, for the record."""
    match = _TABLE.fullmatch(name)
    return locate("imports", match[1] if match else name).read_text(encoding="utf-8")


def require_columns(mapping: MappingFile, names: list[str], path: Path, noun: str = "column") -> None:
    """Check that every column of the file is used or ignored, and that every used column exists; ConfigError.

    ``noun``: the word for a column in this kind of file.
    """
    used = mapping.used()
    for column, use in used.items():
        if column not in names:
            raise ConfigError(
                f"{path} has no {noun} {shown(column)}, which mapping {mapping.name} uses as {use}. "
                f"The file has: {', '.join(printable(name, 80) for name in names)}."
            )
    unknown = [name for name in names if name not in used and name not in mapping.ignore]
    if unknown:
        raise ConfigError(
            f"{path}: {noun} {shown(unknown[0])} is not in mapping {mapping.name}. "
            f"Map it, or list it under [ignore] with the reason."
        )


def _check_unit(unit: str, own: tuple[str, ...], key: str) -> None:
    try:
        check_unit(unit, own)
    except UsageError as error:
        raise ValueError(f"{key}: {error}") from None


def _check_convertible(unit: str, to: str, key: str) -> None:
    try:
        check_same_quantity(unit, to)
    except UsageError as error:
        raise ValueError(f"{key}: {error}") from None
