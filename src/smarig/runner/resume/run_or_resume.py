"""Runs a step of a campaign, resumes it if it was interrupted, or leaves it if it is finished."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from smarig.core import UsageError
from smarig.protocols import Chooser, file_settings
from smarig.record import Run, load_run
from smarig.runner.listener import Listener
from smarig.runner.preview import Preview
from smarig.runner.resume.resume_run import resume_in
from smarig.runner.resume.same_rig import check_same_rig
from smarig.runner.session import Session


def check_same_experiment(run: Run, session: Session, protocol: str, settings: Mapping[str, Any]) -> None:
    """Raise UsageError if a run is another experiment or belongs to another rig or wire."""
    check_same_rig(run, session)
    requested = {key: str(value) for key, value in settings.items()}
    for what, then, now in (
        ("protocol", run.info.protocol, protocol),
        ("settings", run.info.settings if run.info.has("settings") else None, requested),
        ("wire", run.info.wire, session.wire),
    ):
        if then != now:
            raise UsageError(f"{run.path} was made with {what} {then}, not with {now}. Give another folder.")


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
    """Run, resume or skip in an open session. Returns a sentence unless it ran from the start; raises its error."""
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
        return f"{protocol}: {out} is finished."
    files = {key: settings[key] for key in file_settings(protocol) if settings.get(key)}
    plan = resume_in(session, run, listeners=listeners, expected=expected, chooser=chooser, settings=files)
    return f"{protocol}: {out}. {plan.sentence()}"
