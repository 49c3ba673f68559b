"""``smarig check --driver``: check a driver against the contract of its role."""

from typing import cast

from smarig.cli.confirmation import confirm
from smarig.cli.output import emit, show_message
from smarig.config import RigFile, load_rig
from smarig.core import RigFault, UsageError
from smarig.device import Role, contract
from smarig.plant import Actuator
from smarig.rig import check_driver, rig_for_check, without_lease_text
from smarig.runner import rig_locks

DEFAULT_RIG = "one_wire_serial"  # simulated devices: a driver can be tried without hardware
_POWERED = "amplifier"  # the role in which current flows
_TEST_SHARE = 0.1  # of the largest current


def check_one_driver(rig: str | None, driver: str, role: str, url: str, wire: str, yes: bool) -> None:
    """Report every requirement of the role; RigFault if one is not met."""
    file = load_rig(rig) if rig else _default_rig()
    if file.kind == "twin":
        raise UsageError(f"Rig '{file.name}' is a twin and has no devices. Name a rig of kind \"bench\".")
    used = rig_for_check(file, cast(Role, role), driver, url)
    on_hardware = used.simulator is None or not used.simulator.start
    if on_hardware and not yes and role == _POWERED:
        _confirm_current(used)
    found = []
    with rig_locks(used, wire or file.wire):
        for result in check_driver(rig or DEFAULT_RIG, file, cast(Role, role), driver, url):
            show_message(result.line)
            found.append(result)
    met = sum(result.passed for result in found)
    untested = len(contract(cast(Role, role))) - len(found)
    limited = sum(result.limitation for result in found)
    but = f", {limited} with a limitation (!!)" if limited else ""
    lines = [f"{driver} as {role}: {met} of {len(found) + untested} requirements are met{but}."]
    if untested:
        lines.append(f"The last {untested} were not tested.")
    if role == _POWERED and any(result.limitation and result.name == "lease" for result in found):
        lines.append(without_lease_text(file, Actuator.named(file.actuator)))
    if role == "encoder_daq":
        lines.append("Its sign and its unit are checked with heat, by a bring-up: smarig check RIG.")
    if not rig and url:
        lines.append(
            f"The limits were those of {DEFAULT_RIG}; for those of your bench: smarig check RIG --driver …"
        )
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


def _default_rig() -> RigFile:
    """The rig of a check that names none. A position in mm is counted in steps of its encoder."""
    file = load_rig(DEFAULT_RIG)
    step = Actuator.named(file.actuator).resolution(file.encoder)
    return file.model_copy(update={"encoder": file.encoder.model_copy(update={"resolution": step})})


def _confirm_current(file: RigFile) -> None:
    """Ask for confirmation before current flows."""
    largest_A = max(file.limits.current_max_A, -file.limits.current_min_A)
    words = (
        f"A tenth of the largest current of {file.name}, {_TEST_SHARE * largest_A:.3g} A, will flow through its wire. "
        "Continue?"
    )
    confirm(words, "Give --yes to skip the question.")
