"""Gets the next current from a controller and rejects invalid ones.

A controller may be a user's own file: it may yield invalid values, end early, or raise exceptions that end programs.
Each case gives one message with file and line if known. The run then ends at zero and keeps its record.
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
    """A running controller: ``first()`` is its current before any sample, ``after(sample)`` that after a sample, A."""

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
            raise UsageError(f"{self._name} yields nothing. It must be a generator of currents in A.")

    def first(self) -> float:
        """The current before any sample. Raises UsageError if not a number, LimitExceeded for NaN and infinity."""
        return self._current(None)

    def after(self, sample: Sample) -> float:
        """The current after a sample, with the same errors."""
        return self._current(sample)

    def close(self) -> None:
        """Close the controller and suppress its exceptions."""
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
                f"{self._location()}: the generator ended. A controller must yield (while True) until the "
                "run closes it."
            )
        current_A = _number(yielded)
        if current_A is None:
            raise UsageError(
                f"{self._location()}: it must yield currents in A as numbers, got {_short_repr(yielded)}."
            )
        if not math.isfinite(current_A):
            raise LimitExceeded(
                f"{self._location()}: it commanded {current_A} A, so the loop is invalid."
            ).at_zero()
        return current_A

    @contextlib.contextmanager
    def _controller_faults(self) -> Iterator[None]:
        """Raise UsageError for exceptions that would end more than the run; other errors pass unchanged."""
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
                f"{location}: it raised {type(raised).__name__}, which a controller must not raise."
            ) from error

    def _location(self) -> str:
        """Its name, with file and line of its present yield."""
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
    """A short representation on one line."""
    try:
        return repr(value).encode("ascii", "backslashreplace").decode()[:60].replace("\n", " ")
    except Exception:
        return type(value).__name__
