"""A run file opens whatever instant its recorder was killed at, and where nothing can be written."""

import contextlib
import os
import signal
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from record.runs import META, beside, sample
from smarig.core import DataError, UsageError
from smarig.record import Recorder, load_run
from smarig.record.continuation import opened_for_recording
from smarig.record.new_run_file import new_run_file

ROOT = Path(__file__).resolve().parents[2]
ENV = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT / "src"), str(ROOT / "tests")])}
KILLED_IN_A_TRANSACTION = """
import os, sqlite3, sys
db = sqlite3.connect(sys.argv[1], isolation_level=None)
db.execute("PRAGMA cache_size=1")  # changed pages reach the file before the commit
db.execute("BEGIN")
db.execute("UPDATE sample SET position = 999.0")
os.kill(os.getpid(), 9)
"""
KILLED_WHILE_RECORDING = """
import os, sys, time
from pathlib import Path
from record.runs import META, sample, until
from smarig.record import Recorder, load_run
own = Recorder(Path(sys.argv[1]), META)
for tick in range(300):
    own.sample(sample(tick), 0, 0.0)
until(lambda: len(load_run(own.path)) == 300)
os.kill(os.getpid(), 9)
"""
KILLED_AT_A_CALL = """
import os, sys
from pathlib import Path
calls, deadly = 0, int(sys.argv[2])
def kill(event, arguments):
    global calls
    if event in ("open", "os.link", "os.remove", "os.rename", "sqlite3.connect") and "a.run" in str(arguments):
        calls += 1
        if calls == deadly:
            os.kill(os.getpid(), 9)
from record.runs import META
from smarig.record import Recorder
sys.addaudithook(kill)
Recorder(Path(sys.argv[1]), META).close()
print(calls)
"""

pytestmark = pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")


def killed(code: str, *arguments: object) -> subprocess.CompletedProcess:
    """A child that executes this code."""
    command = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.run(command, env=ENV, capture_output=True, text=True, timeout=60, check=False)


@pytest.fixture
def finished(tmp_path) -> Path:
    path = tmp_path / "a.run.sqlite"
    own = Recorder(path, META)
    for tick in range(500):
        own.sample(sample(tick), 0, 0.0)
    own.close()
    return path


def test_a_hot_journal_is_applied_and_the_folder_stays_as_it_is(finished):
    before = load_run(finished)["position"]
    assert killed(KILLED_IN_A_TRANSACTION, finished).returncode == -signal.SIGKILL
    assert beside(finished) == ["a.run.sqlite", "a.run.sqlite-journal"]
    damaged = finished.read_bytes()
    assert load_run(finished)["position"].tolist() == before.tolist()
    assert finished.read_bytes() == damaged
    assert beside(finished) == ["a.run.sqlite", "a.run.sqlite-journal"]


@pytest.mark.parametrize("with_shm", [True, False])
def test_a_killed_run_is_read_from_a_medium_that_cannot_be_written(tmp_path, with_shm):
    path, mount = tmp_path / "a.run.sqlite", tmp_path / "read_only"
    assert killed(KILLED_WHILE_RECORDING, path).returncode == -signal.SIGKILL
    if not with_shm:
        path.with_name(path.name + "-shm").unlink()
    with mounted_read_only(tmp_path, mount):
        run = load_run(mount / path.name)
    assert run["tick"].tolist() == list(range(300))
    assert not run.complete


def test_a_killed_run_without_its_empty_log_is_read_from_a_medium_that_cannot_be_written(tmp_path):
    """Its file still tells SQLite to look for a log."""
    path, mount = tmp_path / "a.run.sqlite", tmp_path / "read_only"
    assert killed(KILLED_WHILE_RECORDING, path).returncode == -signal.SIGKILL
    with contextlib.closing(sqlite3.connect(path)) as db:
        db.execute("SELECT count(*) FROM sample").fetchone()  # merges the log at the end, as WAL mode stays
    assert beside(path) == [path.name]
    with mounted_read_only(tmp_path, mount):
        run = load_run(mount / path.name)
    assert run["tick"].tolist() == list(range(300))


@contextlib.contextmanager
def mounted_read_only(folder: Path, mount: Path):
    """The folder at another place, where nothing can be written."""
    mount.mkdir()
    options = (["--bind", folder, mount], ["-o", "remount,ro,bind", mount])
    if any(subprocess.run(["mount", *o], check=False, capture_output=True).returncode for o in options):
        pytest.skip("this user may not mount a read-only folder")
    try:
        yield
    finally:
        subprocess.run(["umount", mount], check=True)


def test_what_is_no_run_stays_none_with_a_sidecar(tmp_path):
    path = tmp_path / "a.run.sqlite"
    path.write_bytes(b"no database at all" * 100)
    path.with_name(path.name + "-journal").write_bytes(b"\xd9\xd5\x05\xf9" * 200)
    with pytest.raises(DataError, match="is not a run file"):
        load_run(path)


def test_a_recorder_killed_at_any_call_of_its_creation_leaves_a_whole_file_or_none(tmp_path):
    """So the name is not taken by a file without tables."""
    calls = int(killed(KILLED_AT_A_CALL, tmp_path / "a.run.sqlite", 0).stdout)
    assert calls >= 5
    for deadly in range(1, calls + 1):
        path = tmp_path / str(deadly) / "a.run.sqlite"
        assert killed(KILLED_AT_A_CALL, path, deadly).returncode == -signal.SIGKILL
        if path.exists():
            assert load_run(path).meta["rig"] == META["rig"]
        else:
            Recorder(path, META).close()


def test_a_name_taken_meanwhile_is_not_replaced(tmp_path, monkeypatch):
    """Two recorders that start at once: one gets the name, the other a sentence."""
    path = tmp_path / "a.run.sqlite"
    connect = sqlite3.connect

    def taken(*arguments, **settings):
        path.write_bytes(b"another run")
        monkeypatch.setattr(sqlite3, "connect", connect)
        return connect(*arguments, **settings)

    monkeypatch.setattr(sqlite3, "connect", taken)
    with pytest.raises(UsageError, match="exists"):
        Recorder(path, META)
    assert path.read_bytes() == b"another run"
    assert beside(path) == ["a.run.sqlite"]


def test_a_recorder_whose_file_was_replaced_never_writes_into_the_new_one(tmp_path):
    """Even if it has not stored anything before."""
    path = tmp_path / "a.run.sqlite"
    description = {"schema_version": 1, **META}
    with new_run_file(path, description, force=False):
        pass
    old = opened_for_recording(path)
    with new_run_file(path, description, force=True):
        pass
    new = opened_for_recording(path)
    with contextlib.closing(old), contextlib.closing(new):
        for db, tick in ((new, 1), (old, 77)):
            with db:
                db.execute("INSERT INTO sample (tick) VALUES (?)", (tick,))
        assert new.execute("SELECT tick FROM sample").fetchall() == [(1,)]
