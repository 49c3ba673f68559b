"""``smarig simulate``: the response of a model, as a run."""

from pathlib import Path

import click

from smarig.cli.output import check_distinct, emit, json_option
from smarig.cli.parameter_types import FILE, PROTOCOL, RIG, own_effects
from smarig.core import UsageError

EPILOG = """\b
Examples:
  smarig simulate wire.model.json --along validation.run.sqlite -o simulated.run.sqlite
  smarig simulate wire.model.json --protocol wiping_out -o simulated.run.sqlite
"""


@click.command("simulate", short_help="Simulate a model along a run, or a protocol.", epilog=EPILOG)
@click.argument("model", type=FILE)
@click.option("--along", type=FILE, help="Run whose inputs are applied to the model.")
@click.option("--protocol", type=PROTOCOL, help="Protocol to run on the model's noise-free twin.")
@click.option(
    "--set", "pairs", multiple=True, metavar="KEY=VALUE", help="A setting of the protocol; repeatable."
)
@click.option("--rig", type=RIG, default="", help="Rig for --protocol (default: that of the model).")
@click.option("-o", "--out", type=FILE, required=True, help="Run file to write.")
@click.option("--force", is_flag=True, help="Replace an existing run file.")
@own_effects
@json_option
def command(
    model: Path,
    along: Path | None,
    protocol: str | None,
    pairs: tuple[str, ...],
    rig: str,
    out: Path,
    force: bool,
) -> None:
    """Simulate a model along a run, or a protocol on the model's twin, and write a run file."""
    from smarig.app import simulate_protocol, simulate_run
    from smarig.protocols import parse_pairs
    from smarig.record import load_run
    from smarig.replay import load_model

    if (along is None) == (protocol is None):
        raise UsageError("Give either --along RUN or --protocol NAME.")
    check_distinct(out, model, along)
    loaded = load_model(model)
    if along is not None:
        simulate_run(loaded, load_run(along), out, force=force)
    else:
        simulate_protocol(loaded, str(protocol), parse_pairs(pairs), out, rig=rig, force=force)
    run = load_run(out)
    emit({"run": str(out), "samples": len(run), "steps": len(run.steps)}, repr(run))
