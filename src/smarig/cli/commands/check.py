"""``smarig check``: test a rig and preview a protocol, or check a run file."""

from pathlib import Path

import click

from smarig.cli.output import json_option
from smarig.cli.parameter_types import FILE, PROTOCOL, RIG
from smarig.cli.run_file_check import check_run_file, is_run_file
from smarig.core import UsageError

EPILOG = """\b
Examples:
  smarig check one_wire_twin --protocol first_order_descending
  smarig check validation.run.sqlite
  smarig check damaged.run.sqlite -o saved.run.sqlite
"""


@click.command(
    "check",
    short_help="Check a rig, bring up a bench, preview a protocol; or check and save a run file.",
    epilog=EPILOG,
)
@click.argument("rig", type=RIG, metavar="RIG|RUN")
@click.option(
    "--protocol",
    type=PROTOCOL,
    help="Preview this protocol on the twin: duration, peak current, temperature.",
)
@click.option(
    "--set", "pairs", multiple=True, metavar="KEY=VALUE", help="A setting of the protocol; repeatable."
)
@click.option(
    "--no-current", "preview_only", is_flag=True, help="Bench: only check the files; drive no current."
)
@click.option("--yes", is_flag=True, help="Bench: heat the wire without confirmation.")
@click.option(
    "-o", "--out", type=FILE, help="Run file: write what can be saved from it to this new run file."
)
@click.option("--force", is_flag=True, help="Replace an existing file.")
@json_option
def command(
    rig: str,
    protocol: str | None,
    pairs: tuple[str, ...],
    preview_only: bool,
    yes: bool,
    out: Path | None,
    force: bool,
) -> int:
    """Check a rig's file, constants and lease, and bring up a bench. Preview a protocol on its twin.

    Of a run file, state what it holds and whether it is whole. With -o, save from a damaged file what its pages
    still hold. The file itself is never changed. The exit status is 4 if it is damaged, even if all was saved.
    """
    if is_run_file(rig):
        if protocol or pairs or preview_only or yes:
            raise UsageError(f"{rig} is a run file; only -o, --force and --json apply to it.")
        return check_run_file(Path(rig), out, force)
    if out or force:
        raise UsageError("-o and --force are for run files (*.run.sqlite).")
    from smarig.cli.rig_check import check_rig

    check_rig(rig, protocol, pairs, preview_only, yes)
    return 0
