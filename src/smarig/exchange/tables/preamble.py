"""The first and the last lines of a text file, in which an instrument states how it measured."""

from pathlib import Path

from smarig.core import DataError, UsageError
from smarig.exchange.tables.text_table import HEADER_WITHIN, read_text

_FOOTER = 50  # lines


def preamble_lines(path: Path) -> tuple[str, ...]:
    """The first lines of a text file, and the last ones, as far as they may be a footer; () for other files."""
    try:
        text, _ = read_text(path)
    except (DataError, UsageError):
        return ()
    lines = text.splitlines()
    return (*lines[:HEADER_WITHIN], *lines[HEADER_WITHIN:][-_FOOTER:])
