"""Parses blocks of lines that hold only numbers, all at once. Whatever else a block holds is left to ``text_table``."""

import io

import numpy as np

from smarig.core import Array

_NUMERIC = b"0123456789+-.eEnaNA \t\r\n"  # of numbers, "nan" and blanks: no infinity, no 1_000


def numbers_of(block: bytes, columns: int, delimiter: str | None, decimal: str = ".") -> Array | None:
    """The numbers (n, columns) of a block of whole lines, NaN for empty cells; None unless each line has that many.

    ``delimiter``: None for blanks.

    >>> numbers_of(b"1,2.5\\n,nan\\n", 2, ",").tolist()
    [[1.0, 2.5], [nan, nan]]
    >>> numbers_of(b"1,2.5\\n3\\n", 2, ","), numbers_of(b"1_0,2\\n", 2, ","), numbers_of(b"1,off\\n", 2, ",")
    (None, None, None)
    """
    separator = (delimiter or " ").encode()
    if delimiter == decimal or block.translate(None, _NUMERIC + separator + decimal.encode()):
        return None
    text = block.replace(b"\r\n", b"\n")
    if b"\r" in text or not text.strip():
        return None
    text = text.replace(decimal.encode(), b".")
    if delimiter is not None:
        text = _filled(text, separator)
    try:
        found = np.loadtxt(io.StringIO(text.decode("ascii")), delimiter=delimiter, comments=None, ndmin=2)
    except ValueError:
        return None
    return found if found.shape == (text.count(b"\n"), columns) else None  # blank lines are skipped


def _filled(text: bytes, separator: bytes) -> bytes:
    """The text with "nan" in empty cells."""
    for before in (separator, b"\n"):
        for after in (separator, b"\n"):
            while before + after in text and before + after != b"\n\n":
                text = text.replace(before + after, before + b"nan" + after)
    return b"nan" + text if text.startswith(separator) else text
