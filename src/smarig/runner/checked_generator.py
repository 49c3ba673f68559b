"""Gets the next command from a protocol and rejects invalid commands.

A protocol may be a user's own file. It may yield a numpy integer as a number (accepted) or an invalid object (refused
with file and line), raise exceptions that end programs, or never return. In each case the samples so far are kept and
the current ends at zero.
"""

import contextlib
import json
import time
from dataclasses import replace
from numbers import Real
from typing import Any

from smarig.core import (
    Command,
    Drive,
    Elapsed,
    Hold,
    Mark,
    Protocol,
    Settled,
    SmarigError,
    UsageError,
    Waveform,
    Zero,
)
from smarig.runner.run_control import RunControl


class CheckedGenerator:
    """A protocol that can be stopped; ``next(answer)`` is its next command, None at its end."""

    def __init__(self, protocol: Protocol, control: RunControl) -> None:
        self._protocol, self._control = protocol, control

    def next(self, answer: Any) -> Command | None:
        """The next command. Raises UsageError for an invalid command or a forbidden exception of the protocol."""
        self._control.waiting_since_s = time.monotonic()
        try:
            command = self._protocol.send(answer)
        except StopIteration:
            return None
        except (SmarigError, KeyboardInterrupt):
            raise
        except BaseException as error:
            if isinstance(error, Exception) and not isinstance(error.__cause__, StopIteration):
                raise
            raised = error.__cause__ if isinstance(error, RuntimeError) else error
            raise UsageError(
                f"The protocol raised {type(raised).__name__}. A protocol must end by returning."
            ) from error
        finally:
            self._control.waiting_since_s = None
        try:
            return checked(command)
        except UsageError as error:
            raise UsageError(f"{self._location()}: {str(error).rstrip('.')}.") from None

    def close(self) -> None:
        """Close the protocol and suppress its exceptions."""
        with contextlib.suppress(Exception):
            self._protocol.close()

    def _location(self) -> str:
        """File and line of the innermost generator at its present yield."""
        inner: Any = self._protocol
        while getattr(inner, "gi_yieldfrom", None) is not None and hasattr(inner.gi_yieldfrom, "gi_frame"):
            inner = inner.gi_yieldfrom
        frame = getattr(inner, "gi_frame", None)
        return f"{frame.f_code.co_filename}, line {frame.f_lineno}" if frame else "The protocol"


def checked(command: object) -> Command:
    """The command with plain numbers. Raises UsageError, with the name of the field, for invalid values.

    >>> import numpy as np
    >>> checked(Hold(np.float32(0.5), Elapsed(1.0), target=np.int64(40)))
    Hold(current_A=0.5, until=Elapsed(seconds=1.0), target=40.0, branch='')
    """
    match command:
        case Drive(current_A):
            return command if type(current_A) is float else Drive(_number("current_A of a Drive", current_A))
        case Hold():
            if not isinstance(command.until, Elapsed | Settled):
                raise UsageError(
                    f"until of a Hold must be Elapsed or Settled, got {_short_repr(command.until)}"
                )
            target = None if command.target is None else _number("target of a Hold", command.target)
            current_A = _number("current_A of a Hold", command.current_A)
            return replace(
                command, current_A=current_A, target=target, branch=_text("branch", command.branch)
            )
        case Waveform():
            currents = _numbers("currents_A of a Waveform", command.currents_A)
            period_s = _number("period_s of a Waveform", command.period_s)
            if not (period_s > 0 and currents):
                raise UsageError("a Waveform needs at least one current and a period_s above 0")
            return Waveform(currents, period_s, _text("branch", command.branch))
        case Mark(label, data):
            _text("label of a Mark", label)
            try:
                json.dumps(data, ensure_ascii=False).encode("utf-8")
            except (TypeError, ValueError, RecursionError) as error:
                raise UsageError(f"data of a Mark cannot be stored as JSON: {error}") from None
            return command
        case Zero():
            return command
    raise UsageError(f"a protocol must yield Hold, Waveform, Drive, Zero or Mark, got {_short_repr(command)}")


def _number(what: str, value: object) -> float:
    if isinstance(value, Real) and not isinstance(value, bool):
        try:
            return float(value)
        except (OverflowError, ValueError):
            pass
    raise UsageError(f"{what} must be a number, got {_short_repr(value)}")


def _numbers(what: str, values: Any) -> tuple[float, ...]:
    try:
        return tuple(_number(what, value) for value in values)
    except TypeError:
        raise UsageError(f"{what} must be a sequence of numbers, got {_short_repr(values)}") from None


def _text(what: str, value: object) -> str:
    if isinstance(value, str):
        with contextlib.suppress(UnicodeEncodeError):
            value.encode("utf-8")
            return str(value)
    raise UsageError(f"{what} must be a string, got {_short_repr(value)}")


def _short_repr(value: object) -> str:
    """A short representation on one line."""
    try:
        return repr(value).encode("ascii", "backslashreplace").decode()[:60].replace("\n", " ")
    except Exception:
        return type(value).__name__
