"""What stands above the first row of numbers of a text whose columns are not the expected ones."""

from collections.abc import Sequence

from smarig.exchange.text.cell_values import is_number
from smarig.exchange.text.table_rows import split


def first_names(lines: Sequence[str], choices: Sequence[str | None]) -> str:
    """What stands above the first row of numbers: "no header row", or names that are not the expected ones."""
    before = ""
    for line in lines:
        rows = [(d, split(line, d)) for d in choices]
        found = [
            (d, row)
            for d, row in rows
            if len(row) > 1 and all(is_number(x, ".") or is_number(x, ",") for x in row)
        ]
        if found:
            names = split(before, max(found, key=lambda pair: len(pair[1]))[0])
            named = len(names) > 1 and not any(is_number(x, ".") for x in names)
            return f"other columns ({', '.join(names)[:120]})" if named else "no header row"
        before = line
    return "no header row"
