"""The first lines of a text file, in which an instrument states how it measured."""

from pathlib import Path

from smarig.core import DataError, UsageError
from smarig.exchange.text_table import HEADER_WITHIN, read_text


def preamble_lines(path: Path) -> tuple[str, ...]:
    """The first lines of a text file; () for a file of another kind."""
    try:
        text, _ = read_text(path)
    except (DataError, UsageError):
        return ()
    return tuple(text.splitlines()[:HEADER_WITHIN])
