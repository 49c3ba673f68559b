"""kill -9 while recording: the file opens and holds all committed samples in order."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from record.runs import beside, result, sample
from smarig.record import Recorder, load_run

ROOT = Path(__file__).resolve().parents[2]
CHILD = """
import sys
from pathlib import Path
from record.runs import META, result, sample, until
from smarig.record import Recorder, load_run

path = Path(sys.argv[1])
recorder = Recorder(path, META)
for tick in range(1000):
    recorder.sample(sample(tick), 0, 0.0)
recorder.step(result(0), branch="rise", target=1.0)
until(lambda: len(load_run(path).steps) == 1)
print("committed", flush=True)
sys.stdin.readline()
for tick in range(1000, 200000):
    recorder.sample(sample(tick), 1, 0.0)
    if tick == 1500:
        print("writing on", flush=True)
sys.stdin.readline()
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
def test_a_killed_writer_leaves_what_it_committed(tmp_path):
    path = tmp_path / "a.run.sqlite"
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT / "src"), str(ROOT / "tests")])}
    child = subprocess.Popen(
        [sys.executable, "-c", CHILD, str(path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=env,
    )
    with child:
        try:
            assert child.stdout.readline() == "committed\n"
            alive = load_run(path)  # another process reads while the writer lives
            assert (len(alive), len(alive.steps), alive.complete) == (1000, 1, False)
            child.stdin.write("go on\n")
            child.stdin.flush()
            assert child.stdout.readline() == "writing on\n"
        finally:
            child.kill()
    assert child.returncode == -signal.SIGKILL
    left = path.read_bytes()
    run = load_run(path)
    assert path.read_bytes() == left  # reading repairs nothing on its own
    assert run["tick"].tolist() == list(range(len(run)))
    assert len(run) >= 1000
    assert (run["counts"] == 7 * run["tick"]).all()
    assert [s.index for s in run.steps] == [0]
    assert not run.complete
    assert run.cause == "incomplete: the run was never closed"
    assert "incomplete" in repr(run)


def test_the_place_of_a_killed_run_can_be_used_again(tmp_path):
    """--force replaces the file together with its write-ahead log: no ghost of the old run."""
    path = tmp_path / "a.run.sqlite"
    old = Recorder(path, {"rig": "old"})
    old.sample(sample(77), None, 0.0)
    old.step(result(9), branch="x", target=None)
    new = Recorder(path, {"rig": "new"}, force=True)
    new.sample(sample(1), None, 0.0)
    new.close()
    run = load_run(path)
    assert (run.meta["rig"], run["tick"].tolist(), run.steps) == ("new", [1.0], ())
    old.close()
    assert load_run(path)["tick"].tolist() == [1.0]
    assert beside(path) == ["a.run.sqlite"]
