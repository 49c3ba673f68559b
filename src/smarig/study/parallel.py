"""Runs one function on many tasks: in this process, in several, or on a Dask cluster.

Other processes use the plug-ins that this one uses.
"""

import os
import signal
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from multiprocessing import active_children, get_context, parent_process
from typing import Any, TypeVar

from smarig.core import DataError, MissingExtra, UsageError, plugins_in_use, use_plugin

CONNECT_TIMEOUT_S = 10
SAFE_PATH = "PYTHONSAFEPATH"
Answer = TypeVar("Answer")


def completed(
    function: Callable[[Any], Answer], tasks: Sequence[Any], workers: int, scheduler: str | None = None
) -> Generator[Answer, None, None]:
    """The answers as they are completed, in any order. ``scheduler``: the address of a Dask scheduler.

    Closing the generator ends the processes; what they were doing is not completed.

    Raises UsageError if no scheduler responds there, or without the extra 'scale'; DataError if a process is killed.

    >>> list(completed(abs, [-1, -2], 1))
    [1, 2]
    """
    if not tasks:
        return
    elsewhere = partial(_with_plugins, plugins_in_use(), function)
    if scheduler is not None:
        yield from _by_dask(elsewhere, tasks, scheduler)
    elif workers == 1 or len(tasks) == 1:
        yield from map(function, tasks)
    else:
        yield from _by_processes(elsewhere, tasks, workers)


def _with_plugins(names: Sequence[str], function: Callable[[Any], Answer], task: Any) -> Answer:
    for name in names:
        use_plugin(name)
    return function(task)


def _by_processes(function: Callable[[Any], Answer], tasks: Sequence[Any], workers: int) -> Iterator[Answer]:
    others = set(active_children())
    finished = False
    with _no_modules_of_this_folder():
        pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_follow_parent)
    try:
        with _no_modules_of_this_folder():  # the workers start with the tasks that are submitted
            futures = [pool.submit(function, task) for task in tasks]
        for future in as_completed(futures):
            yield future.result()
        finished = True
    except BrokenProcessPool:
        raise DataError(
            "A worker process was ended from outside, perhaps for want of memory. What is done is kept: repeat "
            "the command, with fewer --workers."
        ) from None
    finally:  # not "with", whose end would wait for the tasks that have not begun
        if not finished:
            for process in set(active_children()) - others:
                process.terminate()
        pool.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _no_modules_of_this_folder() -> Iterator[None]:
    """Processes that start meanwhile take no file of the present folder for a module; later ones do as before."""
    before = os.environ.get(SAFE_PATH)
    os.environ[SAFE_PATH] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ[SAFE_PATH]
        else:
            os.environ[SAFE_PATH] = before


def _follow_parent() -> None:
    """In a worker: leave Ctrl-C to the parent process, which ends the workers, and end when it is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _by_dask(function: Callable[[Any], Answer], tasks: Sequence[Any], address: str) -> Iterator[Answer]:
    try:
        from distributed import Client
        from distributed import as_completed as as_done
    except ImportError:
        raise MissingExtra("A Dask cluster", "scale") from None
    try:
        client = Client(address, timeout=CONNECT_TIMEOUT_S)
    except (OSError, ValueError, TypeError, AssertionError) as error:
        raise UsageError(
            f"No Dask scheduler responds at '{address}': {str(error) or 'its client did not start'}."
        ) from None
    with client:
        for future in as_done([client.submit(function, task, pure=False) for task in tasks]):
            yield future.result()
