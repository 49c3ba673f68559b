"""A disk that stops answering ends the run within seconds, and what is said to be stored is stored."""

import os
import re
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from record.runs import META, result, sample, until
from smarig.core import StorageError
from smarig.record import Recorder, load_run, recorder

ROOT = Path(__file__).resolve().parents[2]
SHIM = """
#include <unistd.h>
static int calls;
static int answer(void) { if (++calls > 20) for (;;) sleep(1000); return 0; }
int fsync(int file) { return answer(); }
int fdatasync(int file) { return answer(); }
"""
CHILD = """
import sys, time
from pathlib import Path
from record.runs import META, result, sample
from smarig.core import StorageError
from smarig.record import Recorder, recorder

recorder.CLOSE_LIMIT_S = 1.0
own = Recorder(Path(sys.argv[1]), {**META, "source": "bench"})
started = time.monotonic()
try:
    for tick in range(10_000):
        own.sample(sample(tick), tick // 10, 0.0)
        if tick % 10 == 9:
            own.step(result(tick // 10), branch="rise", target=1.0)
        time.sleep(0.02)
except StorageError as error:
    print(f"{time.monotonic() - started:.1f} {tick}", error, sep="\\n", flush=True)
try:
    own.close("stopped")
except StorageError as error:
    print(error, flush=True)
"""


@pytest.fixture
def stalled(tmp_path, monkeypatch):
    """A recorder of hardware whose second commit hangs until the test releases it."""
    release, entered, commits = threading.Event(), threading.Event(), []
    write_batch = Recorder._write_batch

    def hanging(self, rows, statements):
        commits.append(len(rows))
        if len(commits) > 1:
            entered.set()
            release.wait(20)
        return write_batch(self, rows, statements)

    monkeypatch.setattr(recorder, "STALL_S", 0.5)
    monkeypatch.setattr(recorder, "CLOSE_LIMIT_S", 0.3)
    monkeypatch.setattr(Recorder, "_write_batch", hanging)
    own = Recorder(tmp_path / "a.run.sqlite", {**META, "source": "bench"})
    own.sample(sample(0), 0, 0.0)
    own.step(result(0), branch="rise", target=1.0)
    until(lambda: len(load_run(own.path).steps) == 1)
    own.sample(sample(1), 1, 0.0)
    assert entered.wait(5)
    yield own, release
    release.set()
    own.close()
    own._thread.join(20)


def samples_until_refused(own: Recorder) -> float:
    """Seconds from the first sample of a stalled disk to the refusal."""
    started = time.monotonic()
    for tick in range(2, 10_000):
        own.sample(sample(tick), 1, 0.0)
        time.sleep(0.005)
    return time.monotonic() - started


def test_samples_that_wait_too_long_end_the_run(stalled):
    own, _ = stalled
    started = time.monotonic()
    with pytest.raises(StorageError, match=r"has stored nothing for 0\.5 s. The current is at zero"):
        samples_until_refused(own)
    assert 0.4 < time.monotonic() - started < 3.0


def test_closing_waits_with_a_limit_and_says_what_is_stored(stalled):
    own, _ = stalled
    own.step(result(1), branch="rise", target=2.0)
    with pytest.raises(StorageError, match=r"not be closed in time.*samples up to 0\.0 s and 1 of 2 steps"):
        own.close()
    run = load_run(own.path)
    assert (len(run), len(run.steps), run.complete) == (1, 1, False)


def test_a_disk_that_hangs_after_the_end_is_stored(tmp_path, monkeypatch):
    """The run is closed, and it is said that the disk does not answer: whatever needs it next would hang."""
    release = threading.Event()
    monkeypatch.setattr(recorder, "CLOSE_LIMIT_S", 0.3)
    monkeypatch.setattr(recorder, "leave_one_file", lambda db: release.wait(20))
    own = Recorder(tmp_path / "a.run.sqlite", META)
    own.sample(sample(1), 0, 0.0)
    with pytest.raises(
        StorageError, match=r"end of run .* is stored, but since then the disk does not answer"
    ):
        own.close()
    run = load_run(own.path)
    assert (len(run), run.complete) == (1, True)
    release.set()
    own._thread.join(20)


def test_a_disk_that_answers_again_gets_everything(stalled):
    own, release = stalled
    with pytest.raises(StorageError):
        samples_until_refused(own)
    release.set()
    own.close("stopped")
    run = load_run(own.path)
    assert run.complete
    assert run["tick"].tolist() == list(range(len(run)))
    assert len(run) > 20


def test_a_process_that_was_stopped_goes_on(tmp_path, monkeypatch):
    """The oldest sample is then old as well, but the writer stores it as soon as it runs."""
    own = Recorder(tmp_path / "a.run.sqlite", {**META, "source": "bench"})
    own.sample(sample(0), 0, 0.0)
    own._waiting_since = time.monotonic() - 60.0
    own.sample(sample(1), 0, 0.0)
    own.close()
    assert len(load_run(own.path)) == 2


def test_a_simulation_has_time(tmp_path):
    twin, bench = (Recorder(tmp_path / f"{s}.run.sqlite", {**META, "source": s}) for s in ("twin", "bench"))
    assert twin._stall_s > bench._stall_s == recorder.STALL_S
    twin.close()
    bench.close()


@pytest.mark.skipif(
    shutil.which("gcc") is None or os.name == "nt", reason="needs gcc for a file system that hangs"
)
def test_a_file_system_whose_sync_hangs_loses_nothing_that_is_said_to_be_stored(tmp_path):
    (tmp_path / "shim.c").write_text(SHIM)
    shim = tmp_path / "shim.so"
    subprocess.run(["gcc", "-shared", "-fPIC", "-o", shim, tmp_path / "shim.c"], check=True)
    file = tmp_path / "a.run.sqlite"
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT / "src"), str(ROOT / "tests")])}
    child = subprocess.run(
        [sys.executable, "-c", CHILD, file],
        env={**env, "LD_PRELOAD": str(shim)},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    counted, stalled, not_closed = child.stdout.splitlines()
    assert "the disk has stored nothing for 3 s" in stalled
    t_s, steps, of = map(float, re.search(r"up to ([\d.]+) s and (\d+) of (\d+) steps", not_closed).groups())
    run = load_run(file)
    assert len(run.steps) >= steps > 0
    assert run["t_s"][-1] >= t_s - 0.05 > 0
    assert of == int(counted.split()[1]) // 10
    assert not run.complete
