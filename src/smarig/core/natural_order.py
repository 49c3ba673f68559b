"""The order of file names in which numbers count as numbers: 7, 50, 100, 200."""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

_NUMBERS = re.compile(r"(\d+(?:\.\d+)?)")


def natural_order(files: Iterable[Path]) -> list[Path]:
    """The files sorted folder by folder and name by name, with digits compared as numbers.

    >>> [str(p) for p in natural_order([Path("100.csv"), Path("50.csv"), Path("a/7.csv")])]
    ['50.csv', '100.csv', 'a/7.csv']
    >>> [str(p) for p in natural_order([Path("0.5 Hz.csv"), Path("0.25 Hz.csv")])]
    ['0.25 Hz.csv', '0.5 Hz.csv']
    """
    return sorted(files, key=_key)


def pattern_order(files: Sequence[Path]) -> list[Path]:
    """The files as given, but in natural order if they come as a shell's pattern (``*.csv``) lists them.

    A shell sorts digits as letters (100, 200, 50). Any other order is the user's own and is kept.

    >>> [str(p) for p in pattern_order([Path("100.csv"), Path("200.csv"), Path("50.csv")])]
    ['50.csv', '100.csv', '200.csv']
    >>> [str(p) for p in pattern_order([Path("b.csv"), Path("a.csv")])]
    ['b.csv', 'a.csv']
    """
    given = list(files)
    return natural_order(given) if [str(f) for f in given] == sorted(map(str, given)) else given


def _key(file: Path) -> tuple[tuple[tuple[int, float, str], ...], ...]:
    """For each part of the path, its pieces: numbers before words; the text itself decides between 7 and 07."""
    return tuple(
        tuple(
            (0, float(piece), piece) if piece[0].isdecimal() else (1, 0.0, piece)
            for piece in _NUMBERS.split(part)
            if piece
        )
        for part in file.parts
    )
