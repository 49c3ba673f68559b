"""Docstrings as reStructuredText: they are plain text with formulas, so nothing in them is taken for markup but what
is meant so: ``names`` in double backticks, examples (``>>>``), and indented lines, which stand as they are.
"""

import inspect
import re
from collections.abc import Iterator, Sequence
from itertools import groupby

from generate.markdown import plain

SPECIAL = re.compile(r"([\\*|_`])")


def as_rst(lines: Sequence[str]) -> list[str]:
    r"""The same text, with what is not markup escaped, and indented lines as blocks.

    >>> as_rst(["y = a*b_ of ``x_``:", "", "    y(t) = ∫ |u| dt", "", "and so on"])
    ['y = a\\*b\\_ of ``x_``:', '', '::', '', '    y(t) = ∫ |u| dt', '', 'and so on']
    """
    made: list[str] = []
    example = False
    for indented, part in groupby(_paragraphs(lines), key=lambda p: p[0].startswith("    ")):
        for paragraph in [_joined(part)] if indented else part:
            example = paragraph[0].startswith(">>>")
            made += [*_block(paragraph), ""] if indented else [*_text(paragraph, example), ""]
    return made[:-1] if made else []


def _paragraphs(lines: Sequence[str]) -> Iterator[list[str]]:
    """Lines without an empty one between them; where the indentation begins anew, a paragraph does too."""
    part: list[str] = []
    for line in lines:
        if not line.strip() or (part and _deep(line) != _deep(part[-1]) and not part[0].startswith(">>>")):
            if part:
                yield part
            part = []
        if line.strip():
            part.append(line.rstrip())
    if part:
        yield part


def _deep(line: str) -> bool:
    return line.startswith("    ")


def _joined(paragraphs: Iterator[list[str]]) -> list[str]:
    joined: list[str] = []
    for paragraph in paragraphs:
        joined += [*([""] if joined else []), *paragraph]
    return joined


def _block(lines: list[str]) -> list[str]:
    return ["::", "", *lines]


def _text(lines: list[str], example: bool) -> list[str]:
    if example:
        return lines
    whole = "\n".join(line.strip() for line in lines)
    parts = re.split(r"(``.+?``)", whole, flags=re.S)
    escaped = (p.replace("\n", " ") if k % 2 else SPECIAL.sub(r"\\\1", p) for k, p in enumerate(parts))
    return "".join(escaped).split("\n")


def as_markdown(text: str) -> str:
    """A docstring as Markdown: paragraphs, and indented lines as they stand."""
    made = []
    for paragraph in re.split(r"\n\s*\n", inspect.cleandoc(text)):
        lines = paragraph.splitlines()
        made.append(paragraph if _deep(lines[0]) else plain(paragraph))
    return "\n\n".join(made)
