"""Searching the library: words, tags, wire, rig, protocol, kind, verdict and time, in one of several orders.

Words are searched by ``instr`` in one column: milliseconds for 5,000 runs, parts of words are matched, and no tokenizer
(FTS5) decides what a word is.
"""

import sqlite3
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from smarig.console.library.entry_rows import entries
from smarig.console.library.library_entry import VERDICTS, Entry
from smarig.core import UsageError, suggestion

_SERIOUS = " ".join(f"WHEN '{word}' THEN {rank}" for rank, word in enumerate(VERDICTS))
_PLACE = "e.place"
ORDERS = {
    "newest": f"e.began IS NULL, e.began DESC, {_PLACE}",
    "oldest": f"e.began IS NULL, e.began, {_PLACE}",
    "name": f"e.name COLLATE NOCASE, {_PLACE}",
    "wire": f"e.wire = '', e.wire COLLATE NOCASE, e.began DESC, {_PLACE}",
    "protocol": f"e.protocol = '', e.protocol COLLATE NOCASE, e.began DESC, {_PLACE}",
    "duration": f"e.duration_s IS NULL, e.duration_s DESC, {_PLACE}",
    "verdict": f"CASE e.verdict {_SERIOUS} END, e.began DESC, {_PLACE}",
}
FACETS = ("kind", "wire", "rig", "protocol", "verdict", "tag")
MOST_ENTRIES = 1000  # of one page
_MOST_WORDS, _LONGEST_WORD = 20, 200
_HAS_WORD = (
    "(instr(e.words, ?) OR e.identity IN (SELECT identity FROM tag WHERE instr(folded, ?) "
    "UNION SELECT identity FROM note WHERE instr(words, ?)))"
)
_HAS_TAG = "e.identity IN (SELECT identity FROM tag WHERE folded = ?)"


@dataclass(frozen=True)
class SearchPage:
    """Entries in order, from number ``offset`` of ``total``."""

    entries: tuple[Entry, ...]
    total: int
    offset: int


@dataclass(frozen=True)
class Question:
    """What is searched for; None stands for anything. ``since`` and ``until`` in seconds since 1970."""

    text: str = ""
    tags: Sequence[str] = ()
    wire: str | None = None
    rig: str | None = None
    protocol: str | None = None
    kind: str | None = None
    verdict: str | None = None
    since: float | None = None
    until: float | None = None

    def condition(self) -> tuple[str, list[object]]:
        """The SQL condition on an entry ``e``, and its values."""
        parts, values = ["1"], []
        for word in self.text[: _MOST_WORDS * _LONGEST_WORD].casefold().split()[:_MOST_WORDS]:
            parts.append(_HAS_WORD)
            values += [_clean(word)] * 3
        for tag in self.tags:
            parts.append(_HAS_TAG)
            values.append(_clean(" ".join(tag.casefold().split())))
        for name in ("wire", "rig", "protocol", "kind", "verdict"):
            if (wanted := getattr(self, name)) is not None:
                parts.append(f"e.{name} = ?")
                values.append(_clean(wanted))
        if self.since is not None:
            parts.append("e.began >= ?")
            values.append(self.since)
        if self.until is not None:
            parts.append("e.began <= ?")
            values.append(self.until)
        return " AND ".join(parts), values


def search(
    db: sqlite3.Connection, folder: Path, question: Question, order: str, limit: int, offset: int
) -> SearchPage:
    """The entries that answer a question. Raises UsageError for an unknown order or a page that is none."""
    if order not in ORDERS:
        raise UsageError(f"The library has no order '{order}'{suggestion(order, list(ORDERS))}.")
    if not 0 <= limit <= MOST_ENTRIES or offset < 0:
        raise UsageError(f"A page has 0 to {MOST_ENTRIES} entries and begins at 0 or later.")
    condition, values = question.condition()
    total = db.execute(f"SELECT count(*) FROM entry e WHERE {condition}", values).fetchone()[0]
    # places first: only the rows of the page are read whole
    chosen = f"SELECT e.place FROM entry e WHERE {condition} ORDER BY {ORDERS[order]} LIMIT ? OFFSET ?"
    places = [place for (place,) in db.execute(chosen, (*values, limit, min(offset, 2**62)))]
    found = [entry for place in places for entry in entries(db, folder, "WHERE e.place = ?", (place,))]
    return SearchPage(tuple(found), total, offset)


def facets(db: sqlite3.Connection) -> dict[str, dict[str, int]]:
    """How many entries each value has, the most frequent first. Entries without a value are not counted."""
    found = {name: _counts(db, f"SELECT {name}, count(*) FROM entry GROUP BY {name}") for name in FACETS[:-1]}
    tags = "SELECT min(t.tag), count(*) FROM tag t JOIN entry e ON e.identity = t.identity GROUP BY t.folded"
    return found | {"tag": _counts(db, tags)}


def _counts(db: sqlite3.Connection, query: str) -> dict[str, int]:
    rows = sorted(db.execute(query), key=lambda row: (-row[1], row[0]))
    return {value: count for value, count in rows if value}


def _clean(text: str) -> str:
    """The text as SQLite can store it: no halves of characters."""
    return text.encode("utf-8", "replace").decode()
