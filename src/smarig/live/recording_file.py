"""A recording on its way from Rerun to a file, through a pipe: errors of the disk are raised here, as OSError.

Rerun writes files itself, but reports a full disk in its log only, or waits for ever. It can also collect a recording
in memory, which takes several hundred megabytes for a day.
"""

import os
import tempfile
import threading
from pathlib import Path

BLOCK_BYTES = 1 << 16


class RecordingFile:
    """Copies what is written to ``pipe`` into the file at ``path``, until the writer closes it."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._folder = tempfile.TemporaryDirectory(prefix="smarig-")  # of this user alone
        self.pipe = Path(self._folder.name) / "recording.rrd"
        os.mkfifo(self.pipe)
        self._error: OSError | None = None
        self._thread = threading.Thread(target=self._copy, daemon=True)
        self._thread.start()

    def check(self) -> None:
        """Raise the error of the file, if there was one."""
        if self._error is not None:
            raise self._error

    def close(self) -> None:
        """Wait until the writer has closed the pipe and everything is in the file. Raises OSError if it is not."""
        self._thread.join()
        self._folder.cleanup()
        self.check()

    def _copy(self) -> None:
        """After an error it goes on reading, for the writer would wait for ever."""
        with self.pipe.open("rb", buffering=0) as source:
            try:
                with self._path.open("wb") as file:
                    while block := source.read(BLOCK_BYTES):
                        file.write(block)
            except OSError as error:
                self._error = error
                while source.read(BLOCK_BYTES):
                    pass
