"""A file given in the place of another kind: what it is, and which command takes it."""

from pathlib import Path

from smarig.core.file_content import MODEL, PAGE, RUN, TABLE, TOML, content_kind

_NOUNS = {
    RUN: "a run",
    MODEL: "a model",
    PAGE: "a page",
    TOML: "a configuration or mapping file",
    TABLE: "a table of numbers",
}
_TAKES = {
    RUN: "`smarig identify RUN…`, `verify MODEL RUN…`, `report` and `export` take runs",
    MODEL: "`smarig verify MODEL RUN…`, `simulate` and `report` take models",
    PAGE: "open it with a browser",
    TOML: "`--map` takes mapping files, `--rig` rigs",
    TABLE: "`smarig study` reads tables, and `smarig import` makes runs of them",
}
_SQLITE = b"SQLite format 3\x00"
_DATA = "`smarig study` and `smarig import` read data files"


def swapped_file(path: Path, wanted: str) -> str:
    """A sentence on a file that is of a known kind other than ``wanted`` (RUN, MODEL, …), "" for all others."""
    try:
        kind = content_kind(path)
    except OSError:
        return ""
    if kind == RUN and not has_run_tables(path):
        return f"{path} is an SQLite database, but no run of smarig. Export its table as CSV."
    if kind in ("", wanted, "something else", "JSON"):
        return ""
    return f"{path} is {_NOUNS.get(kind, kind)}, not {_NOUNS[wanted]}: {_TAKES.get(kind, _DATA)}."


def has_run_tables(path: Path) -> bool:
    """Whether a file may hold a run: it is no SQLite file, or its first bytes define the tables of one."""
    with path.open("rb") as file:
        head = file.read(1 << 16)
    return not head.startswith(_SQLITE) or b"CREATE TABLE sample" in head or b"CREATE TABLE run" in head
