"""``--notify COMMAND``: run a command for alarms, stalls and recoveries during a run, and at its end for any cause.

A command and not HTTP: retries, certificates and secrets are those of the command, such as ``curl``.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, NamedTuple

import click

from smarig.cli.notifier import NotificationListener, Notifier, Subject, message_of, report_to
from smarig.cli.notify_command import Notification, NotifyCommand
from smarig.cli.option_group import option_group
from smarig.cli.output import show_message
from smarig.core import Interrupted, Severity, SmarigError, highest_severity

if TYPE_CHECKING:
    from smarig.runner import Listener, RunControl
    from smarig.running import PanelRunInfo


class NotifyOptions(NamedTuple):
    """The values of the options: a command, or "", and the least severity of the events that it reports."""

    command: str
    least: str = Severity.MAJOR


notify_option = option_group(
    "notify",
    lambda notify, notify_level: NotifyOptions(notify, notify_level),
    (
        click.option(
            "--notify",
            default="",
            metavar="COMMAND",
            help="Command to run at alarms, stalls, recoveries and the end, with a JSON object on its stdin; "
            "$SMARIG_TEXT, $SMARIG_SEVERITY, $SMARIG_KIND, $SMARIG_RUN, $SMARIG_CAUSE and $SMARIG_STATUS are set.",
        ),
        click.option(
            "--notify-level",
            type=click.Choice([str(s) for s in Severity if s != Severity.NONE]),
            default=str(Severity.MAJOR),
            show_default=True,
            help="Least severity of the events that --notify reports during a run.",
        ),
    ),
)


class Watch:
    """What the runs of a command report. ``subject`` is the present run, or the command before its first."""

    def __init__(self, subject: Subject, notifier: Notifier | None, least: Severity) -> None:
        self.subject, self._notifier, self._least = subject, notifier, least
        self._listeners: list[NotificationListener] = []

    def listeners(self, run: "PanelRunInfo") -> "list[Listener]":
        """The listener of a run that starts: one, or none without ``--notify``."""
        self.subject = Subject(run.wire, run.rig, run.protocol, str(run.out), run.unit)
        if self._notifier is None:
            return []
        self._listeners.append(NotificationListener(self._notifier, self.subject, self._least))
        return [self._listeners[-1]]

    def end_message(self, error: BaseException | None) -> Notification:
        """The message at the end of the command."""
        from smarig.runner import end_severity

        cause, status = _outcome(error)
        noted = highest_severity(listener.highest for listener in self._listeners)
        remark = "" if noted == Severity.NONE else f" Highest severity before: {noted}."
        what = f"Run of {self.subject.protocol}" if self.subject.protocol else "The command"
        text = f"{what} ended: {cause.rstrip('.')}.{remark}"
        message = message_of(self.subject, "end", end_severity(error), text)
        return message._replace(cause=cause, exit_status=status)


@contextmanager
def notified(options: NotifyOptions, control: "RunControl", subject: Subject) -> Iterator[Watch]:
    """Run the command for what the body reports, and after the body with its cause and exit status."""
    if not options.command:
        yield Watch(subject, None, Severity.MAJOR)
        return
    command = NotifyCommand(options.command)
    if command.missing:
        show_message(f"Warning: --notify: there is no command '{command.text}'. The run starts nevertheless.")
    notifier = Notifier(command, report_to(control))
    watch = Watch(subject, notifier, Severity(options.least))
    try:
        yield watch
    except BaseException as error:
        _end(notifier, watch.end_message(error))
        raise
    _end(notifier, watch.end_message(None))


def _end(notifier: Notifier, message: Notification) -> None:
    """Deliver what waits, then the end; print what failed."""
    notifier.close()
    notifier.deliver(message)
    failures, name = notifier.failures, notifier.command.text
    if failures:
        often = f" {len(failures)} times; the last time" if len(failures) > 1 else ""
        show_message(f"--notify: '{name}' failed{often}: {failures[-1]}.")
    if notifier.undelivered:
        show_message(f"--notify: '{name}' was too slow: {notifier.undelivered} messages were dropped.")


def _outcome(error: BaseException | None) -> tuple[str, int]:
    if error is None:
        return "done", 0
    if isinstance(error, SmarigError):
        return str(error), error.exit_status
    if isinstance(error, KeyboardInterrupt):
        return "interrupted by the keyboard", Interrupted.exit_status
    return f"{type(error).__name__}: {error}", 1
