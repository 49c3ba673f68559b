"""Files appear whole: nothing else is followed, replaced or left behind, on any file system."""

import os
from pathlib import Path

import pytest

from smarig.core import StorageError, UsageError, atomic_file
from smarig.record import Recorder

pytestmark = pytest.mark.skipif(os.name == "nt", reason="POSIX links and pipes")


def write(path: Path, *, force: bool) -> None:
    with atomic_file(path, force=force) as part:
        part.write_text("all of it")


@pytest.fixture(params=[True, False], ids=["links", "no_links"])
def file_system(request, monkeypatch):
    """One with hard links, and one without."""
    if not request.param:

        def refuse(*_):
            raise OSError(95, "Operation not supported")

        monkeypatch.setattr(os, "link", refuse)


@pytest.mark.usefixtures("file_system")
@pytest.mark.parametrize("force", [False, True])
def test_a_file_appears_whole_and_alone(tmp_path, force):
    path = tmp_path / "a.txt"
    if force:
        path.write_text("old")
    write(path, force=force)
    assert path.read_text() == "all of it"
    assert path.stat().st_nlink == 1
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.usefixtures("file_system")
def test_a_name_that_was_taken_meanwhile_is_kept(tmp_path):
    path = tmp_path / "a.txt"
    with pytest.raises(UsageError, match="exists"), atomic_file(path, force=False):
        path.write_text("another's")
    assert path.read_text() == "another's"
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_that_waits_at_the_former_temporary_name_is_not_followed(tmp_path):
    victim = tmp_path / "victim"
    victim.write_text("measurements of months")
    (tmp_path / "a.txt.part").symlink_to(victim)
    write(tmp_path / "a.txt", force=False)
    assert victim.read_text() == "measurements of months"


def test_names_beside_it_cannot_be_guessed(tmp_path):
    names = set()
    for k in range(20):
        with atomic_file(tmp_path / f"{k}.txt", force=False) as part:
            names.add(part.name.split(".")[-2])
            assert part.parent == tmp_path
    assert len(names) == 20
    assert all(len(name.rpartition("-")[2]) == 16 for name in names)


def test_a_pipe_is_not_replaced(tmp_path):
    path = tmp_path / "a.run.sqlite"
    os.mkfifo(path)
    for attempt in (lambda: write(path, force=True), lambda: Recorder(path, {"rig": "x"}, force=True)):
        with pytest.raises(UsageError, match="not a regular file"):
            attempt()
    assert path.is_fifo()
    assert list(tmp_path.iterdir()) == [path]


def test_a_device_is_not_replaced():
    with pytest.raises(UsageError, match="not a regular file"):
        write(Path(os.devnull), force=True)
    assert Path(os.devnull).is_char_device()


def test_a_long_name_has_room_for_the_one_beside_it(tmp_path):
    path = tmp_path / ("x" * 250)
    write(path, force=False)
    assert path.read_text() == "all of it"


def test_a_block_that_fails_leaves_nothing(tmp_path):
    with pytest.raises(StorageError, match="disk"), atomic_file(tmp_path / "a.txt", force=False):
        raise OSError(28, "disk full")
    assert not list(tmp_path.iterdir())
