"""``smarig regulate``: hold a set-point from the state that is least sensitive to disturbances."""

from pathlib import Path

import click

from smarig.cli.closed_loop_run import run_closed_loop
from smarig.cli.output import json_option, show_message
from smarig.cli.parameter_types import FILE
from smarig.cli.progress import STREAMS
from smarig.cli.run_options import RunOptions, run_options

EPILOG = f"""{STREAMS}

\b
Examples:
  smarig regulate wire.model.json --setpoint 6 --rig one_wire_twin -o held.run.sqlite
  smarig regulate wire.model.json --setpoint 6 --start ascending --disturbance-K 5 --rig one_wire_twin -o b.run.sqlite
  smarig regulate sensing.model.json --setpoint 6 --feedback resistance --rig one_wire_twin -o r.run.sqlite
"""


@click.command("regulate", short_help="Hold a set-point in closed loop (thesis §8.3).", epilog=EPILOG)
@click.argument("model", type=FILE)
@click.option(
    "--setpoint",
    type=float,
    required=True,
    help="Output to hold, in the rig's unit, counted from the zero of the model.",
)
@click.option("-o", "--out", type=FILE, help="Run file.")
@click.option(
    "--within",
    type=float,
    default=0.01,
    show_default=True,
    help="Accepted distance from B_ℓ, as a share of the area of the Preisach plane.",
)
@click.option(
    "--hold-s", type=float, default=600.0, show_default=True, help="Duration of the closed loop, s."
)
@click.option(
    "--start",
    type=click.Choice(["diagonal", "ascending", "descending"]),
    default="diagonal",
    show_default=True,
    help="Initial state of the loop: B_ℓ, or a state on an outer branch.",
)
@click.option(
    "--disturbance-K",
    "push",
    type=float,
    default=0.0,
    help="Height, in K, of a pulse on the control input after 60 s; it lasts 4 τ.",
)
@click.option(
    "--controller",
    default="pi",
    show_default=True,
    help="Controller that holds the set-point: pi, or integral with a certified gain.",
)
@click.option(
    "--controller-set",
    "numbers",
    multiple=True,
    metavar="KEY=VALUE",
    help="Parameter of the controller, such as gain; smarig list controllers --settings explains them; repeatable.",
)
@click.option(
    "--feedback",
    type=click.Choice(["encoder", "resistance"]),
    default="encoder",
    show_default=True,
    help="Source of the position; resistance: from voltage and current, for a model with self-sensing.",
)
@run_options
@json_option
def command(
    model: Path,
    setpoint: float,
    out: Path | None,
    within: float,
    hold_s: float,
    start: str,
    push: float,
    controller: str,
    numbers: tuple[str, ...],
    feedback: str,
    options: RunOptions,
) -> None:
    """Bring the wire to the state B_ℓ of the set-point (thesis §8.3), close a loop with a small gain, and
    hold.

    The encoder is relative, so the wire first goes to negative saturation. The position measured there
    counts as the model's least output. The input path to B_ℓ accounts for the wire's thermal lag.
    """
    from smarig.app import ModelSource, regulation
    from smarig.protocols import parse_pairs

    source = ModelSource.of(model)
    if source.model.effects:
        show_message(f"{model.name} has effects. The path to B_ℓ is planned from its hysteresis alone.")
    loop = regulation(
        source,
        options.rig_file(),
        setpoint,
        within=within,
        hold_s=hold_s,
        start=start,
        disturbance_K=push,
        controller=controller,
        numbers=parse_pairs(numbers),
        feedback=feedback,
    )
    run_closed_loop(loop, options, out, model)
