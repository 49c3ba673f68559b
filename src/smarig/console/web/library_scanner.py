"""Keeps the library as the folder is: a thread that scans it now and then, and when something was asked for."""

import threading

from smarig.console.library.library import Library
from smarig.core import SmarigError

EVERY_S = 10.0


class LibraryScanner:
    """``with LibraryScanner(library) as scanner``; ``text`` tells what it does, or what went wrong."""

    def __init__(self, library: Library) -> None:
        self._library = library
        self._stop, self._wake = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._scan, name="library scan", daemon=True)
        self.text = "The folder has not been read yet."

    def __enter__(self) -> "LibraryScanner":
        self._thread.start()
        return self

    def __exit__(self, *_error: object) -> None:
        self._stop.set()
        self._wake.set()
        self._thread.join(5.0)

    def soon(self) -> None:
        """Scan now instead of later."""
        self._wake.set()

    def _scan(self) -> None:
        while not self._stop.is_set():
            try:
                found = self._library.refresh(self._stop, self._show_progress)
                self.text = " ".join(found.problems)
            except SmarigError as error:
                self.text = str(error)
            except OSError as error:  # a folder that is gone, a disk that fails: tried again
                self.text = f"The folder cannot be read: {error.strerror or error}."
            self._wake.wait(EVERY_S)
            self._wake.clear()

    def _show_progress(self, done: int, total: int) -> None:
        self.text = f"Reading files: {done} of {total}."
