"""File operations that are waited for with a limit, and locks whose folder does not answer."""

import contextlib
import os
import threading
from pathlib import Path

import pytest

from smarig.core import StorageError, check_free, entered_in_time, file_work, in_time, process_lock


@pytest.fixture
def hang():
    """An operation that hangs until the end of the test."""
    release = threading.Event()
    yield lambda *_, **__: release.wait(20)
    release.set()


def test_the_result_and_the_exception_of_the_work_are_those_of_the_call():
    assert in_time(lambda: 7, "a") == 7
    with pytest.raises(FileNotFoundError):
        in_time(Path("/no/such/file").read_text, "a")


def test_work_that_hangs_is_given_up(hang):
    with pytest.raises(StorageError, match=r"^The history: the disk .* has not answered for 0\.05 s"):
        in_time(hang, "The history", limit_s=0.05)


def test_a_context_that_cannot_be_left_is_abandoned(hang):
    @contextlib.contextmanager
    def context():
        yield 7
        hang()

    with entered_in_time(context(), "a", limit_s=0.05) as value:
        assert value == 7


@pytest.mark.skipif(os.name == "nt", reason="flock")
def test_a_lock_is_free_after_its_folder_has_stopped_answering(tmp_path, monkeypatch, hang):
    monkeypatch.setenv("SMARIG_LOCK_DIR", str(tmp_path))
    monkeypatch.setattr(file_work, "LIMIT_S", 0.1)
    with process_lock("run 1", "Run 1 is used", "Wait.", lasting=False):
        monkeypatch.setattr(Path, "unlink", hang)
    check_free("run 1", "Run 1 is used", "Wait.")
