"""Names that a program numbers where a table has none, as V1, V2 or Var1, Var2: they say nothing of any column."""

import re
from collections.abc import Sequence

_NUMBERED = (
    re.compile(  # words with which programs number columns; a channel of an instrument has a number too
        r"(v|x|y|c|f|var|col|column|unnamed:|field|feld|spalte|colonne|columna|arr)[ _.]?(\d+)", re.IGNORECASE
    )
)
_ROW_NAMES = re.compile(r"|column 1|unnamed: 0|row\.?names|index", re.IGNORECASE)


def default_names(names: Sequence[str]) -> tuple[str, ...]:
    """The names of a table that differ only in a number which counts all its columns from 0 or 1, but for one of the
    rows; () if there are others. The word before the number cannot name both an input and an output.

    >>> default_names(["column 1", "V1", "V2"]), default_names(["time", "V1", "V2"]), default_names(["X0", "X1"])
    (('V1', 'V2'), (), ('X0', 'X1'))
    >>> default_names(["column 1", "column 2"])  # as the reader calls columns of a table without a head
    ()
    """
    rest = tuple(names[1:] if names and _ROW_NAMES.fullmatch(names[0].strip()) else names)
    for able in (tuple(names), rest):
        parts = [_NUMBERED.fullmatch(name.strip()) for name in able]
        known = [part for part in parts if part is not None]
        numbers = [int(part[2]) for part in known]
        of_one = len({part[1].casefold() for part in known}) == 1 and len(known) == len(able) > 1
        if able[:1] == ("column 1",):
            continue
        if of_one and numbers == list(range(numbers[0], numbers[0] + len(numbers))) and numbers[0] in (0, 1):
            return able
    return ()
