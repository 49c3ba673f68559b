"""Reads the rig of a recorded text: the files that ``rig_text`` joined, for records that hold no values beside it."""

from collections.abc import Iterator
from typing import Any

from smarig.config.config_files import merged_tables
from smarig.config.file_schemas import RigFile
from smarig.core import NotToml, Origin, Source, parsed_toml

_SOURCE = Source("A record", Origin.INSIDE)  # of what it names, which is compared and never opened
MAX_LENGTH = 200_000  # of a text; rig files have 1000 to 3000 characters
_MAX_FILES = 8  # a rig, its base, and so on
_MAX_ATTEMPTS = 20_000  # a text made to have many divisions must not cost hours


def rig_from_text(text: str) -> RigFile | None:
    """The rig of a file followed by its base, and so on; None if the text is none.

    Nothing marks where one file ends, so every line is tried. The first parts name a base, the last part does not, and
    together they form a complete rig.
    """
    if len(text) > MAX_LENGTH:
        return None
    return next(_rigs(text.split("\n"), {}, _MAX_FILES, iter(range(_MAX_ATTEMPTS))), None)


def _rigs(
    lines: list[str], mine: dict[str, Any], files_left: int, attempts: Iterator[int]
) -> Iterator[RigFile]:
    """The rigs that these lines can form under the values ``mine``."""
    whole = _table(lines, attempts)
    if whole is not None and not whole.get("base"):
        try:
            yield RigFile.model_validate(merged_tables(whole, mine), context=_SOURCE)
        except ValueError:
            return
    for k in range(1, len(lines) if files_left > 1 else 0):
        part = _table(lines[:k], attempts)
        if part is not None and part.get("base"):
            yield from _rigs(lines[k:], merged_tables(part, mine), files_left - 1, attempts)


def _table(lines: list[str], attempts: Iterator[int]) -> dict[str, Any] | None:
    if next(attempts, None) is None:
        return None
    try:
        return parsed_toml("\n".join(lines))
    except NotToml:
        return None
