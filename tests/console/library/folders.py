"""Folders for tests of the library: runs of a wire with full loops, and what the library's tables hold."""

import contextlib
import os
import shutil
import sqlite3
from pathlib import Path

import numpy as np

from smarig.console import Library
from smarig.record import write_run
from smarig.report.components.html import paragraph
from smarig.report.components.page import Section, page
from smarig.report.components.page_summary import PageSummary

FROZEN = Path(__file__).resolve().parents[2] / "frozen" / "old_files"
EPOCH = 1_790_000_000.0
DAY_S = 86400.0
LONG_AGO_S = 1_700_000_000


def make_run(path: Path, day: float = 0.0, *, stroke: float = 5.0, cycles: int = 0, **meta: object) -> Path:
    """A run of full heating cycles on that day, or of four samples that give no figures.

    Its last change is long ago, so that it need not be read twice.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    points = 120 if cycles else 2
    up = np.linspace(0.0, 100.0, points)
    u = np.tile(np.concatenate([up, up[::-1]]), max(cycles, 1))
    rising = np.tile(np.repeat([True, False], points), max(cycles, 1))
    y = stroke / (1 + np.exp(-(u - np.where(rising, 60.0, 40.0)) / 4.0))
    n = np.arange(u.size)
    described = {
        "source": "bench",
        "protocol": "constant_force_cycles",
        "rig": "bench_one_wire",
        "wire": "spool 7",
        "start_epoch": EPOCH + day * DAY_S,
        "seed": 0,
        "settings": {"points": "120"},
        "input": {"quantity": "wire temperature above ambient", "unit": "K"},
        "output": {"quantity": "displacement", "unit": "mm"},
    }
    y = y + 0.002 * np.random.default_rng(5).standard_normal(u.size)
    columns = {"tick": n, "t_s": 0.1 * n, "input": u, "position": y, "quality": 0 * n}
    write_run(path, described | meta, columns, [], force=True)
    return settled(path)


def make_page(
    path: Path, kind: str = "study", sentence: str = "The model is good.", level: str = "good"
) -> Path:
    """A page that smarig wrote."""
    summary = PageSummary(kind, sentence, level, np.array([0.0, 1.0]), np.array([0.0, 2.0]), ("K", "mm"))
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(
        page("A title", "lead", [Section("One", "One", [paragraph("text")])], summary=summary), "utf-8"
    )
    return settled(path)


def make_model(path: Path, name: str = "one_wire_exponential") -> Path:
    """A model file of an earlier version."""
    path.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(FROZEN / "models" / f"{name}.model.json", path)
    return settled(path)


def settled(path: Path) -> Path:
    """The file as if it had last been written long ago."""
    os.utime(path, (LONG_AGO_S, LONG_AGO_S))
    return path


def refreshed(folder: Path) -> Library:
    """The library of a folder after a scan."""
    library = Library.open(folder)
    library.refresh()
    return library


def contents(library: Library) -> dict[str, list[tuple]]:
    """All rows of the library but how far its files were read."""
    with contextlib.closing(sqlite3.connect(library.folder / "library.sqlite")) as db:
        rows = {
            table: sorted(db.execute(f"SELECT * FROM {table}").fetchall(), key=repr)
            for table in ("entry", "content", "tag")
        }
        rows["note"] = db.execute("SELECT * FROM note ORDER BY rowid").fetchall()
        rows["seen"] = sorted(db.execute("SELECT place, recording FROM seen").fetchall())
    return rows


def places(library: Library, **question: object) -> list[str]:
    """The places of the entries that a search finds."""
    return [entry.place for entry in library.search(**question, limit=1000).entries]
