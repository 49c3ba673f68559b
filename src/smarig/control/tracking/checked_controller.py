"""Asks a controller for its next current, and takes nothing that is none.

A controller may be somebody's own file: it may yield nonsense, end early, or raise what ends programs. Each is one
sentence, with file and line where there are such; the run then ends at zero, and keeps what was measured. Refuses to
know what a rig allows.
"""

import contextlib
import math
from collections.abc import Generator, Iterator
from numbers import Real
from typing import Any

from smarig.control.tracking.controller_model import ControllerFactory, ControllerModel, ReferenceFunction
from smarig.core import LimitExceeded, Sample, SmarigError, UsageError

_EXHAUSTED = object()


class CheckedController:
    """A controller at work: ``first()`` is its current before any sample, ``after(sample)`` that after one, A."""

    def __init__(
        self,
        make: ControllerFactory,
        controller_model: ControllerModel,
        reference: ReferenceFunction,
        name: str = "",
    ) -> None:
        self._name = f"Controller '{name}'" if name else "The controller"
        self._controller: Any = None
        self._line = ""
        with self._controller_faults():
            self._controller = make(controller_model, reference)
        if not isinstance(self._controller, Generator):
            raise UsageError(f"{self._name} yields nothing: it must be a generator of currents, A.")

    def first(self) -> float:
        """UsageError for what is no number, LimitExceeded for NaN and infinity."""
        return self._current(None)

    def after(self, sample: Sample) -> float:
        """The same, once it has seen a sample."""
        return self._current(sample)

    def close(self) -> None:
        """Let go of the controller, whatever it thinks of that."""
        with contextlib.suppress(Exception):
            self._controller.close()

    def _current(self, sample: Sample | None) -> float:
        with self._controller_faults():
            try:
                yielded = self._controller.send(sample)
            except StopIteration:
                yielded = _EXHAUSTED
        if yielded is _EXHAUSTED:
            raise UsageError(
                f"{self._location()}: it ended. A controller yields until it is closed (while True)."
            )
        current_A = _number(yielded)
        if current_A is None:
            raise UsageError(
                f"{self._location()}: it yields currents, A, as numbers, not {_short_repr(yielded)}."
            )
        if not math.isfinite(current_A):
            raise LimitExceeded(
                f"{self._location()}: it asked for {current_A} A, the loop is broken. The current is at zero."
            )
        return current_A

    @contextlib.contextmanager
    def _controller_faults(self) -> Iterator[None]:
        """What would end more than a run is told as a fault of the controller; other errors are as they are."""
        location = self._location()
        try:
            yield
        except (SmarigError, KeyboardInterrupt):
            raise
        except BaseException as error:
            raised = error.__cause__ if isinstance(error.__cause__, StopIteration) else error
            if isinstance(raised, Exception) and not isinstance(raised, StopIteration):
                raise
            raise UsageError(
                f"{location}: it raised {type(raised).__name__}, which no controller may."
            ) from error

    def _location(self) -> str:
        """Its name, and the file and line at which it stands."""
        frame = getattr(self._controller, "gi_frame", None)
        if frame is not None:
            self._line = f", {frame.f_code.co_filename}, line {frame.f_lineno}"
        return self._name + self._line


def _number(yielded: object) -> float | None:
    if not isinstance(yielded, Real) or isinstance(yielded, bool):
        return None
    try:
        return float(yielded)
    except OverflowError:
        return math.inf


def _short_repr(value: object) -> str:
    """On one line, and short."""
    try:
        return repr(value).encode("ascii", "backslashreplace").decode()[:60].replace("\n", " ")
    except Exception:
        return type(value).__name__
