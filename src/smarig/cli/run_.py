"""``smarig run``: a protocol into one run file, or a campaign into a folder of them."""

from contextlib import AbstractContextManager
from pathlib import Path

import click

from smarig.catalogue import names, suggestion
from smarig.cli._keys import keys
from smarig.cli._live import Live, joined, live_options, live_view
from smarig.cli._notify import notified, notify_option
from smarig.cli._output import emit, json_option, say
from smarig.cli._progress import STREAMS, progress
from smarig.cli._situation import about
from smarig.cli._types import ANY_PATH, EXPERIMENT, RIG, SEED
from smarig.config import CampaignFile, CampaignStep, listed, load_campaign, load_rig
from smarig.errors import UsageError
from smarig.model.planted import asked_for
from smarig.protocols._settings import chosen_steps, parse_pairs
from smarig.record import Run, load_run
from smarig.rig.twin import TwinSettings
from smarig.runner.go_on import run_or_go_on
from smarig.runner.listener import Listener
from smarig.runner.preview import Preview, preview
from smarig.runner.session import Session
from smarig.sample import Quality

EPILOG = f"""{STREAMS}

\b
Examples:
  smarig run first_order_descending --rig one_wire_twin -o fod.run.sqlite --seed 1
  smarig run characterise --rig two_wire_twin -o runs/ --dry-run
  smarig run congruency --rig one_wire_twin -o c.run.sqlite --effect settling=3 --effect creep
  smarig run validation --rig one_wire_twin -o v.run.sqlite --set points=20 --set settle.band_counts=2
  smarig run ./my_protocol.py --rig ./my_rig.toml -o mine.run.sqlite
"""


@click.command("run", epilog=EPILOG)
@click.argument("experiment", type=EXPERIMENT, metavar="PROTOCOL|CAMPAIGN")
@click.option("--rig", type=RIG, required=True, help="Rig by name or path.")
@click.option("-o", "--out", type=ANY_PATH, help="Run file; for a campaign a folder.")
@click.option(
    "--set", "pairs", multiple=True, metavar="KEY=VALUE", help="A setting of the protocol; repeatable."
)
@click.option(
    "--effect",
    "effects",
    multiple=True,
    metavar="NAME[.PARAMETER]=VALUE",
    help="Twin: plant an effect (see 'smarig list effects'), or one of your own: ./FILE.py=3; repeatable.",
)
@click.option("--seed", type=SEED, default=0, show_default=True, help="Of the twin's noise.")
@click.option(
    "--speed", type=click.FloatRange(0, min_open=True), help="Twin: real time × SPEED (default: free)."
)
@click.option("--wire", default="", help="Identity of the wire, if not the rig file's.")
@click.option("--notes", default="", help="A remark kept with the run.")
@click.option("--dry-run", is_flag=True, help="Only say what it would cost.")
@click.option("--force", is_flag=True, help="Replace existing run files.")
@click.option(
    "--continue",
    "go_on",
    is_flag=True,
    help="Go on with what was interrupted: done runs are left, others resumed.",
)
@click.option("--quiet", is_flag=True, help="No panel, no lines.")
@live_options
@notify_option
@json_option
def command(
    experiment: str,
    rig: str,
    out: Path | None,
    pairs: tuple[str, ...],
    effects: tuple[str, ...],
    seed: int,
    speed: float | None,
    wire: str,
    notes: str,
    dry_run: bool,
    force: bool,
    go_on: bool,
    quiet: bool,
    notify: str,
    live: Live,
) -> None:
    """Run a protocol or a campaign on a rig and record it; by name, or your own by its path."""
    from smarig.identification.adaptive import informed

    planted = asked_for(effects)
    plan = _plan(experiment, parse_pairs(pairs))
    steps = plan.step
    file = load_rig(rig)
    costs = [preview(s.protocol, file, s.set, chooser=informed) for s in steps]
    if dry_run:
        lines = [c.sentence() for c in costs] + [f"total: {sum(c.duration_s for c in costs) / 3600:.2f} h"]
        emit({"preview": [c.__dict__ for c in costs]}, "\n".join(lines))
        return
    if out is None:
        raise UsageError("Give a run file with -o (a folder for a campaign), or --dry-run.")
    single = experiment in names("smarig.protocols")
    targets = [out] if single else plan.run_files(out)
    if force and go_on:
        raise UsageError("--force replaces runs, --continue goes on with them: give one of the two.")
    for target in targets:
        if target.exists() and not (force or go_on):
            raise UsageError(
                f"{target} exists; give another name, --continue to go on with it, or --force to replace it."
            )
    twin = TwinSettings(seed=seed, effects=planted)
    session = Session(rig, twin=twin, speed=speed, wire=wire)
    watching = live_view(
        live, session.file, session.source, steps[0].set, f"{experiment} on {session.file.name}"
    )
    with watching as watchers, notified(notify) as told, session, keys(session.control) as listening:
        for k, (step, target, cost) in enumerate(zip(steps, targets, costs, strict=True), start=1):
            told.run = target
            place = f"run {k} of {len(steps)}" if len(steps) > 1 else ""
            what = about(session.file, cost, target, wire=session.wire, source=session.source, place=place)
            shown = progress(what, session.control, quiet=quiet, keys=listening)
            _run_one(session, step, target, cost, joined(shown, watchers), force=force, notes=notes)
    runs = [load_run(t) for t in targets]
    for warning in (w for r in runs for w in marked(r)):
        say(f"Warning: {warning}")
    emit({"runs": [summarised(r) for r in runs]}, "\n".join(repr(r) for r in runs))


def _run_one(
    session: Session,
    step: CampaignStep,
    out: Path,
    cost: Preview,
    shown: AbstractContextManager[Listener],
    *,
    force: bool,
    notes: str,
) -> None:
    from smarig.identification.adaptive import informed

    with shown as listener:
        said = run_or_go_on(
            session,
            step.protocol,
            step.set,
            out,
            listeners=[listener],
            force=force,
            notes=notes,
            expected=cost,
            chooser=informed,
        )
    if said:
        say(said)


def _plan(experiment: str, settings: dict) -> CampaignFile:
    """A campaign; a protocol is one of a single step."""
    protocols, campaigns = names("smarig.protocols"), listed("campaigns")
    if experiment in protocols:
        return CampaignFile(
            name=experiment, summary="", step=(CampaignStep(protocol=experiment, set=settings),)
        )
    if experiment not in campaigns and not experiment.endswith(".toml"):
        raise UsageError(
            f"No protocol or campaign '{experiment}'{suggestion(experiment, protocols + campaigns)}."
        )
    if settings:
        raise UsageError("--set belongs to a single protocol; a campaign's settings stand in its file.")
    return chosen_steps(load_campaign(experiment))


def marked(run: Run) -> list[str]:
    """Honest numbers: what a person must know although the run is done."""
    late = sum(s.verdict == "timed_out" for s in run.steps)
    saturated = int(((run["quality"].astype(int) & Quality.SATURATED) > 0).sum())
    found = [f"{run.path.name}: {late} of {len(run.steps)} holds did not settle in time."] if late else []
    return found + ([f"{run.path.name}: {saturated} samples were saturated."] if saturated else [])


def summarised(run: Run) -> dict:
    """A run for --json."""
    return {
        "run": str(run.path),
        "protocol": run.meta["protocol"],
        "samples": len(run),
        "steps": len(run.steps),
        "void": sum(s.void for s in run.steps),
        "timed_out": sum(s.verdict == "timed_out" for s in run.steps),
        "warnings": marked(run),
        "cause": run.cause,
    }
