"""Files that hold no data to import: what they are, and which command takes them."""

from pathlib import Path

from smarig.core import MODEL, PAGE, RUN, TOML, DataError, content_kind

_TAKES = {
    RUN: "`smarig identify`, `verify`, `report` and `export` take it",
    MODEL: "`smarig verify MODEL RUN…`, `simulate` and `report` take it",
    PAGE: "open it with a browser",
    TOML: "`--map` takes mapping files, `--rig` rigs",
    "a Rerun recording": "`smarig view` takes runs",
}
_OTHERS = {
    b"SQLite format 3\x00": "an SQLite database",
    b"%PDF": "a PDF document",
    b"\x89PNG": "a picture",
    b"\xff\xd8\xff": "a picture",
    b"\x1f\x8b": "a file compressed by gzip; unpack it",
    b"\xd0\xcf\x11\xe0": "an old Excel workbook (.xls); save it as .xlsx",
    b"TDSm": "a LabVIEW TDMS file; export it as text or HDF5",
    b"7z\xbc\xaf": "a file compressed by 7-Zip; unpack it",
}


def check_data_file(path: Path) -> None:
    """Raise DataError for a file that is known to hold no measured table; its sentence says what the file is."""
    with path.open("rb") as file:
        head = file.read(16)
    kind = content_kind(path)
    if kind == RUN and not _is_run(path):
        raise DataError(f"{path} is an SQLite database, but no run of smarig. Export its table as CSV.")
    if kind in _TAKES:
        raise DataError(f"{path} is {_noun(kind)} of smarig, not measured data: {_TAKES[kind]}.")
    for start, what in _OTHERS.items():
        if head.startswith(start):
            raise DataError(f"{path} is {what}. It holds no table that can be read.")


def _is_run(path: Path) -> bool:
    """Whether an SQLite file has the tables of a run, by the text of their definitions in its first bytes."""
    with path.open("rb") as file:
        head = file.read(65536)
    return b"CREATE TABLE run" in head or b"CREATE TABLE sample" in head


def _noun(kind: str) -> str:
    return "a configuration file" if kind == TOML else kind
