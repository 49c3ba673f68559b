"""Runs a command of the command line in a process of its own, and waits for its end."""

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from smarig.core import UsageError


def process_command(command: Sequence[str]) -> list[str]:
    """``command``, from ``smarig`` on, with this interpreter.

    ``-P``: a file of the folder, such as click.py, is never imported as a module.
    """
    return [sys.executable, "-P", "-m", *command]


def run_command(command: Sequence[str], folder: Path, longest_s: float) -> subprocess.CompletedProcess[str]:
    """What a command printed, and its exit status. Raises UsageError if it cannot be started or takes too long."""
    try:
        return subprocess.run(
            process_command(command),
            cwd=folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=longest_s,
        )
    except subprocess.TimeoutExpired:
        raise UsageError(
            f"'smarig {command[1]}' took more than {longest_s:g} s and was ended. Run it at a terminal."
        ) from None
    except OSError as error:
        raise UsageError(f"'smarig {command[1]}' could not be started: {error.strerror or error}.") from None
