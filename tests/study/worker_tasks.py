"""Tasks for worker processes: functions that a process of its own can import."""

import os
import signal
import threading


def kill_itself(task: int) -> int:
    """End this process without notice at task 1."""
    if task == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return task


def own_process(task: int) -> tuple[int, bool]:
    """The number of this process and whether it ignores Ctrl-C; all tasks but the first never end."""
    if task:
        threading.Event().wait()
    return os.getpid(), signal.getsignal(signal.SIGINT) == signal.SIG_IGN
