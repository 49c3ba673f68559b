"""Each test works in an empty folder. The histories of wires are written there, too."""

import pytest


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SMARIG_HISTORY_DIR", str(tmp_path / "wires"))
