"""``smarig characterise``: the main job."""

from contextlib import AbstractContextManager
from itertools import count
from pathlib import Path

import click

from smarig.cli._live import Live, joined, live_options, live_view
from smarig.cli._notify import notified, notify_option
from smarig.cli._output import emit, json_option, say
from smarig.cli._progress import STREAMS, progress
from smarig.cli._situation import about
from smarig.cli._types import FOLDER, RIG, SEED, Named
from smarig.config import load_campaign, load_rig
from smarig.rig.twin import TwinSettings
from smarig.runner.description import source_of
from smarig.runner.listener import Listener
from smarig.runner.preview import Preview


@click.command(
    "characterise",
    epilog=f"{STREAMS}\n\n\b\nExample:\n  smarig characterise --rig one_wire_twin --out out/one_wire",
)
@click.option("--rig", type=RIG, required=True, help="Rig by name or path.")
@click.option("--out", type=FOLDER, required=True, help="Folder for runs, model.json and report.html.")
@click.option(
    "--campaign",
    type=Named("campaigns"),
    default="characterise",
    show_default=True,
    help="What is run: by name or path.",
)
@click.option("--seed", type=SEED, default=0, show_default=True, help="Of the twin's noise.")
@click.option("--wire", default="", help="Identity of the wire, if not the rig file's.")
@click.option("--force", is_flag=True, help="Replace what is in the folder.")
@click.option(
    "--continue",
    "go_on",
    is_flag=True,
    help="Go on after an interruption: done runs are taken, others resumed.",
)
@live_options
@notify_option
@json_option
def command(
    rig: str,
    out: Path,
    campaign: str,
    seed: int,
    wire: str,
    force: bool,
    go_on: bool,
    notify: str,
    live: Live,
) -> None:
    """Initialise, test, identify, verify, diagnose and report: everything about one wire, in one folder."""
    from smarig.characterise import characterise

    number = count(1)

    file = load_rig(rig)
    source = source_of(file, TwinSettings(seed))

    def watching(cost: Preview) -> AbstractContextManager[Listener]:
        place = f"run {next(number)} of {len(load_campaign(campaign).step)}"
        shown = progress(about(file, cost, out, wire=wire or file.wire, source=source, place=place))
        return joined(shown, watchers)

    with live_view(live, file, source, {}, f"{campaign} on {file.name}") as watchers, notified(notify, out):
        done = characterise(
            rig,
            out,
            campaign=campaign,
            seed=seed,
            wire=wire,
            force=force,
            go_on=go_on,
            watching=watching,
            progress=say,
        )
    found = done.to_json()
    diagnosis = done.evidence.diagnosis
    emit(found, _text(found, diagnosis.text() if diagnosis else ""))


def _text(found: dict, diagnosis: str) -> str:
    lines = [*(r["verdict"] for r in found["representation"]), *found["discoveries"], *found["warnings"]]
    best = found["identify"]
    lines.append(
        f"Best surface: {found['surface']}, {best['rms']:.3g} {best['unit']} rms over {best['points']} points."
    )
    for name, verified in found["verify"].items():
        for run in verified["runs"]:
            lines.append(f"Validation with {name}: {run['rms']:.3g} {verified['unit']} rms, n = {run['n']}.")
    lines += [diagnosis] if diagnosis else []
    lines += [f"Report: {found['report']}", f"Model:  {found['model']}"]
    return "\n".join(lines)
