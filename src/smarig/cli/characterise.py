"""``smarig characterise``: the main job."""

from contextlib import contextmanager
from pathlib import Path

import click

from smarig.cli._notify import notified, notify_option
from smarig.cli._output import emit, json_option, json_wanted, say
from smarig.cli._progress import ProgressLine
from smarig.cli._types import FOLDER, RIG, Named


@click.command(
    "characterise", epilog="\b\nExample:\n  smarig characterise --rig one_wire_twin --out out/one_wire"
)
@click.option("--rig", type=RIG, required=True, help="Rig by name or path.")
@click.option("--out", type=FOLDER, required=True, help="Folder for runs, model.json and report.html.")
@click.option("--campaign", type=Named("campaigns"), default="characterise", show_default=True)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the twin's noise.")
@click.option("--wire", default="", help="Identity of the wire, if not the rig file's.")
@click.option("--force", is_flag=True, help="Replace what is in the folder.")
@notify_option
@json_option
def command(rig: str, out: Path, campaign: str, seed: int, wire: str, force: bool, notify: str) -> None:
    """Initialise, test, identify, verify, diagnose and report: everything about one wire, in one folder."""
    from smarig.characterise import characterise

    @contextmanager
    def watching(cost):
        with ProgressLine(cost, json_wanted()) as progress:
            yield progress
        say(cost.sentence())

    with notified(notify, out):
        done = characterise(
            rig, out, campaign=campaign, seed=seed, wire=wire, force=force, watching=watching, progress=say
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
