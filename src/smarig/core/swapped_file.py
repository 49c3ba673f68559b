"""A file given in the place of another kind: what it is, and which command takes it."""

from pathlib import Path

from smarig.core.errors import UsageError
from smarig.core.file_content import CURVES, JSON, MODEL, PAGE, RUN, TABLE, TOML, content_kind

_NOUNS = {
    RUN: "a run",
    MODEL: "a model",
    PAGE: "a page",
    TOML: "a configuration or mapping file",
    TABLE: "a table of numbers",
}
_TAKES = {
    RUN: "`smarig identify RUN…`, `verify MODEL RUN…`, `report` and `export` take runs",
    MODEL: "`smarig verify MODEL RUN…`, `smarig report RUN --model MODEL` and `smarig simulate MODEL` take models",
    PAGE: "open it with a browser",
    TOML: "`--map` takes mapping files, `--rig` rigs",
    TABLE: "`smarig study` reads tables, and `smarig import` makes runs of them",
    CURVES: "`smarig study` reads it, and `smarig import --format forc` makes a run of it",
    "a Rerun recording": "the command rerun shows it",
    "a PDF document": "it holds no numbers that can be read",
    "a picture": "it holds no numbers that can be read",
    "a file compressed by gzip": "unpack it first",
    "a file compressed by 7-Zip": "unpack it first",
    "an old Excel workbook (.xls)": "save it as .xlsx",
    "a LabVIEW TDMS file": "`smarig study` reads it with the extra `tdms`",
}
_UNKNOWN = ("something else", JSON)
_SQLITE = b"SQLite format 3\x00"
_HEADER_BYTES = 100  # of an SQLite file
_DATA = "`smarig study` and `smarig import` read data files"


def swapped_file(path: Path, wanted: str) -> str:
    """A sentence on a file that is of a known kind other than ``wanted``, "" for all others.

    ``wanted`` is a kind (RUN, MODEL, …), or the noun of what was expected.
    """
    try:
        kind = content_kind(path)
    except (UsageError, OSError):
        return ""
    if kind == RUN and (held := _bytes_before_first_page(path)):
        return f"{path} was cut off after {held} byte(s), before anything of a run. Copy it again from its source."
    if kind == RUN and _is_foreign_database(path):
        return f"{path} is an SQLite database, but no run of smarig. Export its table as CSV."
    if not kind:
        return f"{path} is empty."
    if kind in _UNKNOWN and wanted == RUN:
        return f"{path} is not a run file: it is no SQLite database. {_DATA}."
    if kind in (wanted, *_UNKNOWN):
        return ""
    return f"{path} is {_NOUNS.get(kind, kind)}, not {_NOUNS.get(wanted, wanted)}: {_TAKES.get(kind, _DATA)}."


def _bytes_before_first_page(path: Path) -> int:
    """The size of an SQLite file that ends within its first page, which defines its tables; 0 for all others."""
    with path.open("rb") as file:
        head = file.read(_HEADER_BYTES)
    if not head.startswith(_SQLITE[: max(len(head), 1)]):
        return 0
    page_bytes = int.from_bytes(head[16:18], "big")  # SQLite file format, 1.3.2
    size = path.stat().st_size
    return size if size < max(_HEADER_BYTES, 65536 if page_bytes == 1 else page_bytes) else 0


def _is_foreign_database(path: Path) -> bool:
    """Whether an SQLite file defines tables in its first bytes, but none of a run. Damage may have removed all."""
    with path.open("rb") as file:
        head = file.read(1 << 16)
    own = b"CREATE TABLE sample" in head or b"CREATE TABLE run" in head
    return head.startswith(_SQLITE) and b"CREATE TABLE" in head.upper() and not own
