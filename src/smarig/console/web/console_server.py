"""Serves the console on loopback, until it is ended; runs and the queue go on without it."""

import secrets
import signal
import socket
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from types import FrameType
from typing import Any, cast

import uvicorn

from smarig.console.library.library import Library
from smarig.console.queue.ensure_worker import ensure_worker
from smarig.console.queue.queue import Queue
from smarig.console.web.access_guard import TOKEN
from smarig.console.web.application import console_application
from smarig.console.web.connection_limit import ACCEPTED_AT_ONCE, ConnectionLimit, limit_logs
from smarig.console.web.console_context import ConsoleContext
from smarig.console.web.console_scope import ConsoleScope
from smarig.console.web.ended_runs import EndedRuns
from smarig.console.web.library_scanner import LibraryScanner
from smarig.console.web.rig_checks import RigChecks
from smarig.console.web.rig_files import rig_entry
from smarig.console.web.viewers import Viewers
from smarig.core import SmarigError, UsageError

HOST = "127.0.0.1"
_SHUTDOWN_S = 1  # that open pages may take
WAITING_TO_BE_ACCEPTED = 100  # connections


def serve_console(
    folder: Path,
    *,
    rig: str = "one_wire_twin",
    port: int = 0,
    open_browser: bool = False,
    announce: Callable[[str], None] = print,
) -> None:
    """Serve the console of a folder until Ctrl-C or SIGTERM; ``announce`` is told its address with the token.

    ``port`` 0: any free one. Entries that were queued here go on; those that came with the folder wait for a click.
    Raises UsageError if the port is taken.
    """
    with closing(_bound(port)) as listening, Queue.open(folder) as queue:
        library, token = Library.open(folder), secrets.token_urlsafe(24)
        port = listening.getsockname()[1]
        root = folder.resolve()
        with (
            LibraryScanner(library) as scanner,
            closing(Viewers()) as viewers,
            closing(RigChecks(root)) as rig_checks,
        ):
            scope = ConsoleScope(root)
            scope.opened.add(rig_entry(rig, root).closed_mark)  # named on the command line
            scope.open_rig(rig_entry(rig, root, scope.opened).file)
            ended_runs = EndedRuns(scope)
            context = ConsoleContext(
                root, rig, queue, library, scanner, scope, ended_runs, viewers, rig_checks
            )
            limit = ConnectionLimit()
            application = console_application(context, token, port, limit.admit)
            address = f"http://{HOST}:{port}/?{TOKEN}={token}"
            announce(address)
            _go_on(queue, folder, announce)
            if open_browser:
                webbrowser.open(address)
            config = uvicorn.Config(
                application,
                log_level="warning",
                access_log=False,
                lifespan="off",
                http=cast(Any, limit.protocol),  # h11, which refuses two Host headers; others pass them on
                backlog=ACCEPTED_AT_ONCE,
                ws="none",
                timeout_graceful_shutdown=_SHUTDOWN_S,
                server_header=False,
            )
            limit_logs("uvicorn.error", "asyncio", "python_multipart.multipart")
            _Server(config, context).run(sockets=[listening])


class _Server(uvicorn.Server):
    """Ends open streams before it waits for them, and returns after a signal instead of raising it again."""

    def __init__(self, config: uvicorn.Config, context: ConsoleContext) -> None:
        super().__init__(config)
        self._context = context

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """``backlog`` bounds what is accepted in one round, and not what may wait to be accepted."""
        await super().startup(sockets)
        for listening in sockets or ():
            listening.listen(WAITING_TO_BE_ACCEPTED)

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Stop at SIGINT and SIGTERM."""
        old = {number: signal.signal(number, self.handle_exit) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            yield
        finally:
            for number, handler in old.items():
                signal.signal(number, handler)

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """End the streams, then the server."""
        self._context.closing.set()
        super().handle_exit(sig, frame)


def _go_on(queue: Queue, folder: Path, announce: Callable[[str], None]) -> None:
    """Start the worker of a queue with entries; one that fails to start is told, and the console is shown."""
    try:
        if queue.entries(newest=0):
            ensure_worker(folder)
        if n := len(queue.held()):
            entries = "1 entry of the queue waits" if n == 1 else f"{n} entries of the queue wait"
            announce(f"{entries} for you to look at: the queue was not filled here, or its code has changed.")
    except SmarigError as error:
        announce(str(error))


def _bound(port: int) -> socket.socket:
    listening = socket.socket()
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((HOST, port))
        listening.listen(
            WAITING_TO_BE_ACCEPTED
        )  # before the address is told: a browser that is faster than the server waits
    except (OSError, OverflowError) as error:
        listening.close()
        reason = getattr(error, "strerror", None) or error
        raise UsageError(f"Port {port} cannot be used: {reason}. Give another one with --port.") from None
    return listening
