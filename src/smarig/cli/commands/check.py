"""``smarig check``: test a rig and preview a protocol, or check a run file."""

from pathlib import Path

import click

from smarig.cli.leftover_check import check_leftovers
from smarig.cli.output import json_option
from smarig.cli.parameter_types import DRIVER, FILE, PROTOCOL, RIG
from smarig.cli.run_file_check import check_run_file, is_run_file
from smarig.core import UsageError, is_folder

ROLE_NAMES = ("amplifier", "encoder_daq", "thermometer", "room_thermometer", "load_cell")

EPILOG = """\b
Examples:
  smarig check one_wire_twin --protocol first_order_descending
  smarig check validation.run.sqlite
  smarig check damaged.run.sqlite -o saved.run.sqlite
  smarig check runs/ --remove-leftovers
  smarig check --driver smarig_encoder_daq --role encoder_daq
  smarig check ./my_bench.toml --driver ./my_driver.py --url tcp://192.168.1.30:5025
"""


@click.command(
    "check",
    short_help="Check a rig, bring up a bench, preview a protocol; check a run file or a folder.",
    epilog=EPILOG,
)
@click.argument("rig", type=RIG, metavar="[RIG|RUN|FOLDER]", required=False)
@click.option(
    "--rig", "rig_option", type=RIG, help="The rig, as in other commands, in place of the argument."
)
@click.option(
    "--protocol",
    type=PROTOCOL,
    help="Preview this protocol on the twin: duration, peak current, temperature. Drives no current.",
)
@click.option(
    "--set", "pairs", multiple=True, metavar="KEY=VALUE", help="A setting of the protocol; repeatable."
)
@click.option(
    "--no-current", "preview_only", is_flag=True, help="Bench: only check the files; drive no current."
)
@click.option("--bring-up", is_flag=True, help="Bench, with --protocol: bring it up as well.")
@click.option(
    "--driver",
    type=DRIVER,
    help="Check this driver, a name or an own file, against the contract of its role.",
)
@click.option(
    "--role",
    type=click.Choice(ROLE_NAMES),
    default="amplifier",
    help="With --driver: its link in the rig file (default: amplifier).",
)
@click.option(
    "--wire", default="", help="With --driver: identity of the wire, if another program uses the rig file's."
)
@click.option("--url", default="", help="With --driver: port of the device, or tcp://HOST:PORT.")
@click.option("--yes", is_flag=True, help="Bench: heat the wire without confirmation.")
@click.option(
    "-o", "--out", type=FILE, help="Run file: write what can be saved from it to this new run file."
)
@click.option("--force", is_flag=True, help="Replace an existing file.")
@click.option(
    "--remove-leftovers",
    is_flag=True,
    help="Folder: remove the unfinished files of processes that have ended.",
)
@json_option
def command(
    rig: str | None,
    rig_option: str | None,
    protocol: str | None,
    pairs: tuple[str, ...],
    preview_only: bool,
    bring_up: bool,
    driver: str | None,
    role: str,
    wire: str,
    url: str,
    yes: bool,
    out: Path | None,
    force: bool,
    remove_leftovers: bool,
) -> int:
    """Check a rig's file, constants and lease, and bring up a bench. With --protocol, preview it on the rig's twin.

    With --driver, open the device with this driver and check each requirement of its role: current as ordered, off
    after a killed host, lease, readings in order. RIG gives limits and settings (default: one_wire_serial, whose
    devices are simulated); a tenth of its largest current flows.

    Of a run file, state what it holds and whether it is whole. With -o, save from a damaged file what its pages
    still hold. The file itself is never changed. The exit status is 4 if it is damaged, even if all was saved.

    Of a folder, name the hidden files (.NAME.….part) that killed processes left unfinished.
    """
    if rig and rig_option:
        raise UsageError(f"Give one rig: {rig}, or --rig {rig_option}.")
    rig = rig or rig_option
    if rig is not None and not driver and is_folder(Path(rig)):
        if protocol or pairs or preview_only or bring_up or yes or out or force or url or wire:
            raise UsageError(f"{rig} is a folder; only --remove-leftovers and --json apply to it.")
        check_leftovers(Path(rig), remove=remove_leftovers)
        return 0
    if remove_leftovers:
        raise UsageError("--remove-leftovers needs a folder.")
    if driver:
        if protocol or pairs or preview_only or bring_up or out or force:
            raise UsageError("With --driver, only RIG, --role, --url, --wire, --yes and --json apply.")
        from smarig.cli.contract_check import check_one_driver

        check_one_driver(rig, driver, role, url, wire, yes)
        return 0
    if url or wire:
        raise UsageError(f"{'--url' if url else '--wire'} needs --driver.")
    if rig is None:
        raise UsageError("Give a rig, a run file, or --driver.")
    if is_run_file(rig):
        if protocol or pairs or preview_only or bring_up or yes:
            raise UsageError(f"{rig} is a run file; only -o, --force and --json apply to it.")
        return check_run_file(Path(rig), out, force)
    if out or force:
        raise UsageError("-o and --force are for run files (*.run.sqlite).")
    if preview_only and bring_up:
        raise UsageError("--no-current drives no current, and --bring-up does. Give one of them.")
    from smarig.cli.rig_check import check_rig

    check_rig(rig, protocol, pairs, bring_up=bring_up or not (preview_only or protocol), yes=yes)
    return 0
