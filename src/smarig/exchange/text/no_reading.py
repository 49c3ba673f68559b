"""What instruments write into a cell where there is no reading: words, filled fields, and numbers of overflow."""

import re
from collections import Counter
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from smarig.core import Array, number_from_text, shown

MISSING = {
    *(
        "",
        "nan",
        "na",
        "n/a",
        "#n/a",
        "#na",
        "#nv",
        "null",
        "none",
        "-",
        "--",
        "---",
        "?",
    ),
    *(
        "overflow",
        "overload",
        "ovld",
        "invalid",
        "error",
        "#div/0!",
        "#value!",
        "#ref!",
        "#num!",
    ),
}
_NOT_A_NUMBER = re.compile(
    r"[+-]?(nan(\([a-z0-9]*\))?|1[.,]#(?!inf)[a-z]{1,4}0*)", re.IGNORECASE
)  # as C libraries write it: -nan(ind), nan(snan), 1.#QNAN, 1,#QNAN, -1.#IND00, and -1.#J with two decimals
# PicoScope: ∞, Graphtec: BURNOUT and +++++++, Keyence: -FFFFFFF, multimeters: OL, OVER and --OL--, C libraries: inf
# and 1.#INF00
_MARK = re.compile(
    r"[+*-]*\s?(burn ?out|over|o\.?l|f{4,}|∞|inf(inity)?|1[.,]#inf0*)\s?[+*-]*|\+{2,}|-{4,}|\*{2,}",
    re.IGNORECASE,
)
_NUMBERS = (9.9e37, 9.91e37, 7.77777e99)  # SCPI: infinity and no number; HIOKI: overflow


def is_mark(cell: str) -> bool:
    """Whether a cell is a word or a filled field that stands for no reading.

    >>> is_mark("BURNOUT"), is_mark("+++++++"), is_mark("--OL--"), is_mark("-∞"), is_mark("+5.0"), is_mark("stroke")
    (True, True, True, True, False, False)
    """
    return _MARK.fullmatch(cell) is not None


def is_missing(cell: str) -> bool:
    """Whether a cell says that there is no value.

    >>> is_missing("n/a"), is_missing("-1.#IND"), is_missing("0")
    (True, True, False)
    """
    return cell.lower() in MISSING or _NOT_A_NUMBER.fullmatch(cell) is not None or is_mark(cell)


def without_marks(x: Array) -> Array:
    """The values (n,) with NaN for the numbers, infinite ones too, that instruments write where there is no reading.

    >>> without_marks(np.array([1.0, 7.77777e99, -9.9e37, np.inf])).tolist()
    [1.0, nan, nan, nan]
    """
    return np.where(np.isin(np.abs(x), _NUMBERS) | np.isinf(x), np.nan, x)


def count_marks(cells: Mapping[str, Sequence[str]], others: Collection[str] = ()) -> dict[str, Counter[str]]:
    """How often each mark, ``others`` too, stands in the cells of the columns that have any."""
    found = {
        name: Counter(cell for cell in column if cell in others or stands_for_none(cell))
        for name, column in cells.items()
    }
    return {name: marks for name, marks in found.items() if marks}


def mark_notes(marks: Mapping[str, Counter[str]], rows: int) -> list[str]:
    """Findings on the cells that hold a mark."""
    return [
        f"Column {shown(name)}: {found.total()} of {rows} cells are masked, because {' or '.join(map(shown, found))} "
        "stands for no reading."
        for name, found in marks.items()
    ]


def stands_for_none(cell: str) -> bool:
    """Whether a cell is a mark, or a number that stands for no reading."""
    if is_mark(cell):
        return True
    if "e" not in cell and "E" not in cell:  # most cells
        return False
    try:
        return bool(np.isnan(without_marks(np.array(number_from_text(cell.replace(",", "."))))))
    except ValueError:
        return False
