"""What a person may tell a running experiment: pause, resume, stop. Read by the runner once a tick."""

from smarig.core import Interrupted


class RunControl:
    """Flags set from a signal handler, a key, another thread; plain attributes, so setting is atomic."""

    def __init__(self) -> None:
        self.paused = False
        self.waiting_since_s: float | None = None  # monotonic, while a protocol is asked for its next command
        self._stop_cause = ""

    def stop(self, cause: str) -> None:
        """Ask the run to end safely; the first cause is kept."""
        self._stop_cause = self._stop_cause or cause

    @property
    def cause(self) -> str:
        """Why a stop was asked for; "" where none was."""
        return self._stop_cause

    @property
    def stopping(self) -> bool:
        """Whether a stop was asked for."""
        return bool(self._stop_cause)

    def raise_if_stopped(self) -> None:
        """Interrupted with the cause, if a stop was asked for."""
        if self._stop_cause:
            raise Interrupted(self._stop_cause)
