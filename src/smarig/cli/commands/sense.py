"""``smarig sense``: identify the position from the resistance, or verify it on runs."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from smarig.cli.output import check_distinct, emit, json_option
from smarig.cli.parameter_types import FILE
from smarig.core import MODEL, check_writable

EPILOG = """\b
Examples:
  smarig sense wire.model.json fod.run.sqlite validation.run.sqlite -o sensing.model.json
  smarig sense sensing.model.json held_out.run.sqlite
"""


@click.command("sense", short_help="Identify the position from the resistance of the wire.", epilog=EPILOG)
@click.argument("model", type=FILE)
@click.argument("runs", nargs=-1, required=True, type=FILE)
@click.option("-o", "--out", type=FILE, help="New model file: identify from the runs. Without it: verify.")
@click.option("--force", is_flag=True, help="Replace an existing model file.")
@json_option
def command(model: Path, runs: tuple[Path, ...], out: Path | None, force: bool) -> None:
    """Identify the resistance of each wire as a function of position and temperature, for an observer of position.

    With -o, the runs teach the map, and the new model file holds it. Use at least one run that the hysteresis was not
    fitted to: it shows the errors of the prediction. Without -o, the observer of the model file is run along the runs,
    and its position is compared with the encoder's.
    """
    from smarig.control import SelfSensing
    from smarig.identification import identify_sensing, sensing_errors, sensing_text
    from smarig.record import load_run
    from smarig.replay import load_model

    known = load_model(model)
    loaded = [load_run(run) for run in runs]
    if out is None:
        errors = sensing_errors(known, loaded)
        sensing = SelfSensing.from_json(known.self_sensing)
    else:
        check_distinct(out, model, *runs)
        check_writable(out, force=force, kind=MODEL)
        sensing, errors = identify_sensing(known, loaded)
        replace(known, self_sensing=sensing.to_json()).save(out, force=force)
    found: dict[str, Any] = {"self_sensing": sensing.to_json(), "runs": [e.to_json() for e in errors]}
    lines = [*sensing_text(sensing, known.unit), *(e.text for e in errors)]
    if out is not None:
        found["model"] = str(out)
        lines.append(f"Model: {out}. Verify it on runs that it has not seen.")
    emit(found, "\n".join(lines))
