"""The bring-up of a bench: announced and stopped as a run is, and never without the list of the checks it has made."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from smarig.cli.output import json_requested, show_message
from smarig.config import RigFile
from smarig.core import Interrupted, SmarigError, error_text
from smarig.device import Check
from smarig.plant import Actuator
from smarig.rig import Bench, StoppableBench, TwinSettings, bring_up, open_rig
from smarig.runner import BringUpHistory, RunControl, rig_locks, stop_on_signals
from smarig.running import RunStatus, announced, check_info


class CheckStopped(SmarigError):
    """A user or the system requested the end of a check; the current is at zero (exit 130)."""

    exit_status = Interrupted.exit_status


class BringUp(NamedTuple):
    """The checks in order, and what ended them early: an error whose text is the last check, or None."""

    checks: list[Check]
    error: Exception | None


def announced_bring_up(rig: str, file: RigFile, actuator: Actuator) -> BringUp:
    """Bring a bench up. Raises the error of a rig that could not even be opened."""
    checks: list[Check] = []

    def on_check(check: Check) -> None:
        checks.append(check)
        if json_requested() or not sys.stdout.isatty():  # a terminal shows the list of the end as well
            show_message(check.line)

    try:
        _bring_up(rig, file, actuator, on_check)
    except Exception as error:  # a driver may raise anything, and the list is worth as much
        if not checks:
            raise
        text = str(error) if isinstance(error, SmarigError) else error_text(error)
        return BringUp([*checks, Check("rig", False, text)], error)
    return BringUp(checks, None)


def _bring_up(rig: str, file: RigFile, actuator: Actuator, on_check: Callable[[Check], None]) -> None:
    """Announced before the devices are opened: from then on, current may flow."""
    control, info = RunControl(), check_info(file, _folder_of(rig))
    try:
        with (
            rig_locks(file, file.wire),
            stop_on_signals(control),
            announced(info, control, RunStatus(info, control)),
            open_rig(rig, file, actuator, TwinSettings(), report=show_message, recorded=False) as bench,
        ):
            assert isinstance(bench, Bench)  # noqa: S101 - of kind "bench"
            for _, text, _ in control.reports():  # why others cannot see it
                show_message(text)
            try:
                _bring_up_with_history(bench, file, actuator, control, on_check)
            except KeyboardInterrupt:  # a second Ctrl-C
                # Raised in here, so that open_rig adds what was not confirmed.
                raise _stopped(control.cause) from None
    except Interrupted as error:  # a second Ctrl-C while the devices were opened or closed
        raise CheckStopped(f"The check was {error}. Make sure that no current flows.") from None


def _bring_up_with_history(
    bench: Bench, file: RigFile, actuator: Actuator, control: RunControl, on_check: Callable[[Check], None]
) -> None:
    """However it ends, the heating enters the history of the wire."""

    def raise_if_stopped() -> None:
        if control.stopping:
            raise _stopped(control.cause)

    history = BringUpHistory(bench, file, actuator)
    try:
        bring_up(StoppableBench(bench, raise_if_stopped), file, on_check, show_message, history)
    finally:
        with control.undisturbed():
            if failure := history.save():
                show_message(failure)


def _folder_of(rig: str) -> Path:
    """The folder that a check belongs to: that of the rig's file, or the present one for a rig of smarig."""
    return Path(rig).absolute().parent if rig.endswith(".toml") else Path.cwd()


def _stopped(cause: str) -> CheckStopped:
    return CheckStopped(f"The check was {cause}.").at_zero()
