"""While devices start, they end with their host: nobody reads their standard input before they serve."""

import os
import select
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_HOST = 0  # standard input, the pipe of the host
_STEP_ms = 100  # until the end of the context is noticed


@contextmanager
def ending_with_host() -> Iterator[None]:
    """Within the context, this process ends as soon as the host has: a file that it reads may never end."""
    started = threading.Event()
    if hasattr(select, "poll"):
        threading.Thread(target=_watch, args=(started,), name="host", daemon=True).start()
    try:
        yield
    finally:
        started.set()


def _watch(started: threading.Event) -> None:
    poll = select.poll()
    poll.register(_HOST, 0)  # no data, only the end of the pipe
    while not started.is_set():
        if any(event & select.POLLHUP for _, event in poll.poll(_STEP_ms)) and not started.is_set():
            os._exit(1)
