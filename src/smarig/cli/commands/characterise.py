"""``smarig characterise``: initialise, test, identify, verify, diagnose and report in one command."""

from contextlib import AbstractContextManager
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

import click

from smarig.cli.live_options import LiveOptions, live_options, live_view, with_watchers
from smarig.cli.notifier import Subject
from smarig.cli.notify import NotifyOptions, notified, notify_option
from smarig.cli.output import emit, json_option, show_message
from smarig.cli.parameter_types import FOLDER, RIG, SEED, CatalogueName
from smarig.cli.progress import STREAMS, progress
from smarig.cli.run_options import effect_option, emit_previews, injected_effects

if TYPE_CHECKING:
    from smarig.runner import Listener, Preview

NEXT = """
Open {report} in a browser. Next:
  smarig tour    find the hidden fault of a twin in a minute
  smarig track {model} --reference ramps --rig one_wire_twin -o ramps.run.sqlite    the model in closed loop
  smarig study FILE…    your own data"""


@click.command(
    "characterise",
    short_help="Do the whole job: experiments, model, diagnosis, report.",
    epilog=f"{STREAMS}\n\n\b\nExample:\n  smarig characterise --rig one_wire_twin --out out/one_wire",
)
@click.option("--rig", type=RIG, required=True, help="Rig by name or path.")
@click.option(
    "-o",
    "--out",
    type=FOLDER,
    required=True,
    help="Folder for runs, model and pages.",
)
@click.option(
    "--campaign",
    type=CatalogueName("campaigns"),
    default="characterise",
    show_default=True,
    help="Campaign to run, by name or path.",
)
@effect_option
@click.option("--seed", type=SEED, default=0, show_default=True, help="Seed of the twin's noise.")
@click.option("--wire", default="", help="Identity of the wire (default: that of the rig file).")
@click.option("--dry-run", is_flag=True, help="Only print the preview: duration and range.")
@click.option("--force", is_flag=True, help="Replace the files in the folder.")
@click.option(
    "--continue",
    "go_on",
    is_flag=True,
    help="Continue after an interruption: keep finished runs and resume the others.",
)
@click.option("--quiet", is_flag=True, help="Show no panel, no log lines and no progress.")
@live_options
@notify_option
@json_option
def command(
    rig: str,
    out: Path,
    campaign: str,
    effects: tuple[str, ...],
    seed: int,
    wire: str,
    dry_run: bool,
    force: bool,
    go_on: bool,
    quiet: bool,
    notify: NotifyOptions,
    live: LiveOptions,
) -> None:
    """Initialise, test, identify, verify, diagnose and report: everything about one wire, in one folder."""
    from smarig.app import campaign_previews, characterise
    from smarig.config import load_campaign, load_rig
    from smarig.rig import TwinSettings
    from smarig.runner import RunControl, twin_source
    from smarig.running import run_info

    run_number, control = count(1), RunControl()
    file = load_rig(rig)
    twin = TwinSettings(seed, effects=injected_effects(effects, quiet=quiet or dry_run))
    source = twin_source(file, twin)
    if dry_run:
        emit_previews(campaign_previews(rig, campaign))
        return

    def listener_factory(cost: "Preview", run: Path) -> "AbstractContextManager[Listener]":
        place = f"run {next(run_number)} of {len(load_campaign(campaign).step)}"
        what_runs = run_info(file, cost, run, wire=wire or file.wire, source=source, place=place)
        return with_watchers(
            progress(what_runs, control, quiet=quiet), [*watchers, *watch.listeners(what_runs)]
        )

    title, subject = f"{campaign} on {file.name}", Subject(wire or file.wire, file.name, campaign, str(out))
    with live_view(live, file, source, {}, title) as watchers, notified(notify, control, subject) as watch:
        done = characterise(
            rig,
            out,
            campaign=campaign,
            effects=effects,
            seed=seed,
            wire=wire,
            force=force,
            go_on=go_on,
            control=control,
            listener_factory=listener_factory,
            progress=None if quiet else show_message,
        )
    found = done.to_json()
    unit = found["identify"]["unit"]
    for run in found["verify"].get(found["surface"], {}).get("runs", ()):
        if run["verdict"] == "poor":
            show_message(
                f"Warning: The model does not predict {run['run']}: {run['rms']:.3g} {unit} rms error."
            )
    diagnosis = done.evidence.diagnosis
    emit(found, _text(found, diagnosis.text() if diagnosis else ""))


def _text(found: dict, diagnosis: str) -> str:
    lines = [*(r["verdict"] for r in found["representation"]), *found["discoveries"], *found["warnings"]]
    best = found["identify"]
    lines.append(
        f"Best surface: {found['surface']}, {best['rms']:.3g} {best['unit']} rms error over {best['points']} points."
    )
    for name, verified in found["verify"].items():
        for run in verified["runs"]:
            lines.append(
                f"Validation with {name}: {run['rms']:.3g} {verified['unit']} rms error, n = {run['n']}: "
                f"{run['verdict']}."
            )
    lines += [diagnosis] if diagnosis else []
    lines += found["preisach"]["sentences"]
    lines += [f"Report: {found['report']}", f"Model:  {found['model']}"]
    lines += [NEXT.format(report=found["report"], model=found["model"])]
    return "\n".join(lines)
