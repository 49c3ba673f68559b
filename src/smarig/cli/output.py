"""Output of the commands: results on stdout (text, or one JSON object with --json), everything else on
stderr."""

import contextlib
import io
import json
import math
import os
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import click

from smarig.cli.working_line import without_line
from smarig.core import StorageError, UsageError, printable

LONGEST_RESULT = 1_000_000  # characters of a result as text
# printed: the one object is out; said: the command has printed an error; forced: its end was forced
_STATE = {"json": False, "printed": False, "said": False, "forced": False}
# held while an error is printed: the command and a forced end may print at the same time
_error = threading.Lock()


def json_option(command: Callable) -> Callable:
    """Add the flag ``--json``, which every command has."""

    def remember(ctx: click.Context, param: click.Parameter, value: bool) -> None:
        del ctx, param
        _STATE["json"], _STATE["printed"] = value, False

    return click.option(
        "--json",
        is_flag=True,
        expose_value=False,
        callback=remember,
        is_eager=True,
        help="One JSON object on stdout.",
    )(command)


def emit(data: dict[str, Any], text: str = "") -> None:
    """Print the result: ``data`` as JSON with --json, otherwise ``text``."""
    if _STATE["json"]:
        _print(as_json(data))
        _STATE["printed"] = True
    elif text:
        _print(printable(text, LONGEST_RESULT))


@contextlib.contextmanager
def within_another() -> Iterator[None]:
    """For commands that a command calls: with --json their results are not printed, and the object is still to come."""
    before = dict(_STATE)
    try:
        with contextlib.redirect_stdout(io.StringIO()) if before["json"] else contextlib.nullcontext():
            yield
    finally:
        _STATE.update(before)


def as_json(data: dict[str, Any]) -> str:
    """The object as one line of JSON."""
    return json.dumps(_plain(data), ensure_ascii=False)


def show_message(text: str) -> None:
    """Print a message on stderr. A closed or full stderr is no error."""
    with contextlib.suppress(StorageError):
        _print(printable(text), err=True)


def json_requested() -> bool:
    """Whether --json was given."""
    return _STATE["json"]


def report_error(sentence: str, status: int, *, forced: bool = False) -> int:
    """Print an error on stderr, and as JSON on stdout with --json unless the result is there already; return the exit
    status. A forced end and the command itself do not both say how it ended: the first does.
    """
    with _error:
        if _STATE["forced"] or (forced and _STATE["said"]):
            return status
        _STATE["said"], _STATE["forced"] = True, forced
        sentence = printable(sentence)
        with contextlib.suppress(StorageError):  # stderr is closed: the exit status still shows the error
            _print(f"smarig: {sentence}", err=True)
        with contextlib.suppress(StorageError):
            if (_STATE["json"] or "--json" in sys.argv) and not _STATE["printed"]:
                _print(json.dumps({"error": sentence, "exit_status": status}, ensure_ascii=False))
    return status


def _print(text: str, *, err: bool = False) -> None:
    """Print a line; a closed pipe (``| head``) has no effect on the command. StorageError for a full disk."""
    try:
        with without_line():
            click.echo(text, err=err)
    except BrokenPipeError:
        _discard(err)
    except OSError as error:
        _discard(err)
        name = "Standard error" if err else "Standard output"
        raise StorageError(f"{name} cannot be written: {error.strerror or error}.") from None


def close_output(status: int) -> int:
    """Write what the streams still hold at the end of a command; returns the exit status.

    The help of a command is written by click, so its failure shows here. The interpreter would fail on it at exit.
    """
    for err in (True, False):
        stream = sys.stderr if err else sys.stdout
        try:
            if stream is not None:
                stream.flush()
        except BrokenPipeError:
            _discard(err)
        except OSError:
            _discard(err)
            status = status or StorageError.exit_status
    return status


def _discard(err: bool) -> None:
    """Send what a stream holds, and all that follows, to the null device."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, (sys.stderr if err else sys.stdout).fileno())
    os.close(nowhere)


def check_distinct(out: Path | None, *inputs: Path | None) -> None:
    """Raise UsageError if the output is one of the inputs, because --force would destroy measured data."""
    for source in inputs:
        if out is not None and source is not None and os.path.realpath(out) == os.path.realpath(source):
            raise UsageError(f"{out} is both input and output. Give the output another name.")


def _plain(value: Any) -> Any:
    """The value without NaN and numpy types, which JSON does not have: null and plain numbers instead."""
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if isinstance(value, (str, int, float, bool, type(None))) else str(value)
