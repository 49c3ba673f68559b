"""Fixtures for import and export: small files, and an import that is read back."""

from pathlib import Path

import pytest

from smarig.exchange import import_file
from smarig.record import load_run


@pytest.fixture
def write(tmp_path):
    """Write text or bytes to a file in a folder of its own; returns the path."""

    def do(content, name="data.csv") -> Path:
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8"))
        return path

    return do


@pytest.fixture
def imported(tmp_path):
    """Import a file and load the run."""

    def do(path, format="csv", **options):
        report = import_file(path, format=format, out=tmp_path / "out.run.sqlite", force=True, **options)
        return load_run(report.run)

    return do


@pytest.fixture
def small_csv():
    """A correct file: two holds of 3 s, ten samples a second."""
    rows = [f"{k / 10},{0.0 if k < 30 else 0.5},{0.001 * (k % 7) + (k >= 30)}" for k in range(60)]
    return "time_s,current_command_A,position_mm\n" + "\n".join(rows) + "\n"
