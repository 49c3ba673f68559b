"""Writes a page next to each run of a folder, and an index of all runs.

The pages share one copy of Plotly's script. A page that is newer than its run is not rewritten, so a folder that
grows every night stays small. The summaries of the index are kept beside it (``SummaryCache``), so a run that has not
changed is not read again.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from smarig.core import DataError, UsageError, counted, leads_out, natural_order
from smarig.record import Run, load_run, stored_run
from smarig.report.components.page import LIBRARY, is_smarig_page, write_library, write_page
from smarig.report.folder_contents import folder_contents
from smarig.report.index_page import IndexEntry, ResultEntry, index_page
from smarig.report.runs.run_summary import CACHE_FILE, RunSummary, SummaryCache, file_state, summary_of

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
    """The run files in a folder and its subfolders, sorted by name; UsageError if there are none.

    Links that lead out of the folder are left out.
    """
    files = natural_order(
        file for file in folder.rglob("*.run.sqlite") if file.is_file() and not leads_out(file, folder)
    )
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
    stem = file.name.removesuffix(".sqlite").removesuffix(".run")
    return file.with_name(
        f"{'index.run' if stem == 'index' else stem}.html"
    )  # index.html is that of the folder


def report_folder(folder: Path, *, force: bool = False) -> FolderReport:
    """Write or update the pages of all runs in a folder, and the index of the folder.

    A page written by smarig is updated if its run is newer, or with ``force``. If another program wrote a file of
    that name, a UsageError is raised before anything is written.
    """
    files = run_files(folder)
    index = folder / INDEX_FILE
    for page in (index, folder / LIBRARY, folder / CACHE_FILE, *map(page_path, files)):
        if leads_out(page, folder):
            raise UsageError(f"{page} is a link that leads out of the folder. Remove it.")
    for page in (index, *map(page_path, files)):
        if page.exists() and not (force or is_smarig_page(page)):
            raise UsageError(f"{page} was not written by smarig. Move it, or use --force to replace it.")
    write_library(folder)
    cache = SummaryCache(folder)
    entries, pages, unreadable = [], [], _links_left_out(folder)
    for file in counted(files, len(files)):
        try:
            check_name(file)
            summary = _summary_and_page(file, folder, cache, force)
        except DataError as error:
            unreadable.append(str(error))
            continue
        page = page_path(file)
        pages.append(WrittenPage(page, summary.complete, summary.cause))
        entries.append(IndexEntry(summary, _relative_url(page, folder)))
    cache.write()
    contents = folder_contents(folder, {index, *map(page_path, files)})
    unreadable += contents.unreadable
    results = [
        ResultEntry(each, _relative_url(each.path, folder)) for each in (*contents.pages, *contents.models)
    ]
    title = f"Runs in {folder.resolve().name or folder}"
    write_page(index_page(title, entries, unreadable, results), index, force=True)
    return FolderReport(index, tuple(pages), tuple(unreadable))


def _links_left_out(folder: Path) -> list[str]:
    """A sentence for each run that is a link out of the folder."""
    links = natural_order(file for file in folder.rglob("*.run.sqlite") if leads_out(file, folder))
    return [f"{file} is a link that leads out of the folder. Report its target by name." for file in links]


def _summary_and_page(file: Path, folder: Path, cache: SummaryCache, force: bool) -> RunSummary:
    """The run's summary, after its page was written unless that is newer than the run."""
    page, state = page_path(file), file_state(file)
    if force or not page.exists() or page.stat().st_mtime <= _modified_s(file):
        run = load_run(file)
        _write_run_page(run, page, _relative_url(folder / LIBRARY, page.parent))
        summary = summary_of(run)
    else:
        known = cache.of(file)
        if known is not None:
            return known
        with stored_run(file, verify=False) as stored:  # its page was made from samples that were verified
            summary = summary_of(stored)
    cache.keep(file, state, summary)
    return summary


def _write_run_page(run: Run, page: Path, library: str) -> None:
    from smarig.report.run_page import run_page  # imported here: not needed where all pages are up to date

    write_page(run_page(run, library=library), page, force=True)


def _modified_s(file: Path) -> float:
    """The time at which a run's file or its journal was last written."""
    journal: Sequence[Path] = (file, file.with_name(file.name + "-wal"))
    return max(path.stat().st_mtime for path in journal if path.exists())


def _relative_url(target: Path, base: Path) -> str:
    """The quoted relative URL from a folder to a file."""
    return quote(Path(os.path.relpath(target, base)).as_posix())
