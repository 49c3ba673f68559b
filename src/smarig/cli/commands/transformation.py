"""``smarig transformation``: transformation temperatures of runs by the tangent method."""

from pathlib import Path

import click

from smarig.cli.output import check_distinct, emit, json_option
from smarig.cli.parameter_types import FILE

EPILOG = """\b
Examples:
  smarig transformation cycles.run.sqlite
  smarig transformation 50MPa.run.sqlite 100MPa.run.sqlite 150MPa.run.sqlite -o stress.html
"""


@click.command(
    "transformation", short_help="Transformation temperatures A_s, A_f, M_s, M_f of runs.", epilog=EPILOG
)
@click.argument("runs", nargs=-1, required=True, type=FILE)
@click.option("-o", "--out", type=FILE, help="Page to write (*.html), with the loops and their tangents.")
@click.option("--force", is_flag=True, help="Replace an existing page.")
@json_option
def command(runs: tuple[Path, ...], out: Path | None, force: bool) -> None:
    """Transformation temperatures, stroke, residual, span and width of the full loops of runs, by tangents as in
    ASTM E3097, with intervals. Runs at different stresses give the Clausius-Clapeyron coefficient; several cycles,
    or several runs of one wire, their drift."""
    from smarig.transformation import transformation_temperatures

    check_distinct(out, *runs)
    found = transformation_temperatures(list(runs))
    result = found.to_json()
    text = str(found)
    if out is not None:
        from smarig.report import transformation_page, write_page

        write_page(transformation_page(found), out, force=force)
        result["report"] = str(out)
        text += f"\nReport: {out}"
    emit(result, text)
