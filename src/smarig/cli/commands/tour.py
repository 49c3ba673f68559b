"""``smarig tour``: the hidden fault of a twin is measured, found and revealed, by the commands anyone would use."""

import json
from pathlib import Path

import click

from smarig.cli.output import emit, json_option, json_requested, within_another
from smarig.cli.parameter_types import FOLDER, SEED

RIG = "mystery"
CAMPAIGN = """\
name = "hunt"
summary = "Reversal curves to fit, and a validation run that no fit sees."

[[step]]
protocol = "first_order_descending"
purpose = "train"

[[step]]
protocol = "validation"
purpose = "held_out"
set = { points = 20 }
"""
STEPS = (
    (
        "Measure: reversal curves, and a validation run that no fit will see. They take the twin an hour and a half.",
        "run {out}/hunt.toml --rig {rig} --seed {seed} -o {out}/runs --quiet",
    ),
    (
        "Model: a Preisach model is fitted to the reversal curves.",
        "identify {out}/runs/01_first_order_descending.run.sqlite --surface positive -o {out}/model.json",
    ),
    (
        "Verify: how well does it predict the other run?",
        "verify {out}/model.json {out}/runs/02_validation.run.sqlite",
    ),
    (
        "Diagnose: which effect, added to the model, predicts what was left out of the fit?",
        "diagnose {out}/model.json --train {out}/runs/01_first_order_descending.run.sqlite "
        "--held-out {out}/runs/02_validation.run.sqlite -o {out}/diagnosis",
    ),
)
NEXT = """\
Open {out}/diagnosis/report.html in a browser: it shows where the model was wrong, and what the cause explains.

Next:
  smarig tour --seed {next_seed} -o {out}_{next_seed}    another fault, or none
  smarig characterise --rig one_wire_twin --out out/one_wire    the whole job on a sound wire
  smarig study FILE…    your own data
"""


@click.command(
    "tour",
    short_help="Find the hidden fault of a twin, step by step.",
    epilog="\b\nExample:\n  smarig tour --seed 7 -o out/tour",
)
@click.option(
    "-o", "--out", type=FOLDER, default="tour", show_default=True, help="Folder for runs, model and pages."
)
@click.option(
    "--seed", type=SEED, default=22, show_default=True, help="Which fault is hidden; some seeds hide none."
)
@json_option
def command(out: Path, seed: int) -> None:
    """Find a hidden fault in a minute: measure a twin, model it, diagnose it, and see what was hidden.

    The rig 'mystery' is a twin with one effect of the catalogue, or none. Each step shows the command that does it.
    """
    from smarig.config import load_rig
    from smarig.core import atomic_file
    from smarig.plant import Actuator, mystery_effects

    out.mkdir(parents=True, exist_ok=True)
    with atomic_file(out / "hunt.toml", force=False) as part:
        part.write_text(CAMPAIGN, encoding="utf-8")
    for number, (title, line) in enumerate(STEPS, start=1):
        _carry_out(f"{number}. {title}", line, out, seed)
    arrangement = Actuator.named(load_rig(RIG).actuator).file.arrangement
    hidden = [repr(effect) for effect in mystery_effects(seed, arrangement)]
    found = json.loads((out / "diagnosis" / "diagnosis.json").read_text(encoding="utf-8"))
    outcome = _outcome([name.partition("(")[0] for name in hidden], found["verdict"], found["set"])
    result = {
        "out": str(out),
        "seed": seed,
        "hidden": hidden,
        "verdict": found["verdict"],
        "set": found["set"],
    }
    revealed = f"5. Reveal: the twin hid {', '.join(hidden) or 'nothing'}. {outcome}"
    emit(result, f"\n{revealed}\n\n{NEXT.format(out=out, next_seed=seed + 1)}")


def _carry_out(title: str, line: str, out: Path, seed: int) -> None:
    """Show a step with its command, and run it."""
    from smarig.cli import cli

    if not json_requested():
        shown = line.format(out=out, rig=RIG, seed=seed).replace(" --quiet", "")
        emit({}, f"\n{title}\n$ smarig {shown}\n")
    with within_another():
        words = [word.format(out=out, rig=RIG, seed=seed) for word in line.split()]
        cli.main(args=words, prog_name="smarig", standalone_mode=False)


def _outcome(hidden: list[str], verdict: str, names: list[str]) -> str:
    """Whether the diagnosis was right."""
    if verdict == "named" and names == hidden:
        return "The diagnosis named it."
    if not hidden and verdict in ("silent", "not_identifiable"):
        return "The diagnosis found nothing, rightly."
    if set(hidden) & set(names):
        return f"The diagnosis has it in its set: {', '.join(names)}."
    if verdict in ("silent", "not_identifiable"):
        return "The diagnosis found nothing: a free density imitates this effect, or it is smaller than the noise."
    if verdict == "unknown":
        return "The diagnosis found that something is wrong, and gave it no name."
    return f"The diagnosis named {', '.join(names)}, wrongly."
