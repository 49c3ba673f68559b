"""Keeps the log of the server short: of messages that repeat, the first few of a minute, and the number of the rest.

Whoever can connect can make the server log: by bytes that are no request, or by more connections than it has
descriptors for.
"""

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass

EACH, WINDOW_S = 3, 60.0  # messages of a kind
_KINDS = 50  # that are told apart; the rest is one kind
_LONGEST = 4000  # characters of a message


@dataclass
class _Count:
    began_s: float
    passed: int = 0
    left_out: int = 0


class LogLimit(logging.Filter):
    """A filter of a logger. Two messages are of one kind if they are made from the same text."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._clock = clock
        self._counts: dict[str, _Count] = {}

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether the record is written. The first of a minute says how many of the last one were left out."""
        kind, now_s = str(record.msg), self._clock()
        if kind not in self._counts and len(self._counts) >= _KINDS:
            kind = ""
        count = self._counts.setdefault(kind, _Count(now_s))
        left_out = 0
        if now_s - count.began_s >= WINDOW_S:
            left_out = count.left_out
            self._counts[kind] = count = _Count(now_s)
        if count.passed >= EACH:
            count.left_out += 1
            return False
        count.passed += 1
        text = record.getMessage()[:_LONGEST]
        record.msg, record.args = (
            (f"{text} ({left_out} more were left out before.)" if left_out else text),
            (),
        )
        return True


def limit_logs(*loggers: str) -> None:
    """Limit the logs of these loggers."""
    for name in loggers:
        logging.getLogger(name).addFilter(LogLimit())
