"""``smarig import``: convert the data of others into a run file."""

from pathlib import Path

import click

from smarig.cli.output import check_distinct, emit, json_option, show_message
from smarig.cli.parameter_types import FILE, RIG, CatalogueName

EPILOG = """\b
Examples:
  smarig import mine.csv --format csv --rig one_wire_twin -o mine.run.sqlite
  smarig import test.csv --format csv --map sma_staircase -o staircase.run.sqlite
  smarig import loops.dat --format csv --map ferroelectric_loops:4 -o loops.run.sqlite
  smarig import part2.csv --format csv --map ./mine.toml --continues part1.run.sqlite -o part2.run.sqlite
  smarig import reversal_curves --format forc -o forc.run.sqlite
  smarig import H_MnZn_HP_ferrite.mat --format mat --map ferrite_nested -o ferrite.run.sqlite
"""


@click.command("import", short_help="Import measured data and report what looks wrong.", epilog=EPILOG)
@click.argument("file", type=FILE)
@click.option(
    "--format",
    "format_",
    required=True,
    type=CatalogueName("readers"),
    help="Format of the file: csv, forc, hdf5, mat, npz, parquet, tdms, xlsx.",
)
@click.option(
    "--map",
    "mapping",
    type=CatalogueName("imports"),
    help="Mapping file, by name or path: optional for csv, none for forc, required for all others.",
)
@click.option("--rig", type=RIG, help="Rig whose actuator and encoder give temperature and position.")
@click.option("--t0", type=float, help="Start of this file, in s, on a clock shared with other runs.")
@click.option("--wire", help="Identity of the wire.")
@click.option(
    "--continues",
    type=FILE,
    metavar="RUN",
    help="Imported part of the same record before this file: the memory is carried over from it.",
)
@click.option(
    "--repair",
    is_flag=True,
    help="Mask drop-outs and single-row spikes and drop repeated rows; the run keeps which.",
)
@click.option("-o", "--out", type=FILE, required=True, help="Run file to write.")
@click.option("--force", is_flag=True, help="Replace an existing run file.")
@json_option
def command(
    file: Path,
    format_: str,
    mapping: str | None,
    rig: str | None,
    t0: float | None,
    wire: str | None,
    continues: Path | None,
    repair: bool,
    out: Path,
    force: bool,
) -> None:
    """Import measured data and report everything that looks wrong."""
    from smarig.exchange import import_file

    check_distinct(out, file, *([continues] if continues else []))
    report = import_file(
        file,
        format=format_,
        out=out,
        rig=rig,
        mapping=mapping,
        t0=t0,
        wire=wire,
        continues=continues,
        repair=repair,
        force=force,
    )
    for warning in report.warnings:
        show_message(f"Warning: {warning}")
    found = {
        "run": str(report.run),
        "rows": report.rows,
        "steps": report.steps,
        "warnings": list(report.warnings),
        "repairs": {r.kind: r.to_json() for r in report.repairs},
    }
    steps = f", {report.steps} steps" if report.steps else ""
    emit(found, f"{report.run}: {report.rows} rows{steps}.")
