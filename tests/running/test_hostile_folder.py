"""Whatever lies in the folder of running runs, finders survive it; a run that cannot be announced runs all the same."""

import json
import os
import subprocess
import sys
import time
from contextlib import closing, nullcontext
from pathlib import Path

import pytest

from full_disk import no_file_beyond
from smarig.core import UsageError
from smarig.record import load_run
from smarig.runner import RunControl
from smarig.running import collect_ended, memory_layout, runs_in_progress
from smarig.running.run_in_progress import opened
from tests.running.made import feed, made, sample
from tests.running.runs import files

if os.name == "nt":
    pytest.skip("owners, links and limits of POSIX", allow_module_level=True)
AS_ROOT = pytest.mark.skipif(os.getuid() != 0, reason="only root gives files away")
GOOD = {
    "command": "smarig run",
    "protocol": "p",
    "rig": "r",
    "wire": "w",
    "source": "twin",
    "unit": "mm",
    "out": "/o",
    "place": "",
    "start_epoch": 1.0,
    "period_s": 0.1,
    "duration_s": 1.0,
    "steps": 1,
    "done_steps": 0,
    "done_s": 0.0,
    "pid": 99_999_999,
    "limits": {},
}


def announcement(description=None, state=memory_layout.RUNNING, version=memory_layout.VERSION) -> bytearray:
    """The content of a file that announces a run."""
    content = bytearray(memory_layout.SIZE)
    memory_layout.HEAD.pack_into(content, 0, state, version, memory_layout.RECORDS)
    text = memory_layout.packed_text(
        GOOD if description is None else description, memory_layout.DESCRIPTION_SIZE
    )
    content[memory_layout.DESCRIPTION_AT : memory_layout.DESCRIPTION_AT + len(text)] = text
    return content


@pytest.fixture
def leftover(folder):
    """Writes a file into the folder."""
    folder.mkdir(mode=0o700)

    def write(content: bytes, name: str = "1-x.run-in-progress"):
        (folder / name).write_bytes(content)
        return folder / name

    return write


def held(path):
    """A lock as the process of a run holds it."""
    import fcntl

    file = path.open("r+b")
    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    return closing(file)


def with_text(text: bytes) -> bytearray:
    """An announcement whose description is any text, with the right checksum."""
    import zlib

    content = announcement()
    head = memory_layout.TEXT_HEAD.pack(len(text), zlib.crc32(text))
    content[memory_layout.DESCRIPTION_AT : memory_layout.DESCRIPTION_AT + len(head + text)] = head + text
    return content


