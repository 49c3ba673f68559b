"""Configuration files that only a record or a model names: no message quotes their contents."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from smarig.core import UsageError


@contextmanager
def recorded_file(where: str, name: str, remedy: str) -> Iterator[None]:
    """Load a rig or an actuator that ``where`` names. An error in a file is reported without its contents.

    A run or a model may come from anywhere and name any file; its author must not learn what the file contains.
    """
    try:
        yield
    except UsageError:
        if not Path(name).is_file():
            raise
        raise UsageError(f"{where} names the file {name}, which is not as expected here. {remedy}") from None
