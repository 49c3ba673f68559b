"""Turns what Python raises at values of a damaged record into one sentence."""

from collections.abc import Iterator
from contextlib import contextmanager

from smarig.core import DataError
from smarig.record import Run


@contextmanager
def damaged_record_as_data_error(run: Run) -> Iterator[None]:
    """Raise DataError for values of a record that cannot be interpreted."""
    try:
        yield
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise DataError(
            f"{run.path.name} cannot be resumed: its record is damaged ({type(error).__name__}: {error})."
        ) from None
