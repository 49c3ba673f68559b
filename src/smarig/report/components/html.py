"""Builds HTML from data. Plain ``str`` (names, notes, file names) is always escaped and never becomes markup."""

import html
import re
from collections.abc import Iterable, Sequence
from itertools import zip_longest
from typing import Any

from smarig.core import Severity

_VOID = {"br", "meta", "hr", "input"}


class Html(str):
    """Markup that is safe to insert into a page."""

    __slots__ = ()


def escaped(value: Any) -> Html:
    """A value as safe markup: Html unchanged, everything else through ``html.escape``.

    >>> escaped("<script>")
    '&lt;script&gt;'
    """
    return value if isinstance(value, Html) else Html(html.escape(str(value)))


def tag(element: str, /, *children: Any, **attributes: Any) -> Html:
    """``<element …>children</element>``; in attribute names a trailing underscore is dropped, inner ones become '-'.

    >>> tag("p", "T < 0", class_="note")
    '<p class="note">T &lt; 0</p>'
    """
    attribute_text = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{html.escape(str(value))}"'
        for key, value in attributes.items()
        if value not in (None, "")
    )
    if element in _VOID:
        return Html(f"<{element}{attribute_text}>")
    return Html(f"<{element}{attribute_text}>{joined(children)}</{element}>")


def joined(parts: Iterable[Any], between: str = "") -> Html:
    """The parts joined, each escaped unless it is HTML."""
    return Html(between.join(escaped(part) for part in parts))


def paragraph(*parts: Any) -> Html:
    """A paragraph of text."""
    return tag("p", *parts)


def bullets(items: Iterable[Any]) -> Html:
    """A bulleted list; empty if there are no items."""
    rows = [tag("li", item) for item in items]
    return tag("ul", *rows) if rows else Html("")


def table(
    header: Sequence[Any], rows: Iterable[Sequence[Any]], caption: Any = "", *, stacked: bool = False
) -> Html:
    """A table with a caption; the first column is the row header. Wide tables scroll in their frame, also by keyboard.

    ``stacked``: on a small screen each row becomes a list of column names and values.
    """
    head = tag("thead", tag("tr", *(tag("th", cell, scope="col") for cell in header)))
    names = [plain(cell) for cell in header] if stacked else []
    body = tag("tbody", *(_row(row, names) for row in rows))
    title = tag("caption", caption) if caption else ""
    kind = "table stacked" if stacked else "table"
    return tag("div", tag("table", title, head, body), class_=kind, tabindex=0)


def _row(cells: Sequence[Any], names: Sequence[str]) -> Html:
    data_cells = (
        tag("td", cell, data_column=name) for cell, name in zip_longest(cells[1:], names[1:], fillvalue="")
    )
    return tag("tr", tag("th", cells[0], scope="row"), *data_cells)


def plain(cell: Any) -> str:
    """The text of a cell, with an underscore before each subscript.

    >>> plain(Html("k<sub>e</sub> &lt; 2"))
    'k_e < 2'
    """
    return html.unescape(re.sub(r"<[^>]*>", "", escaped(cell).replace("<sub>", "_")))


def cards(items: Iterable[tuple[Any, Any, Any]]) -> Html:
    """Cards of key figures, given as (label, value, note)."""
    return tag(
        "div",
        *(
            tag("div", tag("small", label), tag("strong", value), tag("span", note), class_="card")
            for label, value, note in items
        ),
        class_="cards",
    )


def notice(kind: str, *parts: Any) -> Html:
    """A highlighted box; kind is 'good', 'warning' or 'bad'."""
    return tag("div", *parts, class_=f"notice {kind}")


def with_subscripts(text: str) -> Html:
    """A text whose symbols have subscripts set as such.

    >>> with_subscripts("A_s, k_e < 2, Δy_a")
    'A<sub>s</sub>, k<sub>e</sub> &lt; 2, Δy<sub>a</sub>'
    """
    parts = re.split(r"(?:(?<=\b[A-Za-z])|(?<=\bΔ[A-Za-z]))(_[A-Za-z]{1,2})\b", text)
    return joined(tag("sub", part[1:]) if part.startswith("_") else part for part in parts)


def severity_mark(severity: Severity) -> Html:
    """The word; its colour comes from the style sheet."""
    return tag("span", str(severity), class_=f"severity {severity}")
