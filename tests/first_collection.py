"""In a new checkout one worker compiles all tests while the others wait: at once, each of them would compile all.

pytest rewrites the assertions of a module when it compiles it, which takes as long as the rest of a collection.
"""

import contextlib
from collections.abc import Iterator

import pytest

from computed_once import alone

FOLDER, LOCK, DONE = "smarig", "compiling", "compiled"  # in pytest's cache, which belongs to the checkout


@contextlib.contextmanager
def compiled_by_the_first(config: pytest.Config) -> Iterator[None]:
    """Around the collection of a worker. Without workers or a cache nobody waits."""
    cache = getattr(config, "cache", None)
    if cache is None or not hasattr(config, "workerinput"):
        yield
        return
    folder = cache.mkdir(FOLDER)
    if not (folder / DONE).exists():
        with alone(folder / LOCK):
            if not (folder / DONE).exists():
                yield
                (folder / DONE).touch()
                return
    yield
