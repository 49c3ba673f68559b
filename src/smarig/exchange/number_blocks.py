"""Parses blocks of lines that hold only numbers, all at once. Whatever else a block holds is left to ``text_table``."""

import numpy as np
from numpy.typing import NDArray

_NUMERIC = b"0123456789+-.eEnaNA \t\r\n"  # of numbers, "nan" and blanks: no infinity, no 1_000
_BLANKS = b" \t\n"


def numbers_of(
    block: bytes, columns: int, delimiter: str | None, decimal: str = "."
) -> NDArray[np.float64] | None:
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
    if b"\r" in text or not text.endswith(b"\n"):
        return None
    n = text.count(b"\n")
    if not (_regular_blanks(text, columns) if delimiter is None else _regular(text, columns, separator)):
        return None
    if decimal != ".":
        if b"." in text:
            return None
        text = text.replace(decimal.encode(), b".")
    cells = text.split() if delimiter is None else _cells(text, separator)
    try:
        return np.fromiter(map(float, cells), dtype=float, count=n * columns).reshape(n, columns)
    except ValueError:
        return None


def _cells(text: bytes, separator: bytes) -> list[bytes]:
    row = text.replace(b"\n", separator)
    while separator * 2 in row:
        row = row.replace(separator * 2, separator + b"nan" + separator)
    return (b"nan" + row if row.startswith(separator) else row)[:-1].split(separator)


def _regular(text: bytes, columns: int, separator: bytes) -> bool:
    """Whether each line has one separator less than columns."""
    codes = np.frombuffer(text, dtype=np.uint8)
    ends, between = np.flatnonzero(codes == ord("\n")), np.flatnonzero(codes == ord(separator))
    if between.size != ends.size * (columns - 1):
        return False
    if columns == 1:
        return True
    rows = between.reshape(ends.size, columns - 1)
    return bool((rows[:, -1] < ends).all() and (rows[1:, 0] > ends[:-1]).all())


def _regular_blanks(text: bytes, columns: int) -> bool:
    """Whether each line has as many words as columns."""
    codes = np.frombuffer(text, dtype=np.uint8)
    blank = np.isin(codes, np.frombuffer(_BLANKS, dtype=np.uint8))
    begins = ~blank & np.concatenate([[True], blank[:-1]])
    words = np.cumsum(begins)[codes == ord("\n")]
    return bool((np.diff(words, prepend=0) == columns).all())
