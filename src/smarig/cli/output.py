"""What goes to stdout and what to stderr: one JSON object with --json, readable text without.

Results go to stdout, everything else to stderr.
"""

import contextlib
import json
import math
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from smarig.core import UsageError

_STATE = {"json": False}


def json_option(command: Callable) -> Callable:
    """The ``--json`` flag every command has."""

    def remember(ctx: click.Context, param: click.Parameter, value: bool) -> None:
        del ctx, param
        _STATE["json"] = value

    return click.option(
        "--json",
        is_flag=True,
        expose_value=False,
        callback=remember,
        is_eager=True,
        help="One JSON object on stdout.",
    )(command)


def emit(data: dict[str, Any], text: str = "") -> None:
    """Print the result: ``data`` as JSON, or the text for people."""
    if _STATE["json"]:
        _print(as_json(data))
    elif text:
        _print(text)


def as_json(data: dict[str, Any]) -> str:
    """One object in one line."""
    return json.dumps(_plain(data), ensure_ascii=False)


def show_message(text: str) -> None:
    """A remark for people, on stderr; that nobody can hear it ends nothing."""
    with contextlib.suppress(OSError):
        _print(text, err=True)


def json_requested() -> bool:
    """Whether --json was given."""
    return _STATE["json"]


def report_error(sentence: str, status: int) -> int:
    """One sentence on stderr (and as JSON on stdout with --json); returns the status."""
    with contextlib.suppress(OSError):  # nobody can hear us: the status still tells
        _print(f"smarig: {sentence}", err=True)
        if _STATE["json"] or "--json" in sys.argv:
            _print(json.dumps({"error": sentence, "exit_status": status}, ensure_ascii=False))
    return status


def _print(text: str, *, err: bool = False) -> None:
    """A line for whoever reads; a reader that has gone (``| head``) changes nothing of what was done.

    What is left in the stream's buffer goes nowhere then: at the interpreter's end it would fail once more.
    """
    try:
        click.echo(text, err=err)
    except BrokenPipeError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, (sys.stderr if err else sys.stdout).fileno())
        os.close(nowhere)


def check_distinct(out: Path | None, *inputs: Path | None) -> None:
    """UsageError when the output is one of the inputs: --force must not destroy what was measured."""
    for source in inputs:
        if out is not None and source is not None and out.resolve() == source.resolve():
            raise UsageError(f"{out} is both input and output; give the output another name.")


def _plain(value: Any) -> Any:
    """JSON has no NaN and no numpy: null and plain numbers instead."""
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if isinstance(value, (str, int, float, bool, type(None))) else str(value)
