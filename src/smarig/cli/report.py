"""``smarig report``: pages for runs, or for every run in a folder."""

from pathlib import Path

import click

from smarig.cli._output import distinct, emit, json_option
from smarig.cli._types import ANY_PATH, FILE
from smarig.errors import UsageError

EPILOG = """\b
Examples:
  smarig report validation.run.sqlite -o validation.html
  smarig report out/one_wire/runs
"""


@click.command("report", epilog=EPILOG)
@click.argument("runs", nargs=-1, required=True, type=ANY_PATH, metavar="RUN|DIR...")
@click.option("-o", "--out", type=FILE, help="HTML file of a single run; default: beside the run.")
@click.option("--force", is_flag=True, help="Replace existing pages.")
@json_option
def command(runs: tuple[Path, ...], out: Path | None, force: bool) -> None:
    """Write an offline HTML page about each run (finished, interrupted or imported)."""
    from smarig.record import load_run
    from smarig.report.page import write_page
    from smarig.report.run_page import run_page

    found = [file for path in runs for file in _runs_in(path)]
    if out is not None and len(found) > 1:
        raise UsageError(f"-o names one page, but there are {len(found)} runs; leave it out.")
    pages = []
    for file in found:
        target = out or file.with_name(file.name.removesuffix(".sqlite").removesuffix(".run") + ".html")
        distinct(target, file)
        recorded = load_run(file)
        write_page(run_page(recorded), target, force=force)
        pages.append({"report": str(target), "complete": recorded.complete, "cause": recorded.cause})
    emit({**pages[0], "reports": pages}, "\n".join(f"Report: {page['report']}" for page in pages))


def _runs_in(path: Path) -> list[Path]:
    if not path.is_dir():
        return [path]
    files = sorted(path.rglob("*.run.sqlite"))
    if not files:
        raise UsageError(f"Folder {path} holds no run files (*.run.sqlite).")
    return files
