"""``--notify COMMAND``: run a shell command when a run has ended, for any cause.

A notification that fails is reported and has no other consequence.
"""

import os
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from smarig.cli.output import show_message
from smarig.core import Interrupted, SmarigError

_COMMAND_TIMEOUT_S = 60.0

notify_option: Callable = click.option(
    "--notify",
    default="",
    metavar="COMMAND",
    help="Shell command to run at the end or after a trip; $SMARIG_RUN, $SMARIG_CAUSE and $SMARIG_STATUS are set.",
)


class NotificationTarget:
    """The run that the notification names. The caller sets ``run`` for each run."""

    def __init__(self, run: Path | None) -> None:
        self.run = run


@contextmanager
def notified(command: str, run: Path | None = None) -> Iterator[NotificationTarget]:
    """Run the command after the body, with the cause and the exit status of the body."""
    notification = NotificationTarget(run)
    try:
        yield notification
    except BaseException as error:
        _notify(command, notification, *_outcome(error))
        raise
    _notify(command, notification, "done", 0)


def _outcome(error: BaseException) -> tuple[str, int]:
    if isinstance(error, SmarigError):
        return str(error), error.exit_status
    if isinstance(error, KeyboardInterrupt):
        return "interrupted by the keyboard", Interrupted.exit_status
    return f"{type(error).__name__}: {error}", 1


def _notify(command: str, notification: NotificationTarget, cause: str, status: int) -> None:
    """Run the command. Values in environment variables need no quoting, since no shell parses them."""
    if not command:
        return
    variables = {
        "SMARIG_RUN": str(notification.run or ""),
        "SMARIG_CAUSE": cause,
        "SMARIG_STATUS": str(status),
    }
    try:
        done = subprocess.run(
            command,
            shell=True,  # the user wrote this command line
            env={**os.environ, **{key: value.replace("\0", "") for key, value in variables.items()}},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,  # stdout is for results
            stderr=subprocess.DEVNULL,
            timeout=_COMMAND_TIMEOUT_S,
            check=False,
        )
        failure = f"exit status {done.returncode}" if done.returncode else ""
    except subprocess.TimeoutExpired:
        failure = f"it took longer than {_COMMAND_TIMEOUT_S:g} s"
    except OSError as error:
        failure = str(error.strerror or error)
    if failure:
        show_message(f"--notify: '{command}' failed: {failure}.")
