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
    """Copies what is written to ``pipe`` into the file at ``path``, until the writer closes it.

    Both ends of the pipe are open from the start, so that nobody waits for the other end; ``writer_opened`` lets go of
    the writing end. Raises OSError if the pipe cannot be opened.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._folder = tempfile.TemporaryDirectory(prefix="smarig-")  # of this user alone
        self.pipe = Path(self._folder.name) / "recording.rrd"
        os.mkfifo(self.pipe)
        self._source = os.open(self.pipe, os.O_RDONLY | os.O_NONBLOCK)
        self._writing_end = self.pipe.open("wb", buffering=0)
        os.set_blocking(self._source, True)
        self._error: OSError | None = None
        self._thread = threading.Thread(target=self._copy, daemon=True)
        self._thread.start()

    def writer_opened(self) -> None:
        """The writer has opened the pipe: it ends when that one closes it."""
        self._writing_end.close()

    def check(self) -> None:
        """Raise the error of the file, if there was one."""
        if self._error is not None:
            raise self._error

    def close(self) -> None:
        """Wait until the writer has closed the pipe and everything is in the file. Raises OSError if it is not."""
        self._writing_end.close()
        self._thread.join()
        self._folder.cleanup()
        self.check()

    def _copy(self) -> None:
        """After an error it goes on reading, for the writer would wait for ever."""
        with os.fdopen(self._source, "rb", buffering=0) as source:
            try:
                with self._path.open("wb") as file:
                    while block := source.read(BLOCK_BYTES):
                        file.write(block)
            except OSError as error:
                self._error = error
                while source.read(BLOCK_BYTES):
                    pass
