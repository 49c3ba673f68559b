"""The command of ``--notify``: runs once for each message, with the message as JSON on its standard input.

No shell is involved unless the command uses one's syntax. Nothing of a message becomes part of the command line.
"""

import contextlib
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from typing import NamedTuple

from smarig.core import Severity, UsageError

CALL_TIMEOUT_S = 10.0  # for one call
_SHELL_SYNTAX = re.compile(r"[|&;<>()$`*?~#{}\[\]\n]|^\s*\w+=")
_MOST = 2000  # characters of a text in the environment


class Notification(NamedTuple):
    """A message. ``cause`` and ``exit_status`` are given at the end of the command only."""

    wire: str
    rig: str
    protocol: str
    run: str
    time: str
    severity: Severity
    kind: str
    text: str
    cause: str | None = None
    exit_status: int | None = None

    def json(self) -> bytes:
        """One line of JSON."""
        return (json.dumps(self._asdict(), ensure_ascii=False) + "\n").encode("utf-8", "replace")

    def variables(self) -> dict[str, str]:
        """Environment variables; values need no quoting, since no shell parses them."""
        values = {
            "SMARIG_TEXT": self.text,
            "SMARIG_SEVERITY": self.severity,
            "SMARIG_KIND": self.kind,
            "SMARIG_RUN": self.run,
            "SMARIG_CAUSE": self.cause or "",
            "SMARIG_STATUS": "" if self.exit_status is None else str(self.exit_status),
        }
        code = sys.getfilesystemencoding()  # what cannot be encoded must not keep a message back
        plain = {name: value.replace("\0", "")[:_MOST] for name, value in values.items()}
        return {name: value.encode(code, "replace").decode(code) for name, value in plain.items()}


class NotifyCommand:
    """A checked command. ``deliver`` blocks, so the caller decides in which thread."""

    def __init__(self, text: str) -> None:
        self.text = text
        try:
            words = shlex.split(text)
        except ValueError as error:
            raise UsageError(f"--notify: '{text}' is not a command: {error}. Close its quotes.") from None
        if not words:
            raise UsageError("--notify needs a command, such as 'notify-send smarig'.")
        self.uses_shell = os.name == "nt" or _SHELL_SYNTAX.search(text) is not None
        self._line: str | list[str] = text if self.uses_shell else words
        self._process: subprocess.Popen[bytes] | None = None
        self._stopped = False

    @property
    def missing(self) -> bool:
        """Whether there is no such program; False if only a shell can know."""
        return not self.uses_shell and shutil.which(self._line[0]) is None

    def deliver(self, message: Notification) -> str:
        """Run the command with a message. Returns why it failed, "" if it did not."""
        self._stopped = False
        try:
            process = subprocess.Popen(
                self._line,
                shell=self.uses_shell,  # the user wrote this command line
                env={**os.environ, **message.variables()},
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,  # stdout is for results
                stderr=subprocess.DEVNULL,
                start_new_session=os.name != "nt",  # so that all that it starts can be ended
            )
        except (OSError, ValueError) as error:
            return str(getattr(error, "strerror", None) or error)
        self._process = process
        try:
            process.communicate(message.json(), CALL_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            _kill(process)
            return f"it took longer than {CALL_TIMEOUT_S:g} s"
        except KeyboardInterrupt:
            _kill(process)
            return "it was interrupted by the keyboard"
        finally:
            self._process = None
        if self._stopped:
            return "it was not finished at the end"
        return f"exit status {process.returncode}" if process.returncode else ""

    def stop(self) -> None:
        """End a call that another thread is making."""
        process = self._process
        if process is not None:
            self._stopped = True
            _kill(process)


def _kill(process: subprocess.Popen[bytes]) -> None:
    """End a command with all that it has started."""
    with contextlib.suppress(OSError):
        if os.name == "nt":
            process.kill()
        else:
            os.killpg(process.pid, signal.SIGKILL)
    process.wait()
