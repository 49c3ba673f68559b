"""``smarig export``: write a run, or a model, in the format of another program."""

from pathlib import Path

import click

from smarig.cli.output import check_distinct, emit, json_option
from smarig.cli.parameter_types import FILE, CatalogueName
from smarig.core import UsageError, catalogue_names, catalogue_summary

_RUNS, _MODELS = "smarig.exchange.writers", "smarig.exchange.model_writers"


def _listed(package: str) -> str:
    return "\n".join(f"  {name:<8} {catalogue_summary(package, name)}" for name in catalogue_names(package))


EPILOG = f"""\b
Formats of runs:
{_listed(_RUNS)}

\b
Formats of models:
{_listed(_MODELS)}

\b
Examples:
  smarig export validation.run.sqlite --to csv -o validation.csv
  smarig export validation.run.sqlite --to netcdf -o validation.nc
  smarig export wire.model.json --to c -o wire.c
  smarig export wire.model.json --to fmu -o wire.fmu
"""


@click.command("export", epilog=EPILOG)
@click.argument("file", type=FILE, metavar="RUN|MODEL")
@click.option(
    "--to",
    "format_",
    required=True,
    type=CatalogueName("writers", "model_writers"),
    help="Format, see below.",
)
@click.option("-o", "--out", type=FILE, required=True, help="File to write.")
@click.option("--force", is_flag=True, help="Replace an existing file.")
@json_option
def command(file: Path, format_: str, out: Path, force: bool) -> None:
    """Export a run for other programs (every format except csv includes its steps and events), or a model for
    simulators and firmware."""
    check_distinct(out, file)
    if format_ in catalogue_names(_MODELS):
        _model(file, format_, out, force)
    else:
        _run(file, format_, out, force)


def _run(file: Path, format_: str, out: Path, force: bool) -> None:
    from smarig.exchange import export_run
    from smarig.record import stored_run

    if file.name.endswith("model.json"):
        known = ", ".join(catalogue_names(_MODELS))
        raise UsageError(f"{file} is a model. Formats of models are {known}.")
    with stored_run(file) as recorded:
        export_run(recorded, to=format_, out=out, force=force)
        emit({"run": str(file), "file": str(out), "rows": len(recorded)}, f"{out}: {len(recorded)} rows.")


def _model(file: Path, format_: str, out: Path, force: bool) -> None:
    from smarig.exchange import export_model

    written = [str(path) for path in export_model(file, to=format_, out=out, force=force)]
    emit({"model": str(file), "files": written}, f"Written: {', '.join(written)}.")
