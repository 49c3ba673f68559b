"""The start of simulated devices: they end with their host, and say why they cannot start."""

import json
import os
import select
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import click

from smarig.core import SmarigError, UsageError

_HOST = 0  # standard input, the pipe of the host
_STEP_ms = 100  # until the end of the context is noticed


@contextmanager
def starting() -> Iterator[None]:
    """Within the context, this process ends as soon as the host has: a file that it reads may never end. It also ends
    with an error, which people read on standard error, and the host on standard output in place of the addresses.
    """
    started = threading.Event()
    if hasattr(select, "poll"):
        threading.Thread(target=_watch, args=(started,), name="host", daemon=True).start()
    try:
        yield
    except (SmarigError, OSError) as error:
        click.echo(f"Error: {error}", err=True)
        click.echo(json.dumps({"error": str(error)}))
        sys.exit(error.exit_status if isinstance(error, SmarigError) else UsageError.exit_status)
    finally:
        started.set()


def _watch(started: threading.Event) -> None:
    poll = select.poll()
    poll.register(_HOST, 0)  # no data, only the end of the pipe
    while not started.is_set():
        if any(event & select.POLLHUP for _, event in poll.poll(_STEP_ms)) and not started.is_set():
            os._exit(1)
