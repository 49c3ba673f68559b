"""Writes a page next to each run of a folder, and an index of all runs.

The pages share one copy of Plotly's script. A page that is newer than its run is not rewritten, so a folder that
grows every night stays small and its index is updated quickly.
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
    """One run's page: its path, whether the run is complete, and why the run ended."""

    report: Path
    complete: bool
    cause: str


@dataclass(frozen=True)
class FolderReport:
    """The index of a folder, the pages it links to, and a sentence for each file that could not be read."""

    index: Path
    pages: tuple[WrittenPage, ...]
    unreadable: tuple[str, ...]


def run_files(folder: Path) -> list[Path]:
    """The run files in a folder and its subfolders, sorted by name; UsageError if there are none."""
    files = sorted(file for file in folder.rglob("*.run.sqlite") if file.is_file())
    if not files:
        raise UsageError(f"Folder {folder} contains no run files (*.run.sqlite).")
    return files


def check_name(file: Path) -> None:
    """Raise DataError for a name that a page cannot contain."""
    try:
        str(file).encode("utf-8")
    except UnicodeEncodeError:
        raise DataError(f"{str(file)!a}: this name is not UTF-8 text. Rename the file.") from None


def page_path(file: Path) -> Path:
    """The path of a run's page, in the same folder as the run."""
    return file.with_name(file.name.removesuffix(".sqlite").removesuffix(".run") + ".html")


def report_folder(folder: Path, *, force: bool = False) -> FolderReport:
    """Write or update the pages of all runs in a folder, and the index of the folder.

    A page written by smarig is updated if its run is newer, or with ``force``. If another program wrote a file of
    that name, a UsageError is raised before anything is written.
    """
    files = run_files(folder)
    index = folder / INDEX_FILE
    for page in (index, *map(page_path, files)):
        if page.exists() and not (force or is_smarig_page(page)):
            raise UsageError(f"{page} was not written by smarig. Move it, or use --force to replace it.")
    write_library(folder)
    entries, pages, unreadable = [], [], []
    for file in files:
        try:
            check_name(file)
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
    """Write the run's page unless it is newer than the run, and return its path."""
    page = page_path(run.path)
    if force or not page.exists() or page.stat().st_mtime <= _modified_s(run.path):
        write_page(run_page(run, library=_relative_url(folder / LIBRARY, page.parent)), page, force=True)
    return page


def _modified_s(file: Path) -> float:
    """The time at which a run's file or its journal was last written."""
    journal: Sequence[Path] = (file, file.with_name(file.name + "-wal"))
    return max(path.stat().st_mtime for path in journal if path.exists())


def _relative_url(target: Path, base: Path) -> str:
    """The quoted relative URL from a folder to a file."""
    return quote(Path(os.path.relpath(target, base)).as_posix())
