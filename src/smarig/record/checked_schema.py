"""Checks that a database holds a run: real tables with the columns of the schema, and nothing that executes by itself.

Everything else that SQLite offers (views, triggers, virtual tables, generated columns, expressions in indices) lets a
file decide what a query does, or change rows while a run is continued.
"""

import contextlib
import sqlite3
from functools import cache

from smarig.record import schema

_QUERY = "SELECT type, name, tbl_name, rootpage, sql FROM sqlite_master"


@cache
def _expected() -> dict[str, tuple[str, list[str]]]:
    """Statement and column names of each table, as SQLite stores them."""
    with contextlib.closing(sqlite3.connect(":memory:")) as db:
        db.executescript(schema.CREATE)
        return {
            name: (_normal(sql), _columns(db, name))
            for kind, name, _, _, sql in db.execute(_QUERY).fetchall()
            if kind == "table"
        }


def check_schema(db: sqlite3.Connection) -> None:
    """Raise ValueError if a file is not to be read: the part of the schema that no run has."""
    for kind, name, table, rootpage, sql in db.execute(_QUERY).fetchall():
        if kind in ("view", "trigger"):
            raise ValueError(f"it has the {kind} '{name!s:.40}', which no run has")
        if kind == "table" and (not rootpage or not str(sql).upper().startswith("CREATE TABLE ")):
            raise ValueError(f"its table '{name!s:.40}' is virtual; a run has real tables only")
        if kind == "index" and sql is not None and table in _expected():
            raise ValueError(f"its table '{table}' has the index '{name!s:.40}', which no run has")
    for name, (_, columns) in _expected().items():
        found = _columns(db, name)
        if found and found != columns:
            raise ValueError(f"its table '{name}' has other columns than that of a run")


def check_writable_schema(db: sqlite3.Connection) -> None:
    """Raise ValueError unless the tables are exactly those that a recorder creates: writing executes their checks."""
    check_schema(db)
    found = {name: _normal(sql) for kind, name, _, _, sql in db.execute(_QUERY).fetchall() if kind == "table"}
    for name, (sql, _) in _expected().items():
        if found.get(name) != sql:
            raise ValueError(f"its table '{name}' is not as a recorder creates it")


def _columns(db: sqlite3.Connection, table: str) -> list[str]:
    """Names of the columns, with a mark at those that are computed; empty if there is no such table."""
    rows = db.execute("SELECT name, hidden FROM pragma_table_xinfo(?)", (table,)).fetchall()
    return [name if not hidden else f"{name} (computed)" for name, hidden in rows]


def _normal(sql: str) -> str:
    return " ".join(sql.split())
