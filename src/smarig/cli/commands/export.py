"""``smarig export``: write a run in the format of another program."""

from pathlib import Path

import click

from smarig.cli.output import check_distinct, emit, json_option
from smarig.cli.parameter_types import FILE, CatalogueName
from smarig.core import catalogue_names, catalogue_summary

_PACKAGE = "smarig.exchange.writers"
_FORMATS = "\n".join(f"  {name:<8} {catalogue_summary(_PACKAGE, name)}" for name in catalogue_names(_PACKAGE))
EPILOG = f"""\b
Formats:
{_FORMATS}

\b
Examples:
  smarig export validation.run.sqlite --to csv -o validation.csv
  smarig export validation.run.sqlite --to netcdf -o validation.nc
"""


@click.command("export", epilog=EPILOG)
@click.argument("run", type=FILE)
@click.option("--to", "format_", required=True, type=CatalogueName("writers"), help="Format, see below.")
@click.option("-o", "--out", type=FILE, required=True, help="File to write.")
@click.option("--force", is_flag=True, help="Replace an existing file.")
@json_option
def command(run: Path, format_: str, out: Path, force: bool) -> None:
    """Export a run for other programs. Every format except csv includes its steps and events."""
    from smarig.exchange import export_run
    from smarig.record import stored_run

    check_distinct(out, run)
    with stored_run(run) as recorded:
        export_run(recorded, to=format_, out=out, force=force)
        emit({"run": str(run), "file": str(out), "rows": len(recorded)}, f"{out}: {len(recorded)} rows.")
