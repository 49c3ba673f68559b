"""``smarig run``: run a protocol into one run file, or a campaign into a folder of run files."""

from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from smarig.cli.output import emit, json_option, show_message
from smarig.cli.parameter_types import ANY_PATH, EXPERIMENT
from smarig.cli.progress import STREAMS, preview_progress
from smarig.cli.run_options import (
    RunOptions,
    check_target,
    emit_previews,
    print_warnings,
    resumable,
    run_options,
    run_summary,
)
from smarig.core import (
    UsageError,
    catalogue_names,
    is_file,
    offered_names,
    shown,
    suggestion,
    swapped_file,
)

if TYPE_CHECKING:
    from smarig.config import CampaignFile, CampaignStep
    from smarig.runner import Listener, Preview, Session

EPILOG = f"""{STREAMS}

\b
Examples:
  smarig run first_order_descending --rig one_wire_twin -o fod.run.sqlite --seed 1
  smarig run characterise --rig two_wire_twin -o runs/ --dry-run
  smarig run congruency --rig one_wire_twin -o c.run.sqlite --effect settling=3 --effect creep
  smarig run validation --rig one_wire_twin -o v.run.sqlite --set points=20 --set settle.band_counts=2
  smarig run ./my_protocol.py --rig ./my_rig.toml -o mine.run.sqlite
"""


@click.command("run", short_help="Run a protocol or a campaign on a rig.", epilog=EPILOG)
@click.argument("experiment", type=EXPERIMENT, metavar="PROTOCOL|CAMPAIGN")
@click.option("-o", "--out", type=ANY_PATH, help="Run file, or folder for a campaign.")
@click.option(
    "--set", "pairs", multiple=True, metavar="KEY=VALUE", help="A setting of the protocol; repeatable."
)
@click.option(
    "--continue",
    "go_on",
    is_flag=True,
    help="Continue after an interruption: keep finished runs and resume the others.",
)
@run_options
@json_option
def command(
    experiment: str, out: Path | None, pairs: tuple[str, ...], go_on: bool, options: RunOptions
) -> None:
    """Run a protocol or a campaign, by name or by the path of your own file, on a rig and record it."""
    from smarig.identification import informed_choice
    from smarig.protocols import parse_pairs
    from smarig.record import stored_run
    from smarig.runner import preview

    session = options.session()
    plan = _plan(experiment, parse_pairs(pairs))
    steps = plan.step
    file = session.file
    report = preview_progress(quiet=options.quiet)
    costs = [preview(s.protocol, file, s.set, chooser=informed_choice, report=report) for s in steps]
    if options.dry_run:
        emit_previews(costs)
        return
    if out is None:
        raise UsageError("Give a run file with -o (a folder for a campaign), or --dry-run.")
    single = experiment in catalogue_names("smarig.protocols")
    targets = [out] if single else plan.run_files(out)
    if options.force and go_on:
        raise UsageError("--force replaces runs and --continue continues them. Give only one of them.")
    for target in targets:
        check_target(target, force=options.force or go_on, remedy=" --continue to continue it,")
    with options.open_session(session, steps[0].set, experiment) as display:
        for k, (step, target, cost) in enumerate(zip(steps, targets, costs, strict=True), start=1):
            place = f"run {k} of {len(steps)}" if len(steps) > 1 else ""
            run_display = display(target, cost, place)
            _run_one(session, step, target, cost, run_display, force=options.force, notes=options.notes)
    summaries, lines = [], []
    for target in targets:
        with stored_run(target, verify=False) as run:
            print_warnings(run)
            summaries.append(run_summary(run))
            lines.append(repr(run))
    emit({"runs": summaries}, "\n".join(lines))


def _run_one(
    session: "Session",
    step: "CampaignStep",
    out: Path,
    cost: "Preview",
    display: "AbstractContextManager[Listener]",
    *,
    force: bool,
    notes: str,
) -> None:
    from smarig.identification import informed_choice
    from smarig.runner import run_or_resume

    with display as listener, resumable(session, out):
        message = run_or_resume(
            session,
            step.protocol,
            step.set,
            out,
            listeners=[listener],
            force=force,
            notes=notes,
            expected=cost,
            chooser=informed_choice,
        )
    if message:
        show_message(message)


def _plan(experiment: str, settings: dict) -> "CampaignFile":
    """The campaign. A single protocol becomes a campaign of one step."""
    from smarig.config import CampaignFile, CampaignStep, load_campaign, shipped_names
    from smarig.protocols import refuse_closed_loops, with_loaded_protocols

    protocols, campaigns = catalogue_names("smarig.protocols"), shipped_names("campaigns")
    if experiment in protocols:
        return CampaignFile(
            name=experiment, summary="", step=(CampaignStep(protocol=experiment, set=settings),)
        )
    refuse_closed_loops(experiment)
    if experiment not in campaigns and not experiment.endswith(".toml"):
        known = [*protocols, *offered_names("smarig.protocols"), *campaigns]
        raise UsageError(
            _other_file(Path(experiment))
            or f"No protocol or campaign {shown(experiment)}{suggestion(experiment, known)}."
        )
    if settings:
        raise UsageError("--set applies to a single protocol only. Set the values of a campaign in its file.")
    return with_loaded_protocols(load_campaign(experiment))


def _other_file(path: Path) -> str:
    """A sentence on an existing file that is neither a protocol nor a campaign; "" if there is no such file."""
    if not is_file(path):
        return ""
    unknown = f"{path} is neither a protocol (NAME.py) nor a campaign (NAME.toml)."
    return swapped_file(path, "a protocol or campaign") or unknown
