"""The question before current flows; where nobody can answer it, nothing is done."""

import sys

import click

from smarig.core import UsageError


def confirm(words: str, advice: str) -> None:
    """Ask a question. Raises UsageError with ``advice`` if the answer is no, or if there is none to be had."""
    try:
        agreed = click.confirm(words, default=False, err=True)
    except click.Abort:
        if sys.stdin is not None and sys.stdin.isatty():
            raise  # Ctrl-C
        agreed = False
    if not agreed:
        raise UsageError(f"Nothing was done. {advice}")
