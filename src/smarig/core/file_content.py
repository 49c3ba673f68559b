"""The kind of a file's content, found from its first bytes or, failing that, from its name.

``--force`` uses it to replace a file only by one of the same kind.
"""

import re
from pathlib import Path

from smarig.core.regular_file import opened_file

RUN, MODEL, PAGE = "a run", "a model", "a page"
JSON, TOML, TABLE = "JSON", "TOML", "a table of numbers"
CURVES = "a file of reversal curves"

_HEAD = 4096  # bytes
_MAGIC = (
    (b"SQLite format 3\x00", RUN),
    (b"PAR1", "a Parquet file"),
    (b"\x89HDF", "a NetCDF file"),
    (b"MATLAB 5", "a MATLAB file"),
    (b"RRF", "a Rerun recording"),
    (b"%PDF", "a PDF document"),
    (b"\x89PNG", "a picture"),
    (b"\xff\xd8\xff", "a picture"),
    (b"\x1f\x8b", "a file compressed by gzip"),
    (b"7z\xbc\xaf", "a file compressed by 7-Zip"),
    (b"\xd0\xcf\x11\xe0", "an old Excel workbook (.xls)"),
    (b"PK\x03\x04", "a workbook or ZIP archive"),
    (b"TDSm", "a LabVIEW TDMS file"),
)
_FORC_WORDS = re.compile(  # in the first 400 bytes
    rb"first[- ]order reversal|direct moment vs\. field; first|\bforcs?\b", re.IGNORECASE
)
_NAMES = {
    ".run.sqlite": RUN,
    ".model.json": MODEL,
    ".html": PAGE,
    ".json": JSON,
    ".toml": TOML,
    ".csv": TABLE,
    ".parquet": "a Parquet file",
    ".nc": "a NetCDF file",
    ".mat": "a MATLAB file",
    ".rrd": "a Rerun recording",
}
_TOML_LINE = re.compile(r"""\[{1,2}["'\w. -]+\]{1,2}\s*(#.*)?|["'\w.-]+\s*=.*""")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|nan|[-+]?inf", re.IGNORECASE)


def content_kind(path: Path, final_name: str = "") -> str:
    """The kind of a file's content: "" for an empty file, "something else" if nothing identifies it.

    ``final_name`` is the name that the file will have, if it differs from the present one.
    """
    with opened_file(path) as file:
        head = file.read(_HEAD)
    if not head.strip():
        return ""
    binary = next((kind for magic, kind in _MAGIC if head.startswith(magic)), "")
    if not binary and _FORC_WORDS.search(head[:400]):
        return CURVES
    return binary or _text(head.decode("utf-8", errors="replace")) or _kind_by_name(final_name or path.name)


def _text(head: str) -> str:
    words = head.lstrip("\ufeff \t\r\n")
    if words[:9].lower() == "<!doctype" or words[:5].lower() == "<html":
        return PAGE
    if words.startswith("{"):
        return MODEL if re.search(r'"format"\s*:\s*"smarig model"', words) else JSON
    lines = [line.strip() for line in words.splitlines()]
    content_lines = [line for line in lines if line and not line.startswith("#")]
    if content_lines and _TOML_LINE.fullmatch(content_lines[0]):
        return TOML
    return TABLE if any(_is_number_row(line) for line in content_lines[1:3]) else ""


def _is_number_row(line: str) -> bool:
    """Whether a line is a row of a table: only numbers, some of which may be missing."""
    cells = [cell for cell in re.split(r"[,;\s]+", line) if cell]
    return bool(cells) and all(_NUMBER.fullmatch(cell) for cell in cells)


def _kind_by_name(name: str) -> str:
    return next((kind for end, kind in _NAMES.items() if name.lower().endswith(end)), "something else")
