"""Whatever lies in the folder of announcements, looking for runs neither fails nor touches it."""

import fcntl
import json
import mmap
import os
import struct
import zlib

import pytest

from smarig.running import collect_ended, runs_in_progress
from smarig.running.shared_memory import _DESCRIPTION, SIZE, SharedMemory

GOOD = {
    "pid": 4_000_000,
    "start_epoch": 1.7e9,
    "protocol": "p",
    "rig": "r",
    "wire": "w",
    "source": "twin",
    "out": "/tmp/a.run.sqlite",
}


def _memory(path, info=GOOD, change=lambda _: None):
    path.write_bytes(bytes(SIZE))
    with path.open("r+b") as file:
        raw = mmap.mmap(file.fileno(), SIZE)
        SharedMemory(raw).prepare(GOOD)
        text = json.dumps(info).encode()
        struct.pack_into("@II", raw, _DESCRIPTION, len(text), zlib.crc32(text))
        raw[_DESCRIPTION + 8 : _DESCRIPTION + 8 + len(text)] = text
        change(raw)


@pytest.fixture
def held(running_dir):
    """A file whose lock is held as by a run, beside what a test adds."""
    running_dir.mkdir(mode=0o700)
    path = running_dir / "400-good.run-in-progress"
    _memory(path)
    with path.open("r+b") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield path


def _wrong_version(raw):
    raw[8] = 99


LEFTOVERS = {
    "link": lambda p: p.symlink_to("/etc/passwd"),
    "link to nowhere": lambda p: p.symlink_to("nowhere"),
    "link to itself": lambda p: p.symlink_to(p),
    "link to a run": lambda p: p.symlink_to(p.with_name("400-good.run-in-progress")),
    "empty": lambda p: p.touch(),
    "cut": lambda p: (_memory(p), os.truncate(p, 5000)),
    "longer": lambda p: (_memory(p), os.truncate(p, SIZE + 1)),
    "garbage": lambda p: p.write_bytes(os.urandom(SIZE)),
    "zeros": lambda p: p.write_bytes(bytes(SIZE)),
    "fifo": lambda p: os.mkfifo(p),
    "folder": lambda p: p.mkdir(),
    "wrong version": lambda p: _memory(p, change=_wrong_version),
    "unreadable": lambda p: (_memory(p, {}), p.chmod(0)),
    "a list": lambda p: _memory(p, [1, 2]),
    "no facts": lambda p: _memory(p, {}),
    "deep": lambda p: _memory(p, change=lambda raw: _deep(raw)),
    "its own group": lambda p: _memory(p, GOOD | {"pid": 0}),
    "all processes": lambda p: _memory(p, GOOD | {"pid": -1}),
    "process true": lambda p: _memory(p, GOOD | {"pid": True}),
    "no time": lambda p: _memory(p, GOOD | {"start_epoch": float("nan")}),
    "far time": lambda p: _memory(p, GOOD | {"start_epoch": 1e300}),
    "no name": lambda p: _memory(p, GOOD | {"rig": None}),
}


def _deep(raw):
    text = b"[" * 8000
    struct.pack_into("@II", raw, _DESCRIPTION, len(text), zlib.crc32(text))
    raw[_DESCRIPTION + 8 : _DESCRIPTION + 8 + len(text)] = text


@pytest.mark.parametrize("name", LEFTOVERS)
def test_what_is_no_announcement_is_left_out_and_left_alone(held, name):
    path = held.with_name("401-bad.run-in-progress")
    LEFTOVERS[name](path)
    assert [run.key for run in runs_in_progress()] == ["400-good"]
    assert collect_ended() == ()
    assert os.path.lexists(path)


@pytest.mark.parametrize("name", ["a b", "x", "5-<b>", "5-a%2fb", "5-a?b", "5-é", "../5-a"])
def test_names_that_runs_do_not_have_are_left_out(held, name):
    held.rename(held.parent / f"{name}.run-in-progress")
    assert runs_in_progress() == ()


@pytest.mark.parametrize("place", ["missing", "a file", "open to others", "a link"])
def test_a_folder_that_is_not_this_users_own_holds_no_runs(held, place, monkeypatch):
    folder = held.parent
    if place == "missing":
        monkeypatch.setenv("SMARIG_RUNNING_DIR", str(folder / "missing"))
    elif place == "a file":
        monkeypatch.setenv("SMARIG_RUNNING_DIR", str(held))
    elif place == "open to others":
        folder.chmod(0o777)
    else:
        folder.with_name("link").symlink_to(folder)
        monkeypatch.setenv("SMARIG_RUNNING_DIR", str(folder.with_name("link")))
    assert runs_in_progress() == collect_ended() == ()


def test_a_thousand_files_do_not_hide_a_run(held):
    for k in range(1200):
        (held.parent / f"{k}-junk.txt").touch()
    assert [run.key for run in runs_in_progress()] == ["400-good"]
