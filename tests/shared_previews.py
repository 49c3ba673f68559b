"""Previews of runs, computed once for all workers of a test session: each takes as long as the run that follows it."""

import hashlib
import os
import pickle
from collections.abc import Hashable
from pathlib import Path

from smarig.runner.preview import Preview


class SharedPreviews(dict[Hashable, Preview]):
    """In place of what ``smarig.runner.preview`` remembers within a process; also kept in a folder."""

    def __init__(self, folder: Path) -> None:
        super().__init__()
        self._folder = folder
        folder.mkdir(exist_ok=True)

    def __contains__(self, key: object) -> bool:
        """Whether this process or another one computed it."""
        path = self._path(key)
        if not super().__contains__(key) and path is not None and path.is_file():
            super().__setitem__(key, pickle.loads(path.read_bytes()))
        return super().__contains__(key)

    def __setitem__(self, key: Hashable, value: Preview) -> None:
        super().__setitem__(key, value)
        path = self._path(key)
        if path is not None:  # whole or not at all, for another worker may read it now
            own = path.with_suffix(f".{os.getpid()}")
            own.write_bytes(pickle.dumps(value))
            own.replace(path)

    def _path(self, key: object) -> Path | None:
        """None for a chooser, an object whose text says nothing about it."""
        if not isinstance(key, tuple) or key[-1] is not None:
            return None
        return self._folder / hashlib.sha256(repr(key).encode()).hexdigest()
