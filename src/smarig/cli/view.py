"""``smarig view``: a recorded run in the viewer, with models beside it."""

from pathlib import Path

import click

from smarig.cli._live import named
from smarig.cli._output import distinct, emit, json_option, say
from smarig.cli._types import FILE, Finite, own_effects
from smarig.errors import UsageError

EPILOG = """\b
Examples:
  smarig view validation.run.sqlite
  smarig view validation.run.sqlite --model base.model.json --model extended.model.json --web
  smarig view validation.run.sqlite --speed 20
  smarig view validation.run.sqlite --save validation.rrd
"""


@click.command("view", epilog=EPILOG)
@click.argument("run", type=FILE)
@click.option("--model", "models", multiple=True, type=FILE, help="Model that predicts; repeatable.")
@click.option("--web", is_flag=True, help="In a browser, on this machine only.")
@click.option(
    "--speed", type=Finite(0), default=0.0, show_default=True, help="Real time × SPEED; 0: at once."
)
@click.option("--save", "out", type=FILE, help="Write the view into FILE.rrd instead of showing it.")
@click.option("--force", is_flag=True, help="Replace an existing file.")
@own_effects
@json_option
def command(
    run: Path, models: tuple[Path, ...], web: bool, speed: float, out: Path | None, force: bool
) -> None:
    """Show a run, finished or still being recorded (as far as it has come): at once, or at a speed.

    Needs the extra 'live'. The viewer ends with this command.
    """
    from smarig.identification.model_file import load_model
    from smarig.identification.simulate import check_output, simulate_along
    from smarig.live.predicted import Prediction, Told
    from smarig.live.showing import save, view
    from smarig.record import load_run
    from smarig.whole_file import whole_file

    _check(out, web, speed)
    recorded = load_run(run)
    loaded = [(named(path), load_model(path)) for path in models]
    predictions = []
    for name, model in loaded:
        check_output(model, recorded)
        predictions.append(Prediction(name, Told(simulate_along(model, recorded))))
    hysteresis = loaded[0][1].hysteresis if loaded else None
    if out is not None:
        distinct(out, run, *models)
        with whole_file(out, force=force) as part:
            save(recorded, part, predictions, hysteresis)
    else:
        view(recorded, predictions, hysteresis, web=web, speed=speed, say=say)
    found = {
        "run": str(run),
        "samples": len(recorded),
        "models": [n for n, _ in loaded],
        "file": out and str(out),
    }
    emit(found, f"{out}: {len(recorded)} samples." if out else "")


def _check(out: Path | None, web: bool, speed: float) -> None:
    """UsageError where --save could not be meant as it stands."""
    if out is None:
        return
    if web or speed:
        unheard = "--web" if web else "--speed"
        raise UsageError(
            f"--save writes the view instead of showing it, so {unheard} has no meaning: leave one out."
        )
    if out.suffix.lower() != ".rrd":
        raise UsageError(f"{out}: Rerun opens recordings that are called FILE.rrd; call it {out}.rrd.")
