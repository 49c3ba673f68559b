"""``smarig view``: show a recorded run in the viewer, with predictions of models."""

from pathlib import Path

import click

from smarig.cli.live_options import legend_name
from smarig.cli.output import check_distinct, emit, json_option, show_message
from smarig.cli.parameter_types import FILE, FiniteNumber, own_effects
from smarig.core import UsageError

EPILOG = """\b
Examples:
  smarig view validation.run.sqlite
  smarig view validation.run.sqlite --model base.model.json --model extended.model.json --web
  smarig view validation.run.sqlite --speed 20
  smarig view validation.run.sqlite --save validation.rrd
"""


@click.command("view", epilog=EPILOG)
@click.argument("run", type=FILE)
@click.option(
    "--model", "models", multiple=True, type=FILE, help="Model whose predictions are shown; repeatable."
)
@click.option("--web", is_flag=True, help="Show the view in a browser, on this machine only.")
@click.option(
    "--speed", type=FiniteNumber(0), default=0.0, show_default=True, help="Real time × SPEED; 0: all at once."
)
@click.option("--save", "out", type=FILE, help="Write the view to FILE.rrd instead of showing it.")
@click.option("--force", is_flag=True, help="Replace an existing file.")
@own_effects
@json_option
def command(
    run: Path, models: tuple[Path, ...], web: bool, speed: float, out: Path | None, force: bool
) -> None:
    """Show a run, all at once or at a chosen speed. A run that is still being recorded is shown as far as it has been
    written.

    Needs the extra 'live'. Ending this command also closes the viewer.
    """
    from smarig.core import atomic_file
    from smarig.live import save_recording, view_run
    from smarig.record import load_run
    from smarig.replay import NamedPredictor, PrecomputedPredictor, check_output, load_model, simulate_samples

    _check(out, web, speed)
    recorded = load_run(run)
    loaded = [(legend_name(path), load_model(path)) for path in models]
    predictions = []
    for name, model in loaded:
        check_output(model, recorded)
        predictions.append(NamedPredictor(name, PrecomputedPredictor(simulate_samples(model, recorded))))
    hysteresis = loaded[0][1].hysteresis if loaded else None
    if out is not None:
        check_distinct(out, run, *models)
        with atomic_file(out, force=force) as part:
            save_recording(recorded, part, predictions, hysteresis)
    else:
        view_run(recorded, predictions, hysteresis, web=web, speed=speed, show_message=show_message)
    found = {
        "run": str(run),
        "samples": len(recorded),
        "models": [n for n, _ in loaded],
        "file": out and str(out),
    }
    emit(found, f"{out}: {len(recorded)} samples." if out else "")


def _check(out: Path | None, web: bool, speed: float) -> None:
    """Raise UsageError if the options do not fit together or the name is not a recording's."""
    if out is None:
        return
    if web or speed:
        ignored_option = "--web" if web else "--speed"
        raise UsageError(f"--save writes the view instead of showing it. Leave {ignored_option} out.")
    if out.suffix.lower() != ".rrd":
        raise UsageError(f"Rerun opens only recordings named FILE.rrd. Rename {out} to {out}.rrd.")
