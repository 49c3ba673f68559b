"""A disk that fails at any call of a run file's life: nothing acknowledged is lost, nothing untrue is said, and what
is left opens, also where nothing can be written.

The disk is a library in front of the C library: faults/faulty_disk.c. By default a sample of all faults; all of them
with SMARIG_LONG.
"""

import json
import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

from record.faults.kinds import CUTS, KILLS, LIVE, THEN_CUT, built, missing
from record.faults.power_cut import LINK, OPEN, SYNC, UNLINK, WRITE, Call, Disk

ROOT = Path(__file__).resolve().parents[2]
LONG = bool(os.environ.get("SMARIG_LONG"))
SHARES = {"errors": 0.02}  # by default
GROUPS = {
    "errors": tuple(kind for kind in LIVE if kind not in KILLS),
    "kills": KILLS,
    "power cuts": (*CUTS, *THEN_CUT),
}

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "-")


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return built(tmp_path_factory.mktemp("library"))


@pytest.mark.parametrize("group", GROUPS)
def test_what_is_acknowledged_is_kept_and_what_is_said_is_true(library, tmp_path, group):
    env = {**os.environ, "LD_PRELOAD": str(library), "OMP_NUM_THREADS": "1"}
    paths = [str(ROOT / "src"), str(ROOT / "tests")]
    share = str(1.0 if LONG else SHARES.get(group, 0.04))
    words = [sys.executable, "-m", "record.faults.campaign", tmp_path / "disk", share, *GROUPS[group]]
    done = subprocess.run(
        words,
        env={**env, "PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True,
        text=True,
        timeout=7200 if LONG else 600,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    print({key: value for key, value in told.items() if key != "wrong"})
    assert told["wrong"] == []
    assert told["injections"] >= (500 if LONG else 30)
    assert told["calls"] > 200
    if group == "kills" and LONG:
        assert told["kills"]["creation"] >= 40
        assert told["kills"]["closing"] >= 40
        assert told["kills"]["between"] >= 100


FOLDER = Path("/disk")


def opened(name: str, file: int, *, new: bool) -> Call:
    return Call(OPEN, file, int(new), f"/disk/{name}".encode() if name else b"/disk", b"", 0)


def written(file: int, data: bytes, at: int = 0) -> Call:
    return Call(WRITE, file, at, data, b"", 0)


def synced(file: int, error: int = 0) -> Call:
    return Call(SYNC, file, error, b"", b"", 0)


def left(tmp_path, calls: list[Call], how: str, seed: int = 1) -> dict[str, bytes]:
    disk = Disk(FOLDER)
    for call in calls:
        disk.apply(call)
    out = tmp_path / f"{how[-6:]}{seed}"
    out.mkdir()
    disk.leave(out, how, random.Random(seed))
    return {p.name: p.read_bytes() for p in out.iterdir()}


SYNCED, SOME, TORN, ALL = CUTS
NEW = [opened("a", 3, new=True), written(3, b"1" * 8192)]
FOLDER_SYNCED = [opened("", 4, new=False), synced(4)]


def test_the_model_of_a_power_cut(tmp_path):
    """The faults must be those of disks: else the campaign would show nothing."""
    assert left(tmp_path, NEW, SYNCED) == {}
    assert left(tmp_path, NEW, ALL) == {"a": b"1" * 8192}
    assert left(tmp_path, [*NEW, *FOLDER_SYNCED], SYNCED, 2) == {"a": b""}
    kept = [*NEW, synced(3), *FOLDER_SYNCED]
    assert left(tmp_path, kept, SYNCED, 3) == {"a": b"1" * 8192}
    changed = [*kept, written(3, b"2" * 8192)]
    assert left(tmp_path, changed, SYNCED, 4) == {"a": b"1" * 8192}
    some = {left(tmp_path, changed, SOME, seed)["a"] for seed in range(20)}
    assert some == {a * 4096 + b * 4096 for a in (b"1", b"2") for b in (b"1", b"2")}
    assert any(len(set(left(tmp_path, changed, TORN, seed)["a"][:4096])) == 2 for seed in range(5))
    assert left(tmp_path, [*changed, synced(3, error=5), synced(3)], SYNCED, 5) == {"a": b"1" * 8192}


def test_names_after_a_power_cut(tmp_path):
    """A link or a removal is there or not until the folder is synced."""
    linked = [*NEW, synced(3), *FOLDER_SYNCED, Call(LINK, 0, 0, b"/disk/a", b"/disk/b", 0)]
    removed = [*linked, Call(UNLINK, 0, 0, b"/disk/a", b"", 0)]
    assert set(left(tmp_path, removed, SYNCED)) == {"a"}
    found = {tuple(sorted(left(tmp_path, removed, SOME, seed))) for seed in range(20)}
    assert found == {("a",), ("a", "b"), ("b",)}
    assert set(left(tmp_path, [*removed, *FOLDER_SYNCED], SYNCED, 2)) == {"b"}
