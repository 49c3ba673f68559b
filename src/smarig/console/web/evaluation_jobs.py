"""Evaluations that are being computed, and the results of those that have ended, until the console ends."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from smarig.core import UsageError


@dataclass(frozen=True)
class EvaluationResult:
    """What an evaluation printed, and whether it is good news: "good", "warning" or "bad"."""

    text: str
    level: str


@dataclass
class EvaluationJob:
    """One evaluation of an entry. ``result`` is None while it is being computed. ``page``: what it will write."""

    command: str
    page: Path | None
    began: float = field(default_factory=time.time)
    result: EvaluationResult | None = None


class EvaluationJobs:
    """Evaluations by entry and name. Each is computed in a thread that waits for a process."""

    def __init__(self) -> None:
        self._jobs: dict[tuple[str, str], EvaluationJob] = {}
        self._lock = threading.Lock()

    def start(
        self, identity: str, name: str, job: EvaluationJob, compute: Callable[[], EvaluationResult]
    ) -> None:
        """Start an evaluation. Raises UsageError if the same one is being computed."""
        with self._lock:
            present = self._jobs.get((identity, name))
            if present is not None and present.result is None:
                raise UsageError("This evaluation is being computed already.")
            self._jobs[identity, name] = job

        def work() -> None:
            try:
                job.result = compute()
            except Exception as error:  # a page that waits for ever would be worse
                job.result = EvaluationResult(f"It could not be computed: {error}", "bad")

        threading.Thread(target=work, name=f"evaluation {name}", daemon=True).start()

    def of(self, identity: str) -> dict[str, EvaluationJob]:
        """The evaluations of an entry by name: those that are being computed, and the last result of each other."""
        with self._lock:
            return {name: job for (whose, name), job in self._jobs.items() if whose == identity}
