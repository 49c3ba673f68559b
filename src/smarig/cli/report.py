"""``smarig report``: a page for a run, or for a folder that characterise made."""

from pathlib import Path

import click

from smarig.cli._output import distinct, emit, json_option
from smarig.cli._types import ANY_PATH, FILE


@click.command("report", epilog="\b\nExample:\n  smarig report validation.run.sqlite -o validation.html")
@click.argument("run", type=ANY_PATH)
@click.option("-o", "--out", type=FILE, help="HTML file; default: beside the run.")
@click.option("--force", is_flag=True, help="Replace an existing page.")
@json_option
def command(run: Path, out: Path | None, force: bool) -> None:
    """Write an offline HTML page about a run (finished, interrupted or imported)."""
    from smarig.record import load_run
    from smarig.report.page import write_page
    from smarig.report.run_page import run_page

    target = out or run.with_name(run.name.removesuffix(".sqlite").removesuffix(".run") + ".html")
    distinct(target, run)
    recorded = load_run(run)
    write_page(run_page(recorded), target, force=force)
    emit({"report": str(target), "complete": recorded.complete, "cause": recorded.cause}, f"Report: {target}")