HOSTILE = {
    "empty": lambda: b"",
    "cut": lambda: bytes(announcement()[:5000]),
    "too long": lambda: bytes(announcement()) + b"x",
    "zeros": lambda: bytes(memory_layout.SIZE),
    "garbage": lambda: (bytes(range(256)) * (memory_layout.SIZE // 256 + 1))[: memory_layout.SIZE],
    "all ones": lambda: b"\xff" * memory_layout.SIZE,
    "another version": lambda: announcement(version=memory_layout.VERSION + 1),
    "no description": lambda: announcement({}),
    "a list": lambda: with_text(b"[1, 2]"),
    "no JSON": lambda: with_text(b"{"),
    "no text": lambda: with_text(b"\xff\xfe"),
    "deep JSON": lambda: with_text(b"[" * 20_000),
    "long number": lambda: with_text(b'{"pid": ' + b"9" * 10_000 + b"}"),
    "facts of other kinds": lambda: announcement({**GOOD, "start_epoch": "yesterday"}),
    "everybody's process": lambda: announcement({**GOOD, "pid": -1}),
    "one's own group": lambda: announcement({**GOOD, "pid": 0}),
    "true": lambda: announcement({**GOOD, "pid": True}),
}


@pytest.mark.parametrize("kind", HOSTILE)
@pytest.mark.parametrize("locked", [True, False])
def test_what_is_no_announcement_is_left_out(kind, locked, leftover):
    path = leftover(HOSTILE[kind]())
    with held(path) if locked else nullcontext(), made():
        assert [run.info["pid"] for run in runs_in_progress()] == [os.getpid()]
        assert collect_ended() == ()


def test_a_good_announcement_is_found_and_a_dead_one_collected(leftover):
    """So the tests above are refused for what is wrong in them."""
    path = leftover(announcement())
    with held(path):
        assert [run.info for run in runs_in_progress()] == [GOOD]
        assert collect_ended() == ()
    assert runs_in_progress() == ()
    assert [ended.info for ended in collect_ended(older_than_s=time.time() - 2)] == [GOOD]
    assert not path.exists()


def test_a_young_leftover_is_kept_for_whoever_asks(leftover):
    path = leftover(announcement({**GOOD, "start_epoch": time.time() - 60}))
    with made():  # a new run removes only what nobody has asked for in a day
        assert path.exists()
    assert len(collect_ended()) == 1


def test_an_ended_run_whose_file_remained_is_removed_and_not_told_of(leftover):
    path = leftover(announcement(state=memory_layout.ENDED))
    assert runs_in_progress() == ()
    assert collect_ended() == ()
    assert not path.exists()


def test_a_leftover_that_cannot_be_removed_is_told_of_once(leftover, monkeypatch):
    """Windows removes no file that somebody has open."""
    path = leftover(announcement())

    def refused(*_args, **_options):
        raise PermissionError

    with monkeypatch.context() as patch:
        patch.setattr(Path, "unlink", refused)
        assert len(collect_ended()) == 1
        assert collect_ended() == ()
    assert collect_ended() == ()
    assert not path.exists()


def test_links_pipes_and_folders_are_left_out(tmp_path, folder):
    folder.mkdir(mode=0o700)
    outside = tmp_path / "outside"
    outside.write_bytes(announcement())
    (folder / "2-link.run-in-progress").symlink_to(outside)
    (folder / "3-folder.run-in-progress").mkdir()
    os.mkfifo(folder / "4-pipe.run-in-progress")
    (folder / "5-loop.run-in-progress").symlink_to(folder / "5-loop.run-in-progress")
    with held(outside):
        assert runs_in_progress() == ()
        assert collect_ended() == ()
    assert outside.exists()


@AS_ROOT
def test_another_users_file_is_left_out(leftover):
    path = leftover(announcement())
    os.chown(path, 12345, 12345)
    with held(path):
        assert runs_in_progress() == ()
    assert collect_ended() == ()
    assert path.exists()


@AS_ROOT
def test_another_users_folder_is_refused_in_one_sentence(folder):
    folder.mkdir()
    os.chown(folder, 12345, 12345)
    _refused("Other users can write into")


def test_a_folder_that_others_can_write_into_is_refused(leftover, folder):
    with held(leftover(announcement())):
        folder.chmod(0o777)
        _refused("Other users can write into")


def test_a_link_to_a_folder_is_refused(folder, tmp_path):
    (tmp_path / "elsewhere").mkdir(mode=0o700)
    folder.symlink_to(tmp_path / "elsewhere")
    _refused("is not a folder")
    assert files(tmp_path / "elsewhere") == []


def _refused(why: str) -> None:
    assert runs_in_progress() == ()
    assert collect_ended() == ()
    control = RunControl()
    with made(control) as listener:
        feed(listener, 1, 3)
        assert runs_in_progress() == ()
    ((kind, text, level),) = control.reports()
    assert (kind, level) == ("not_announced", "warning")
    assert text.startswith("Other processes cannot see this run. ")
    assert why in text
    assert "SMARIG_RUNNING_DIR" in text


def test_a_file_system_without_space_is_reported_and_leaves_nothing(folder):
    control = RunControl()
    with no_file_beyond(memory_layout.SIZE - 1), made(control) as listener:
        feed(listener, 1, 3)
    ((kind, text, _),) = control.reports()
    assert kind == "not_announced"
    assert "File too large" in text
    assert files(folder) == []


@pytest.mark.long("takes a second")
def test_a_run_without_a_folder_is_recorded_whole_with_one_warning(tmp_path):
    out = tmp_path / "q.run.sqlite"
    command = [
        sys.executable,
        "-m",
        "smarig",
        "run",
        "validation",
        "--rig",
        "one_wire_twin",
        "-o",
        str(out),
        "--json",
    ]
    done = subprocess.run(
        [*command, "--set", "points=2"],
        env={**os.environ, "SMARIG_RUNNING_DIR": "/dev/null/running"},
        capture_output=True,
        text=True,
        check=True,
    )
    told = [json.loads(line)["event"] for line in done.stderr.splitlines() if '"not_announced"' in line]
    (event,) = [e for e in load_run(out).events if e.kind == "not_announced"]
    assert [t["text"] for t in told] == [event.text]
    assert event.level == "warning"
    assert "Not a directory" in event.text


def test_a_folder_that_is_removed_during_a_run_changes_nothing(folder):
    control = RunControl()
    with made(control) as listener:
        feed(listener, 1, 3)
        (run,) = runs_in_progress()
        for path in folder.iterdir():
            path.unlink()
        folder.rmdir()
        feed(listener, 4, 6)
        assert not run.alive
        assert runs_in_progress() == ()
    assert control.reports() == ()


def test_a_file_that_is_cut_while_it_is_read_ends_the_reading(leftover):
    content = announcement()
    memory_layout.WORD.pack_into(content, memory_layout.NEWEST_AT, 10)
    path = leftover(content)
    with held(path), opened(path) as file:
        os.truncate(path, 4096)
        with pytest.raises(UsageError, match="has ended"):
            file.description()
        with pytest.raises(UsageError, match="has ended"):
            file.samples(0)


def test_a_sample_that_cannot_be_stored_ends_the_announcement_of_samples_only():
    control = RunControl()
    with made(control) as listener:
        feed(listener, 1, 3)
        for _ in range(5):
            listener.sample(sample(4, counts="4"), 3, 1.0)
    ((kind, text, _),) = control.reports()
    assert kind == "not_announced"
    assert text.startswith("Other processes do not see further samples of this run.")
