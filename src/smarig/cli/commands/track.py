"""``smarig track``: track a reference with a controller that uses a model of the wire."""

from pathlib import Path

import click

from smarig.cli.closed_loop_run import run_closed_loop
from smarig.cli.output import json_option
from smarig.cli.parameter_types import CONTROLLER, FILE, FiniteNumber
from smarig.cli.progress import STREAMS
from smarig.cli.run_options import RunOptions, run_options

EPILOG = f"""{STREAMS}

\b
Examples:
  smarig track wire.model.json --reference steps --rig one_wire_twin -o steps.run.sqlite
  smarig track wire.model.json --reference multisine --set low=2 --set high=8 --set seconds=240 \\
      --controller pi --controller-set gain_share=10 --rig one_wire_twin -o pi.run.sqlite
  smarig track wire.model.json --reference reference.csv --rig one_wire_serial -o reference.run.sqlite
  smarig track wire.model.json --reference ramps --controller ./mine.py --rig one_wire_twin -o mine.run.sqlite
  smarig track wire.model.json --reference multisine --controller leaky_pi --controller-set gain=300 \\
      --rig one_wire_twin -o velocity.run.sqlite
"""


@click.command("track", short_help="Track a reference in closed loop.", epilog=EPILOG)
@click.argument("model", type=FILE)
@click.option(
    "--reference",
    required=True,
    metavar="SHAPE|FILE.csv",
    help="steps, ramps, multisine, or a CSV file with time_s and position_mm (or position_deg).",
)
@click.option("-o", "--out", type=FILE, help="Run file.")
@click.option(
    "--set",
    "pairs",
    multiple=True,
    metavar="KEY=VALUE",
    help="Setting of the reference: low, high, seconds, every_s, speed, seed; repeatable.",
)
@click.option(
    "--controller",
    type=CONTROLLER,
    default="inverse",
    show_default=True,
    help="Position or velocity controller: a name ('smarig list controllers') or your own file, ./NAME.py.",
)
@click.option(
    "--controller-set",
    "numbers",
    multiple=True,
    metavar="KEY=VALUE",
    help="Parameter of the controller ('smarig list controllers --settings'); repeatable.",
)
@click.option(
    "--offset-K",
    "offset_K",
    type=FiniteNumber(),
    help="Velocity controllers: offset u_o, in K, added to the output (thesis §8.2).",
)
@run_options
@json_option
def command(
    model: Path,
    reference: str,
    out: Path | None,
    pairs: tuple[str, ...],
    controller: str,
    numbers: tuple[str, ...],
    offset_K: float | None,
    options: RunOptions,
) -> None:
    """Initialise the wire, close a loop, track a reference, open the loop; record the run and print its
    result.

    Positions are in the rig's unit. They are counted from the encoder's zero, which initialisation sets. Limits,
    trips and lease apply as in any run. A position loop that diverges ends at zero current with exit status
    3. The feed-forward includes the model's effects.

    A velocity controller (constant_gain, lead_lag, leaky_pi, saturating_gain, scheduled_gain; thesis §8.2)
    tracks the reference's velocity, not its position. The measured ratio ‖ṙ − v‖/(‖ṙ‖ + ‖u_o‖) is compared
    with k_e (Thm 8.2), and each hypothesis is listed with whether this rig satisfies it.
    """
    from smarig.app import ModelSource, tracking
    from smarig.protocols import parse_pairs

    source = ModelSource.of(model)
    chosen = (parse_pairs(pairs), controller, parse_pairs(numbers), offset_K)
    loop = tracking(source, options.rig_file(), reference, *chosen)
    run_closed_loop(loop, options, out, model, Path(reference))
