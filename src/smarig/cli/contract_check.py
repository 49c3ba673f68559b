"""``smarig check --driver``: check a driver against the contract of its role."""

from typing import cast

import click

from smarig.cli.output import emit, show_message
from smarig.config import load_rig
from smarig.core import RigFault, UsageError
from smarig.device import Role
from smarig.plant import Actuator
from smarig.rig import check_driver, without_lease_text
from smarig.runner import rig_locks

_POWERED = "amplifier"  # the role in which current flows


def check_one_driver(rig: str, driver: str, role: str, url: str, wire: str, yes: bool) -> None:
    """Report every requirement of the role; RigFault if one is not met."""
    file = load_rig(rig)
    if file.kind == "twin":
        raise UsageError(f"Rig '{file.name}' is a twin and has no devices. Name a rig of kind \"bench\".")
    on_hardware = file.simulator is None or not file.simulator.start or bool(url)
    if on_hardware and not yes and role == _POWERED:
        words = f"A tenth of the largest current of {file.name} will flow through its wire. Continue?"
        if not click.confirm(words, default=False, err=True):
            raise UsageError("Nothing was done. Give --yes to skip the question.")
    found = []
    with rig_locks(file, wire or file.wire):
        for result in check_driver(rig, file, cast(Role, role), driver, url):
            show_message(result.line)
            found.append(result)
    met = sum(result.passed for result in found)
    lines = [f"{driver} as {role}: {met} of {len(found)} requirements are met."]
    if role == _POWERED and any(result.limitation for result in found):
        lines.append(without_lease_text(file, Actuator.named(file.actuator)))
    emit(
        {
            "driver": driver,
            "role": role,
            "rig": file.name,
            "requirements": [result.to_json() for result in found],
        },
        "\n".join(lines),
    )
    if met < len(found):
        raise RigFault(f"{driver} does not meet the contract of its role. See the requirements marked NOT.")
