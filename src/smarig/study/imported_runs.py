"""Imports the tables of a study as runs, through mapping files that anybody can read and correct."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from smarig.core import DataError, atomic_file
from smarig.exchange import ImportReport, import_file, load_mapping
from smarig.record import ImportFinding, Run, load_run, same_readings
from smarig.study.mapping_draft import mapping_draft
from smarig.study.table_guess import TableGuess


@dataclass(frozen=True, eq=False)
class ImportedTable:
    """A table as a run: its title, the run, and what the import found."""

    title: str
    run: Run
    findings: tuple[ImportFinding, ...]

    @property
    def warnings(self) -> tuple[str, ...]:
        """The findings, one or two sentences each."""
        return tuple(f.text for f in self.findings)


def table_title(guess: TableGuess) -> str:
    """The name of a table: the file's, and that of the table in it."""
    return " ".join(x for x in (file_title(guess.table.path), guess.table.name) if x)


def file_title(path: Path) -> str:
    """The name of a file without its ending; a number there stays, as in loop.001, which is a run of its own.

    >>> file_title(Path("wire.csv")), file_title(Path("loop.001"))
    ('wire', 'loop.001')
    """
    return path.name if path.suffix[1:].isdigit() else path.stem


def import_tables(
    guesses: Sequence[TableGuess], folder: Path, mapping: str | None, name: str
) -> tuple[list[ImportedTable], dict[str, str]]:
    """Import tables into ``folder``/runs with their drafts (or the given mapping), and why others were left out.

    The mapping files are written to ``folder``. Raises DataError if none can be imported.
    """
    texts: dict[str, Path] = {}
    found: list[ImportedTable] = []
    left_out: dict[str, str] = {}
    for number, guess in enumerate(guesses, start=1):
        used = mapping
        if mapping is None and guess.table.format != "forc":
            used = str(_written(mapping_draft(guess, name), folder, texts))
        title = table_title(guess)
        out = folder / "runs" / f"{number:02d}_{_safe(title)}.run.sqlite"
        format_ = guess.table.format if mapping is None else load_mapping(mapping).format
        try:
            report: ImportReport = import_file(
                guess.table.path, format=format_, out=out, mapping=used, force=True
            )
        except DataError as error:
            if len(guesses) == 1:
                raise
            left_out[title] = str(error)
            continue
        run = load_run(report.run)
        copied = next((t.title for t in found if same_readings(t.run, run)), None)
        if copied is not None:
            left_out[title] = f"It holds the readings of {copied}, which would count twice."
            continue
        found.append(ImportedTable(title, run, report.findings))
    if not found:
        raise DataError("No table could be imported: " + " ".join(left_out.values()))
    return found, left_out


def _written(text: str, folder: Path, texts: dict[str, Path]) -> Path:
    """The mapping file of a text; equal texts share one."""
    if text not in texts:
        path = folder / ("mapping.toml" if not texts else f"mapping_{len(texts) + 1}.toml")
        with atomic_file(path, force=True) as part:
            part.write_text(text, encoding="utf-8")
        texts[text] = path
    return texts[text]


def _safe(title: str) -> str:
    return re.sub(r"[^\w.-]+", "_", title)[:80]
