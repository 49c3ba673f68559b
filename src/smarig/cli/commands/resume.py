"""``smarig resume``: continue an interrupted run from its restored state."""

from pathlib import Path

import click

from smarig.cli.live_options import LiveOptions, live_options, live_view, with_watchers
from smarig.cli.notifier import Subject
from smarig.cli.notify import NotifyOptions, notified, notify_option
from smarig.cli.output import emit, json_option, show_message
from smarig.cli.panel.keyboard import keys
from smarig.cli.parameter_types import FILE, PROTOCOL, RIG, FiniteNumber, own_effects
from smarig.cli.progress import STREAMS, progress
from smarig.cli.run_options import print_warnings, resumable, run_summary
from smarig.core import UsageError

EPILOG = f"""{STREAMS}

\b
Examples:
  smarig resume fod.run.sqlite
  smarig resume mine.run.sqlite --protocol ./my_protocol.py
  smarig resume steps.run.sqlite --set file=profile.csv
  smarig resume fod.run.sqlite --rig my_rig.toml --notify 'mail -s "$SMARIG_TEXT" me'
"""


@click.command("resume", short_help="Continue a run that was killed, stopped or tripped.", epilog=EPILOG)
@click.argument("run", type=FILE)
@click.option("--rig", type=RIG, default="", help="Rig of the run, if its file has moved.")
@click.option(
    "--protocol", type=PROTOCOL, default="", help="Your own protocol file that the run used, FILE.py."
)
@click.option(
    "--set",
    "pairs",
    multiple=True,
    metavar="KEY=FILE",
    help="A setting of the run that names a file, given again so that the file is read.",
)
@own_effects
@click.option("--wire", default="", help="Identity of the wire; must equal that of the run.")
@click.option(
    "--speed", type=FiniteNumber(0, min_open=True), help="Twin: real time × SPEED (default: that of the run)."
)
@click.option("--quiet", is_flag=True, help="Show no panel and no log lines.")
@live_options
@notify_option
@json_option
def command(
    run: Path,
    rig: str,
    protocol: str,
    pairs: tuple[str, ...],
    wire: str,
    speed: float | None,
    quiet: bool,
    notify: NotifyOptions,
    live: LiveOptions,
) -> None:
    """Continue a run that was killed, stopped or tripped, in the same file.

    The wire is cooled and taken again through the extrema that it remembered after the last finished step.
    Then the interrupted step is repeated. If this is not possible, the protocol starts again. Steps that no
    longer count stay in the record, marked void.
    """
    from smarig.identification import informed_choice
    from smarig.protocols import parse_pairs
    from smarig.record import check_not_recording, load_run, stored_run
    from smarig.runner import preview, read_launch_args, resume_in, session_for
    from smarig.running import run_info

    check_not_recording(run)
    before = load_run(run)
    if protocol not in ("", before.info.protocol):
        raise UsageError(f"{run.name} is a run of protocol '{before.info.protocol}', not of '{protocol}'.")
    files = parse_pairs(pairs)
    session = session_for(before, rig=rig, wire=wire, speed=speed, settings=files)
    show_message(f"{run.name} ended with the cause: {before.cause.rstrip('.')}.")
    settings = read_launch_args(before, files)["settings"]
    cost = preview(str(before.info.protocol), session.file, settings, chooser=informed_choice)
    done = [s for s in before.steps if not s.void]
    done_s = sum(s.duration_s for s in done)
    live_context = live_view(
        live, session.file, session.source, settings, f"{run.name}, resumed", resumed=True
    )
    subject = Subject(session.wire, session.file.name, str(before.info.protocol), str(run))
    with (
        live_context as watchers,
        notified(notify, session.control, subject) as watch,
        session,
        keys(session.control) as listening,
    ):
        show_message("The rig was re-armed.")
        identity = {"wire": session.wire, "source": session.source}
        what = run_info(session.file, cost, run, **identity, done_steps=len(done), done_s=done_s)
        display = with_watchers(
            progress(what, session.control, quiet=quiet, keys=listening),
            [*watchers, *watch.listeners(what)],
        )
        with display as listener, resumable(session, run):
            plan = resume_in(
                session, before, listeners=[listener], expected=cost, chooser=informed_choice, settings=files
            )
    show_message(plan.sentence())
    how = {"start_over": plan.start_over, "how": plan.sentence(), "before": before.cause}
    with stored_run(run, verify=False) as after:
        print_warnings(after)
        emit(run_summary(after) | how, repr(after))
