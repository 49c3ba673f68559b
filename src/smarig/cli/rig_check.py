"""``smarig check RIG``: check a rig's file, constants and lease, bring up a bench, preview a protocol."""

import time
from typing import Any

from smarig.cli.confirmation import confirm
from smarig.cli.output import emit, show_message
from smarig.cli.progress import preview_progress
from smarig.cli.rig_bring_up import announced_bring_up
from smarig.config import RigFile, load_rig, shipped_names, template_values
from smarig.core import ConfigError, LeaseExpired, RigFault, UsageError, catalogue_names
from smarig.device import Check
from smarig.plant import Actuator
from smarig.protocols import PROTOCOLS, Setup, parse_pairs
from smarig.rig import Twin, inconsistencies
from smarig.runner import preview

_LABELS = {"lease_trips": "Lease test passed"}  # of the values that are no quantities


def check_rig(rig: str, protocol: str | None, pairs: tuple[str, ...], *, bring_up: bool, yes: bool) -> None:
    """Report what a rig is; ConfigError for constants that contradict each other, RigFault if it is not fit to run.

    ``bring_up``: bring a bench up, which heats its wire.
    """
    if protocol:
        _refuse_campaign(protocol, rig)
    file = load_rig(rig)
    actuator = Actuator.named(file.actuator)
    setup = Setup(actuator, file.limits, file.period_s)
    found: dict[str, Any] = {
        "rig": file.name,
        "kind": file.kind,
        "actuator": actuator.name,
        "tau_s": actuator.tau_s,
        "hA_W_per_K": actuator.hA_W_per_K,
        "input_range_K": [setup.lower_K, setup.upper_K],
        "position_per_count": actuator.resolution(file.encoder),
        "unit": actuator.unit,
    }
    if file.kind == "twin":
        found["lease_trips"] = _lease_trips(Twin.named(rig))
    if unknown := list(template_values(actuator.file)):
        show_message(
            f"Warning: {actuator.name} still has values of the template, which are those of another wire: "
            f"{', '.join(unknown)}. Replace each, and its source."
        )
    lines = [f"{_LABELS.get(key, key):>20}: {_short(value)}" for key, value in found.items()]
    if protocol:
        cost = preview(protocol, file, parse_pairs(pairs), report=preview_progress())
        found["preview"] = cost.__dict__
        lines.append(f"{'preview':>20}: {cost.sentence()}")
    rig_is_fit, error = True, None
    problems = inconsistencies(file)
    if problems:
        raise ConfigError("\n".join(f"{rig}: {problem}" for problem in problems))
    if file.kind == "bench" and not bring_up and protocol:
        lines.append("No current was driven. To bring the bench up as well, add --bring-up.")
    if file.kind == "bench" and bring_up:
        _confirm_heating(file, yes)
        checks, error = announced_bring_up(rig, file, actuator)
        rig_is_fit = all(c.passed for c in checks)
        found["checks"] = [c.to_json() for c in checks]
        lines += ["", *_checklist(file, checks)]
    if error is None and not rig_is_fit:
        error = RigFault("The rig is not fit to run. See the list of checks.")
    if error is not None:
        found["error"] = str(error)
    emit(found, "\n".join(lines))
    if error is not None:
        raise error


def _refuse_campaign(protocol: str, rig: str) -> None:
    """Raise UsageError for the name or the file of a campaign, which is previewed by another command."""
    if protocol not in catalogue_names(PROTOCOLS) and (
        protocol in shipped_names("campaigns") or protocol.endswith(".toml")
    ):
        raise UsageError(
            f"{protocol} is a campaign, which runs several protocols. Preview it with: smarig run {protocol} "
            f"--rig {rig} --dry-run"
        )


def _confirm_heating(file: RigFile, yes: bool) -> None:
    """Ask for confirmation before a real wire is heated."""
    if file.simulator is None and not yes:
        words = f"The wire of {file.name} will be heated gently, and its lease will expire once. Continue?"
        confirm(words, "Give --yes to skip the question, or --no-current to check only the files.")


def _checklist(file: RigFile, checks: list[Check]) -> list[str]:
    """The lines of the checklist, to be printed and signed."""
    now = time.strftime("%Y-%m-%d %H:%M")
    rows = [f"[{_mark(c)}] {c.name}: {c.observed}" for c in checks]
    manual_checks = [
        "[ ] cut-out: pressed while current flowed, and the current stopped",
        "[ ] guard and load: in place",
    ]
    return [
        f"Bring-up of {file.name}, wire '{file.wire}', {now}",
        *rows,
        *manual_checks,
        "",
        "Signed: ____________________",
    ]


def _mark(check: Check) -> str:
    if not check.passed:
        return " "
    return "!" if check.limitation else "x"


def _short(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.5g}"
    return " … ".join(map(_short, value)) if isinstance(value, list) else str(value)


def _lease_trips(twin: Twin) -> bool:
    """Whether a pause longer than the lease switches the output off and latches a trip."""
    twin.step(0.1)
    twin.idle(twin.file.lease_s + 10 * twin.period_s)
    try:
        twin.step(0.1)
    except LeaseExpired:
        return twin.output_A == 0.0
    return False
