"""File operations that a run can do without: each on a thread of its own, waited for with a limit.

A disk or a network folder that does not answer blocks whoever asks it, in the kernel, where no signal helps. So the
thread that drives the rig never asks it directly. An operation that is given up goes on in its thread and may still
succeed; its result is dropped.
"""

import contextlib
import threading
from collections.abc import Callable, Iterator
from typing import TypeVar

from smarig.core.errors import StorageError

LIMIT_S = 5.0
T = TypeVar("T")


def in_time(work: Callable[[], T], what: str, *, limit_s: float | None = None) -> T:
    """The result of file operations, or their exception. Raises StorageError, naming ``what``, after ``limit_s``.

    >>> in_time(lambda: 6 * 7, "Nothing")
    42
    """
    known, values, errors = threading.Event(), list[T](), list[BaseException]()

    def run() -> None:
        try:
            values.append(work())
        except BaseException as error:  # raised again in the thread that waits
            errors.append(error)
        known.set()

    limit_s = LIMIT_S if limit_s is None else limit_s
    threading.Thread(target=run, name=f"file work: {what}", daemon=True).start()
    if not known.wait(limit_s):
        raise StorageError(f"{what}: the disk or network folder has not answered for {limit_s:g} s.")
    for error in errors:
        raise error
    return values[0]


@contextlib.contextmanager
def entered_in_time(
    context: contextlib.AbstractContextManager[T], what: str, *, limit_s: float | None = None
) -> Iterator[T]:
    """A context of file operations, entered and left in time. One that cannot be left in time is abandoned."""
    value = in_time(context.__enter__, what, limit_s=limit_s)
    try:
        yield value
    finally:
        with contextlib.suppress(StorageError):
            in_time(lambda: context.__exit__(None, None, None), what, limit_s=limit_s)
