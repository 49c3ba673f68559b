"""Files that hold no data to import: what they are, and which command takes them."""

from pathlib import Path

from smarig.core import MODEL, PAGE, RUN, TABLE, TOML, DataError, content_kind, swapped_file

_REFUSED = (
    RUN,
    MODEL,
    PAGE,
    TOML,
    "a Rerun recording",
    "a PDF document",
    "a picture",
    "a file compressed by gzip",
    "a file compressed by 7-Zip",
    "an old Excel workbook (.xls)",
)


def check_data_file(path: Path) -> None:
    """Raise DataError for a file that is known to hold no measured table; its sentence says what the file is."""
    kind = content_kind(path)
    if kind == TOML and path.suffix.lower() != ".toml":
        kind = ""  # lines such as "Samples = 100" or "sep=;" stand before many tables
    if kind in _REFUSED:
        raise DataError(swapped_file(path, TABLE))
