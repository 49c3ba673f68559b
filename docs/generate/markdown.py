"""Markdown from plain values: tables, code, text that must not be taken for markup. Knows no subject."""

import re
from collections.abc import Iterable, Sequence

SPACES = re.compile(r"[ \n\t]+")  # not those that hold together
SPECIAL = re.compile(r"([\\*_<>\[\]$#{}`])")


def plain(text: str) -> str:
    """Text as it stands; ``double`` and `single` backticks mean code.

    >>> plain("a_b ``c_d`` *e*")
    'a\\\\_b `c_d` \\\\*e\\\\*'
    """
    parts = re.split(r"(``.+?``|`[^`]+`)", SPACES.sub(" ", text.strip()))
    return "".join(f"`{p.strip('`')}`" if k % 2 else SPECIAL.sub(r"\\\1", p) for k, p in enumerate(parts))


def code(text: object) -> str:
    """Text in code's type; nothing for nothing."""
    return f"`{text}`" if str(text) else ""


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; cells are Markdown, empty columns are left out."""
    cells = [[_cell(c) for c in row] for row in rows]
    kept = [k for k in range(len(head)) if any(row[k] for row in cells)]
    lines = [[head[k] for k in kept], ["---"] * len(kept), *([row[k] for k in kept] for row in cells)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def fence(language: str, text: str) -> str:
    """A block of code."""
    return f"```{language}\n{text.rstrip()}\n```\n"


def _cell(text: str) -> str:
    return SPACES.sub(" ", text.strip()).replace("|", "\\|")
