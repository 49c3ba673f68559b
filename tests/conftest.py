"""What every chapter shares: private locks and wire histories, deterministic properties, others' data."""

import os

os.environ.setdefault(
    "OMP_NUM_THREADS", "1"
)  # before numpy: one worker, one thread, or they fight for the cores
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("ci", derandomize=True, deadline=None, max_examples=60)
settings.load_profile("ci")


@pytest.fixture(scope="session", autouse=True)
def _private_locks(tmp_path_factory):
    """Test processes run side by side: each has its own idea of which wires are in use."""
    os.environ["SMARIG_LOCK_DIR"] = str(tmp_path_factory.mktemp("locks"))
    os.environ["SMARIG_HISTORY_DIR"] = str(tmp_path_factory.mktemp("wires"))


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Measurements by others, beside the repository; tests that need them are skipped without."""
    folder = Path(__file__).resolve().parents[2] / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(
            f"no folder {folder.parent.name}/{folder.name} with others' measurements beside the repository"
        )
    return folder
