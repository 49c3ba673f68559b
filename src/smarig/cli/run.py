"""``smarig run``: a protocol into one run file, or a campaign into a folder of them."""

from pathlib import Path

import click

from smarig.catalogue import names, suggestion
from smarig.cli._keys import keys
from smarig.cli._notify import notified, notify_option
from smarig.cli._output import emit, json_option, json_wanted, say
from smarig.cli._progress import ProgressLine
from smarig.cli._types import ANY_PATH, EXPERIMENT, RIG
from smarig.config import CampaignFile, CampaignStep, listed, load_campaign, load_rig
from smarig.errors import UsageError
from smarig.model.planted import from_pairs
from smarig.protocols._settings import parse_pairs
from smarig.record import Run, load_run
from smarig.rig.twin import TwinSettings
from smarig.runner.preview import Preview, preview
from smarig.runner.session import Session
from smarig.sample import Quality

EPILOG = """\b
Examples:
  smarig run first_order_descending --rig one_wire_twin -o fod.run.sqlite --seed 1
  smarig run characterise --rig two_wire_twin -o runs/ --dry-run
  smarig run congruency --rig one_wire_twin -o c.run.sqlite --effect settling=3 --effect creep
  smarig run validation --rig one_wire_twin -o v.run.sqlite --set points=20 --set settle.band_counts=2
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
    help="Twin: plant an effect (see 'smarig list effects'); repeatable.",
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the twin's noise.")
@click.option(
    "--speed", type=click.FloatRange(0, min_open=True), help="Twin: real time × SPEED (default: free)."
)
@click.option("--wire", default="", help="Identity of the wire, if not the rig file's.")
@click.option("--notes", default="", help="A remark kept with the run.")
@click.option("--dry-run", is_flag=True, help="Only say what it would cost.")
@click.option("--force", is_flag=True, help="Replace existing run files.")
@click.option("--quiet", is_flag=True, help="No progress line.")
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
    quiet: bool,
    notify: str,
) -> None:
    """Run a protocol or a campaign on a rig and record it."""
    from smarig.identification.adaptive import informed

    planted = from_pairs(effects)
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
    for target in targets:
        if target.exists() and not force:
            raise UsageError(f"{target} exists; give another name or --force to replace it.")
    twin = TwinSettings(seed=seed, effects=planted)
    session = Session(rig, twin=twin, speed=speed, wire=wire)
    with notified(notify) as told, session, keys(session.control, quiet=quiet or json_wanted()):
        for step, target, cost in zip(steps, targets, costs, strict=True):
            told.run = target
            _run_one(session, step, target, cost, quiet=quiet, force=force, notes=notes)
    runs = [load_run(t) for t in targets]
    for warning in (w for r in runs for w in marked(r)):
        say(f"Warning: {warning}")
    emit({"runs": [summarised(r) for r in runs]}, "\n".join(repr(r) for r in runs))


def _run_one(
    session: Session, step: CampaignStep, out: Path, cost: Preview, *, quiet: bool, force: bool, notes: str
) -> None:
    from smarig.identification.adaptive import informed

    with ProgressLine(cost, quiet) as progress:
        session.run(
            step.protocol,
            step.set,
            out,
            listeners=[progress],
            force=force,
            notes=notes,
            expected=cost,
            chooser=informed,
        )
    say(f"{step.protocol}: {out}")


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
    return load_campaign(experiment)


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
