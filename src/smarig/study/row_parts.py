"""A part of the rows of a table as a table, whose mapping selects them."""

from dataclasses import replace

from smarig.exchange import FoundTable


def table_of_rows(table: FoundTable, part: slice) -> FoundTable:
    """The rows of a table from ``part.start`` to before ``part.stop``, from 0; the table may be such a part itself."""
    before = table.layout.get("rows", {}).get("first", 1) - 1
    layout = {**table.layout, "rows": {"first": before + part.start + 1, "last": before + part.stop}}
    columns = tuple(replace(c, values=c.values[part]) for c in table.columns)
    breaks = tuple(k - part.start for k in table.breaks if part.start < k < part.stop)
    return replace(table, columns=columns, layout=layout, breaks=breaks)
