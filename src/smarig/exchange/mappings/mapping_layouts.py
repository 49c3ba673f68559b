"""Where a mapping finds its table: in texts, matrices, sheets and groups, and in which part of the rows."""

from typing import Literal

from pydantic import Field, model_validator

from smarig.core import TomlTable


class TextLayout(TomlTable):
    """[file]: ``names`` where there is no header row; ``header_starts`` for files of several tables."""

    names: tuple[str, ...] = ()  # names of the columns, if there is no header row
    delimiter: Literal["", "comma", "semicolon", "tab", "space"] = ""  # between columns; empty: detected
    decimal: Literal[".", ","] = "."  # decimal sign
    thousands: Literal["", ",", ".", "'", "space"] = ""  # between groups of three digits
    header_line: int = Field(default=0, ge=0)  # line of the header, from 1; 0: where the columns are found
    units_rows: int = Field(default=0, ge=0, le=10)  # rows under the header that are skipped, such as units
    header_starts: str = ""  # start of the header of each table, in files of several tables
    table: int = Field(default=1, ge=1)  # number of the table in such a file, from 1
    tables: int = Field(default=1, ge=0)  # tables from there on that are one record; 0: all to the end
    interruptions: Literal["refuse", "leave out"] = "refuse"  # treatment of lines of text between the rows
    no_reading: tuple[str, ...] = ()  # texts of cells that stand for no reading


class MatLayout(TomlTable):
    """[mat]: variables of MATLAB files instead of columns of a text.

    ``files``: names of files that belong together in one folder, with '*' for the same text in each. ``loops``:
    whether each column or each row of the matrices is one loop; "none" for vectors. ``matrix``: a matrix whose signals
    are columns (or rows, along its longer side), named "column 1", "column 2", … beside vectors of its length.
    """

    files: tuple[str, ...] = ()  # names of files that belong together; * is the same text in each
    loops: Literal["none", "columns", "rows"] = "none"  # which part of the matrices is one loop
    matrix: str = ""  # the matrix that holds the signals side by side, as column 1, column 2, …

    @model_validator(mode="after")
    def _patterns(self) -> "MatLayout":
        for pattern in self.files:
            if pattern.count("*") != 1 or "/" in pattern or "\\" in pattern:
                raise ValueError(f"files: '{pattern}' is not a file name with one '*'")
        if self.matrix and (self.files or self.loops != "none"):
            raise ValueError(
                "the columns of a matrix are signals of one file, no loops; leave out files and loops"
            )
        return self


class WorkbookLayout(TomlTable):
    """[workbook]: a sheet of an Excel workbook, with its header row."""

    sheet: str  # name of the sheet
    header_row: int = Field(default=1, ge=0)  # row of the names, from 1; 0: there is none, names gives them
    units_rows: int = Field(default=0, ge=0, le=10)  # rows under the header that are skipped, such as units
    names: tuple[str, ...] = ()  # names of the columns, in place of those in the header
    no_reading: tuple[str, ...] = ()  # texts of cells that stand for no reading


class Hdf5Layout(TomlTable):
    """[hdf5]: data sets of one length in a group of an HDF5 file; columns of a table are named DATASET/COLUMN."""

    group: str = "/"  # path of the group
    logs: bool = False  # the groups below it that hold a clock and a signal each are joined on time


class ParquetLayout(TomlTable):
    """[parquet]: columns of a Parquet file; it has no entries."""


class NpzLayout(TomlTable):
    """[npz]: vectors of one length in a NumPy archive; it has no entries."""


class TdmsLayout(TomlTable):
    """[tdms]: channels of one length in a group of a LabVIEW TDMS file, and "time", the clock that they share."""

    group: str  # name of the group


class RowRange(TomlTable):
    """[rows]: a part of the rows of the table, as that of one load; the others are left out."""

    first: int = Field(ge=1)  # number of the first row, from 1
    last: int = Field(ge=1)  # number of the last row

    @model_validator(mode="after")
    def _in_order(self) -> "RowRange":
        if self.last <= self.first:
            raise ValueError("'last' must be above 'first'")
        return self

    def of(self, rows: int) -> slice:
        """The rows as a slice; ValueError if there are fewer."""
        if self.last > rows:
            raise ValueError(f"the table has {rows} rows, but [rows] ends at row {self.last}")
        return slice(self.first - 1, self.last)
