"""A Python file of the present folder is never a module of a process that smarig starts there."""

import os
import subprocess
import sys

import pytest

from smarig.cli import run as cli
from smarig.live.viewer_process import parent_death_signal
from smarig.study.parallel import completed

NAMES = ("simulators", "multiprocessing", "ctypes", "random", "socket", "click", "numpy")


@pytest.fixture
def executed(tmp_path, monkeypatch):
    """A folder with files of the names of modules; the file that any of them would write."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
    mark = tmp_path / "executed"
    for name in NAMES:
        (tmp_path / f"{name}.py").write_text(f"open({str(mark)!r}, 'a').write({name!r})\n")
    return mark


def test_by_simulated_devices(executed):
    assert (
        cli(["run", "validation", "--rig", "one_wire_serial", "--set", "points=2", "-o", "a.run.sqlite"]) == 0
    )
    assert not executed.exists()


def test_by_workers_of_a_study(executed):
    assert sorted(completed(abs, [-1, -2, -3], 2)) == [1, 2, 3]
    assert not executed.exists()
    assert "PYTHONSAFEPATH" not in os.environ, "what the caller starts later is not concerned"


@pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="the kernel of Linux ends a viewer with its parent"
)
def test_by_a_viewer(executed):
    became = subprocess.run(
        [*parent_death_signal(), sys.executable, "-P", "-c", "print('viewer')"],
        capture_output=True,
        text=True,
        env=os.environ,
    )
    assert became.stdout == "viewer\n", became.stderr
    assert not executed.exists()
