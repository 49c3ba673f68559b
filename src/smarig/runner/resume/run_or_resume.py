"""A run of a campaign that may be there already: done, it is left; interrupted, it is gone on with; else it is run.

Knows sessions and resuming; refuses to know campaigns.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from smarig.core import UsageError
from smarig.protocols import Chooser
from smarig.record import Run, load_run
from smarig.runner.listener import Listener
from smarig.runner.preview import Preview
from smarig.runner.resume.resume_run import check_rig, resume_in
from smarig.runner.session import Session


def check_same_experiment(run: Run, session: Session, protocol: str, settings: Mapping[str, Any]) -> None:
    """UsageError where a run is another experiment, or of another rig or wire."""
    check_rig(run, session.file)
    requested = {key: str(value) for key, value in settings.items()}
    for what, then, now in (
        ("protocol", run.info.protocol, protocol),
        ("settings", run.info.settings if run.info.has("settings") else None, requested),
        ("wire", run.info.wire, session.wire),
    ):
        if then != now:
            raise UsageError(f"{run.path} is of {what} {then}, not of {now}: give another folder.")


def run_or_resume(
    session: Session,
    protocol: str,
    settings: Mapping[str, Any],
    out: Path,
    *,
    listeners: Sequence[Listener] = (),
    expected: Preview | None = None,
    chooser: Chooser | None = None,
    notes: str = "",
    force: bool = False,
) -> str:
    """In an open session; a sentence where it was not simply run. Raises what ended it, after closing the run."""
    if force or not out.exists():
        session.run(
            protocol,
            settings,
            out,
            listeners=listeners,
            expected=expected,
            chooser=chooser,
            notes=notes,
            force=force,
        )
        return ""
    run = load_run(out)
    check_same_experiment(run, session, protocol, settings)
    if run.cause == "done":
        return f"{protocol}: {out} is done."
    plan = resume_in(session, run, listeners=listeners, expected=expected, chooser=chooser)
    return f"{protocol}: {out}. {plan.sentence()}"
