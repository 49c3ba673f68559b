"""Every test has a folder of announcements of its own, which its processes use too."""

from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def running_dir(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "running"
    monkeypatch.setenv("SMARIG_RUNNING_DIR", str(folder))
    monkeypatch.setenv("SMARIG_LOCK_DIR", str(tmp_path / "locks"))
    monkeypatch.setenv("SMARIG_HISTORY_DIR", str(tmp_path / "wires"))
    return folder
