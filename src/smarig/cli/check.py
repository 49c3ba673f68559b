"""``smarig check``: is the rig fit to run, and what would a protocol cost?"""

import click

from smarig.cli._output import emit, json_option
from smarig.cli._types import PROTOCOL, RIG
from smarig.config import load_rig
from smarig.errors import LeaseExpired
from smarig.model.actuator import Actuator
from smarig.protocols._settings import parse_pairs
from smarig.protocols._setup import Setup
from smarig.rig.twin import Twin
from smarig.runner.preview import preview


@click.command("check", epilog="\b\nExample:\n  smarig check one_wire_twin --protocol first_order_descending")
@click.argument("rig", type=RIG)
@click.option(
    "--protocol", type=PROTOCOL, help="Preview it on the twin: duration, peak current, temperature."
)
@click.option(
    "--set", "pairs", multiple=True, metavar="KEY=VALUE", help="A setting of the protocol; repeatable."
)
@json_option
def command(rig: str, protocol: str | None, pairs: tuple[str, ...]) -> None:
    """Check a rig's file, constants and lease; preview a protocol on its twin."""
    file = load_rig(rig)
    actuator = Actuator.named(file.actuator)
    setup = Setup(actuator, file.limits, file.period_s)
    found = {
        "rig": file.name,
        "kind": file.kind,
        "actuator": actuator.name,
        "tau_s": actuator.tau_s,
        "hA_W_per_K": actuator.hA_W_per_K,
        "input_range_K": [setup.lower_K, setup.upper_K],
        "position_per_count": actuator.position_per_count(file.encoder.counts_per_rev),
        "unit": actuator.unit,
        "lease_trips": _lease_trips(Twin.named(rig)),
    }
    lines = [f"{key:>20}: {_short(value)}" for key, value in found.items()]
    if protocol:
        cost = preview(protocol, file, parse_pairs(pairs))
        found["preview"] = cost.__dict__
        lines.append(f"{'preview':>20}: {cost.sentence()}")
    emit(found, "\n".join(lines))


def _short(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.5g}"
    return " … ".join(map(_short, value)) if isinstance(value, list) else str(value)


def _lease_trips(twin: Twin) -> bool:
    """Whether silence longer than the lease switches the output off and latches."""
    twin.step(0.1)
    twin.idle(twin.file.lease_s + 10 * twin.period_s)
    try:
        twin.step(0.1)
    except LeaseExpired:
        return twin.output_A == 0.0
    return False
