"""Files that hold no data to import: what they are, and which command takes them."""

from pathlib import Path

from smarig.core import MODEL, PAGE, RUN, TABLE, TOML, DataError, content_kind, swapped_file

_OTHERS = {
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
    if kind == TOML and path.suffix.lower() != ".toml":
        kind = ""  # lines such as "Samples = 100" or "sep=;" stand before many tables
    if kind in (RUN, MODEL, PAGE, TOML, "a Rerun recording"):
        raise DataError(swapped_file(path, TABLE))
    for start, what in _OTHERS.items():
        if head.startswith(start):
            raise DataError(f"{path} is {what}. It holds no table that can be read.")
