"""Numbers with a sign between thousands that first appear far below the beginning of a table, as in a clock."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from smarig.exchange.tables.number_style import NumberStyle
from smarig.exchange.text.cell_values import has_thousands, is_number
from smarig.exchange.text.table_rows import split

_SIGNS = (",", ".", "'", "space")


def with_late_thousands(lines: Sequence[str], delimiter: str | None, style: NumberStyle) -> NumberStyle:
    """The style of numbers, with the sign between thousands of a row that goes on below a row of plain numbers."""
    if style.thousands:
        return style
    text = "|".join(lines)  # one search of it is a hundred times as fast as one of each line
    quoted = '"' in text  # else a sign that also divides columns divides no thousands
    for sign in _SIGNS:
        if (sign == delimiter and not quoted) or not has_thousands([text], sign):
            continue
        able = replace(style, thousands=sign)
        if sign != style.decimal and any(
            _goes_on(above, row, style, able) for above, row in _pairs(lines, delimiter, sign)
        ):
            return able
    return style


def _pairs(lines: Sequence[str], delimiter: str | None, sign: str) -> Iterator[tuple[list[str], list[str]]]:
    """The cells of lines that may hold such a number, and of those above them."""
    if delimiter is None and sign == "space":
        return
    for above, line in zip(lines, lines[1:]):
        if sign == delimiter:
            able = '"' in line and has_thousands([line], sign)
        else:
            able = has_thousands([line.replace(delimiter, "|") if delimiter else line], sign)
        if able:
            yield split(above, delimiter), split(line, delimiter)


def _goes_on(above: Sequence[str], row: Sequence[str], plain: NumberStyle, able: NumberStyle) -> bool:
    """Whether a row has a number with thousands where that above it has a plain one, both with decimals or without.

    The row above shows the decimal sign: without one, "1,500" may be one and a half.
    """
    numbers = [is_number(cell, plain.decimal) for cell in above]
    if len(row) != len(above) or not any(plain.decimal in c for c, is_one in zip(above, numbers) if is_one):
        return False
    return any(
        is_one
        and not is_number(cell, plain.decimal)
        and is_number(cell, able.decimal, able.thousands)
        and (plain.decimal in cell) == (plain.decimal in before)
        for before, cell, is_one in zip(above, row, numbers)
    )
