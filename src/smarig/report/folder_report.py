"""Pages for a folder of runs: one beside each run, and an index over them all.

The pages share one copy of Plotly's script, and those that are newer than their run are left alone, so a
folder that grows every night stays small and its index quick to renew. Knows files; refuses to know their looks.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from smarig.core import DataError, UsageError
from smarig.record import Run, load_run
from smarig.report.components.page import LIBRARY, is_smarig_page, write_library, write_page
from smarig.report.index_page import IndexEntry, index_page
from smarig.report.run_page import run_page
from smarig.report.runs.run_summary import summary_of

INDEX_FILE = "index.html"


@dataclass(frozen=True)
class WrittenPage:
    """One run's page: where it is, whether the run is complete and why it ended."""

    report: Path
    complete: bool
    cause: str


@dataclass(frozen=True)
class FolderReport:
    """The index of a folder, the pages it leads to, and a sentence for each file that could not be read."""

    index: Path
    pages: tuple[WrittenPage, ...]
    unreadable: tuple[str, ...]


def run_files(folder: Path) -> list[Path]:
    """The run files in a folder and below, by name; UsageError where there are none."""
    files = sorted(folder.rglob("*.run.sqlite"))
    if not files:
        raise UsageError(f"Folder {folder} holds no run files (*.run.sqlite).")
    return files


def page_path(file: Path) -> Path:
    """Where the page of a run is written: beside it."""
    return file.with_name(file.name.removesuffix(".sqlite").removesuffix(".run") + ".html")


def report_folder(folder: Path, *, force: bool = False) -> FolderReport:
    """Write or renew the pages of all runs in a folder, and its index.

    A page that smarig wrote is renewed where its run is newer, or with ``force``; somebody else's file of that
    name is refused with a UsageError, before anything is written.
    """
    files = run_files(folder)
    index = folder / INDEX_FILE
    for page in (index, *map(page_path, files)):
        if page.exists() and not (force or is_smarig_page(page)):
            raise UsageError(f"{page} was not written by smarig; move it, or --force to replace it.")
    write_library(folder)
    entries, pages, unreadable = [], [], []
    for file in files:
        try:
            run = load_run(file)
        except DataError as error:
            unreadable.append(str(error))
            continue
        page = _update_page(run, folder, force)
        pages.append(WrittenPage(page, run.complete, run.cause))
        entries.append(IndexEntry(summary_of(run), _relative_url(page, folder)))
    title = f"Runs in {folder.resolve().name or folder}"
    write_page(index_page(title, entries, unreadable), index, force=True)
    return FolderReport(index, tuple(pages), tuple(unreadable))


def _update_page(run: Run, folder: Path, force: bool) -> Path:
    """The run's page, written anew unless it is newer than the run."""
    page = page_path(run.path)
    if force or not page.exists() or page.stat().st_mtime <= _modified_s(run.path):
        write_page(run_page(run, library=_relative_url(folder / LIBRARY, page.parent)), page, force=True)
    return page


def _modified_s(file: Path) -> float:
    """When a run was last written to, in the file itself or in its journal."""
    journal: Sequence[Path] = (file, file.with_name(file.name + "-wal"))
    return max(path.stat().st_mtime for path in journal if path.exists())


def _relative_url(target: Path, base: Path) -> str:
    """A relative address as a page writes it."""
    return quote(Path(os.path.relpath(target, base)).as_posix())
