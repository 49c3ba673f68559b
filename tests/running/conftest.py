"""A folder of running runs for each test."""

import pytest


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder in which runs of this test announce themselves."""
    monkeypatch.setenv("SMARIG_RUNNING_DIR", str(tmp_path / "running"))
    monkeypatch.setenv("SMARIG_LOCK_DIR", str(tmp_path / "locks"))
    monkeypatch.setenv("SMARIG_HISTORY_DIR", str(tmp_path / "wires"))
    return tmp_path / "running"
