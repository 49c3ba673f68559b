"""``smarig resume``: go on with a run that was interrupted, as hysteresis allows."""

from pathlib import Path

import click

from smarig.cli._keys import keys
from smarig.cli._notify import notified, notify_option
from smarig.cli._output import emit, json_option, json_wanted, say
from smarig.cli._progress import ProgressLine
from smarig.cli._types import FILE, RIG
from smarig.cli.run import marked, summarised
from smarig.record import load_run

EPILOG = """\b
Examples:
  smarig resume fod.run.sqlite
  smarig resume fod.run.sqlite --rig my_rig.toml --notify 'mail -s "$SMARIG_CAUSE" me < /dev/null'
"""


@click.command("resume", epilog=EPILOG)
@click.argument("run", type=FILE)
@click.option("--rig", type=RIG, default="", help="The run's rig, if its file is elsewhere now.")
@click.option("--wire", default="", help="Identity of the wire: must be the run's.")
@click.option(
    "--speed", type=click.FloatRange(0, min_open=True), help="Twin: real time × SPEED (default: as it began)."
)
@click.option("--quiet", is_flag=True, help="No progress line.")
@notify_option
@json_option
def command(run: Path, rig: str, wire: str, speed: float | None, quiet: bool, notify: str) -> None:
    """Go on with a run that was killed, stopped or tripped, in the same file.

    The wire is cooled and taken back to what it remembered after the last finished step; the interrupted step is made
    again. Where that cannot be had, the protocol begins anew. Void steps stay in the record, marked.
    """
    from smarig.identification.adaptive import informed
    from smarig.runner.preview import preview
    from smarig.runner.resume import begun_with, resume_in, session_for

    before = load_run(run)
    session = session_for(before, rig=rig, wire=wire, speed=speed)
    say(f"{run.name} ended so: {before.cause.rstrip('.')}. The rig is armed again.")
    settings = begun_with(before)["settings"]
    cost = preview(str(before.meta["protocol"]), session.file, settings, chooser=informed)
    hands = keys(session.control, quiet=quiet or json_wanted())
    with notified(notify, run), session, hands, ProgressLine(cost, quiet) as progress:
        plan = resume_in(session, before, listeners=[progress], expected=cost, chooser=informed)
    after = load_run(run)
    say(plan.sentence())
    for warning in marked(after):
        say(f"Warning: {warning}")
    found = summarised(after)
    emit(found | {"start_over": plan.start_over, "how": plan.sentence(), "before": before.cause}, repr(after))
