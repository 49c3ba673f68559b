"""A scan reads what has changed and nothing else; runs are followed when they are renamed, moved and copied."""

import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import threading
from contextlib import closing
from pathlib import Path

import pytest

from console.library.folders import contents, make_page, make_run, places, refreshed, settled
from record.runs import META, beside, sample
from smarig.console import Library
from smarig.console.library import found_files, run_content, scan
from smarig.core import process_lock
from smarig.record import Recorder, load_run, recording

LONGER = pytest.mark.long("takes three seconds")

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def reads(monkeypatch):
    """The places of the files that are read."""
    seen = []
    original = scan.read_content
    monkeypatch.setattr(
        scan,
        "read_content",
        lambda folder, found: seen.append(found.place.decode()) or original(folder, found),
    )
    return seen


@pytest.fixture
def folder(tmp_path):
    for k in range(4):
        make_run(tmp_path / f"{k}.run.sqlite", k)
    make_page(tmp_path / "p.html")
    settled_page = tmp_path / "plain.html"
    settled_page.write_text("not from smarig")
    settled(settled_page)
    return tmp_path


def test_only_files_that_changed_are_read(folder, reads):
    library = refreshed(folder)
    assert sorted(reads) == [
        "0.run.sqlite",
        "1.run.sqlite",
        "2.run.sqlite",
        "3.run.sqlite",
        "p.html",
        "plain.html",
    ]
    reads.clear()
    assert library.refresh().unchanged == 6
    make_run(folder / "2.run.sqlite", 2, wire="another")
    make_run(folder / "new" / "5.run.sqlite", 5)
    (folder / "1.run.sqlite").chmod(0o600)
    (folder / "3.run.sqlite").unlink()
    found = Library.open(folder).refresh()
    assert sorted(reads) == ["1.run.sqlite", "2.run.sqlite", "new/5.run.sqlite"]
    assert (found.read, found.removed, found.unchanged) == (3, 1, 3)
    assert places(library, wire="another") == ["2.run.sqlite"]
    assert "3.run.sqlite" not in places(library)


def test_a_change_of_the_same_size_and_time_is_noticed(folder):
    """Another file in the place of one, as a restored backup leaves it."""
    library = refreshed(folder)
    make_run(folder / "x", 9)
    assert (folder / "x").stat().st_size == (folder / "0.run.sqlite").stat().st_size
    (folder / "x").replace(folder / "0.run.sqlite")
    library.refresh()
    assert library.search("0.run").entries[0].began == library.search("3.run").entries[0].began + 6 * 86400


def test_a_file_that_was_just_written_is_read_once_more(tmp_path, reads, monkeypatch):
    """Within the resolution of its time, a file can change without another time."""
    make_run(tmp_path / "a.run.sqlite")
    monkeypatch.setattr(scan, "_FRESH_NS", 10**18)
    library = refreshed(tmp_path)
    library.refresh()
    assert reads == ["a.run.sqlite"] * 2
    monkeypatch.setattr(scan, "_FRESH_NS", 0)
    for _ in range(3):
        library.refresh()
    assert reads == ["a.run.sqlite"] * 3


def test_a_renamed_run_keeps_its_id_and_tags(folder):
    library = refreshed(folder)
    (before,) = library.search("1.run").entries
    library.tag(before.id, ["good"], "Ann")
    (folder / "1.run.sqlite").rename(folder / "renamed.run.sqlite")
    (folder / "sub").mkdir()
    library.refresh()
    assert library.entry(before.id).place == "renamed.run.sqlite"
    (folder / "renamed.run.sqlite").rename(folder / "sub" / "moved.run.sqlite")
    library.refresh()
    found = library.entry(before.id)
    assert (found.place, found.tags) == ("sub/moved.run.sqlite", ("good",))
    assert library.search(tags=["good"]).total == 1


def test_copies_are_two_entries_with_the_same_tags(folder):
    library = refreshed(folder)
    (run,) = library.search("1.run").entries
    library.tag(run.id, ["good"])
    library.note(run.id, "seen")
    settled(Path(shutil.copy(folder / "1.run.sqlite", folder / "z.run.sqlite")))
    library.refresh()
    first, second = library.search(tags=["good"], order="name").entries
    assert (first.place, second.place) == ("1.run.sqlite", "z.run.sqlite")
    assert (first.id, second.id) == (run.id, f"{run.id}-2")
    assert first.notes == second.notes != ()
    library.tag(second.id, ["better"])
    assert library.entry(first.id).tags == ("better",)
    (folder / "1.run.sqlite").unlink()
    library.refresh()
    assert library.entry(run.id).place == "z.run.sqlite"


def test_runs_of_one_session_and_imports_have_identities_of_their_own(tmp_path):
    make_run(tmp_path / "a.run.sqlite", 0)
    make_run(tmp_path / "b.run.sqlite", 0, protocol="validation")
    for name, stroke in (("c", 4.0), ("d", 5.0)):
        make_run(tmp_path / f"{name}.run.sqlite", stroke=stroke, start_epoch=None)
    found = refreshed(tmp_path).search().entries
    assert len({entry.identity for entry in found}) == len(found) == 4


def test_a_run_keeps_its_identity_from_its_first_sample_to_its_end(tmp_path):
    path = tmp_path / "a.run.sqlite"
    library = Library.open(tmp_path)
    recorder = Recorder(path, {**META, "start_epoch": 1.7e9})
    recorder.sample(sample(3), 0, 0.0)
    while not load_run(path)["tick"].size:
        pass
    library.refresh()
    (early,) = library.search().entries
    recorder.sample(sample(4), 0, 0.0)
    recorder.close()
    library.refresh()
    (late,) = library.search().entries
    assert (early.identity, early.details["samples"]) == (late.identity, 1)
    assert (late.details["samples"], late.began) == (2, 1.7e9 + 0.3)


def test_a_run_is_listed_from_its_first_sample_on_and_keeps_its_entry(tmp_path):
    """A page that lists it before would link to an entry that is gone with the next scan."""
    path, library = tmp_path / "a.run.sqlite", Library.open(tmp_path)
    with _recorder(SAMPLE_AT_LEAVE, path) as child:
        assert child.stdout.readline() == "begun\n"
        library.refresh()
        assert not library.search().entries
        print(file=child.stdin, flush=True)
        listed = _first_entry(library)
        assert listed.verdict == "recording"
        print(file=child.stdin, flush=True)
    library.refresh()
    assert library.entry(listed.id).details["samples"] == 1


def test_a_run_that_ended_before_its_first_sample_is_listed(tmp_path, monkeypatch):
    """Its file stays as it is when its recorder dies."""
    Recorder(tmp_path / "a.run.sqlite", {**META, "start_epoch": 1.7e9}).close()
    settled(tmp_path / "a.run.sqlite")
    recorded = _recorded_now(monkeypatch, {"a.run.sqlite"})
    library = refreshed(tmp_path)
    assert not library.search().entries
    recorded.clear()
    library.refresh()
    assert [(entry.name, entry.details["samples"]) for entry in library.search().entries] == [("a", 0)]


def test_a_run_that_is_being_recorded_is_listed_and_not_disturbed(tmp_path):
    """The recorder writes on while the folder is scanned again and again; its file is whole and alone at the end."""
    path = tmp_path / "a.run.sqlite"
    library = Library.open(tmp_path)
    with _recorder(RECORDING, path) as child:
        assert child.stdout.readline() == "begun\n"
        _first_entry(library)
        for _ in range(20):
            library.refresh()
        (entry,) = library.search().entries
        assert (entry.verdict, entry.sentence) == ("recording", "The run is being recorded.")
        assert not entry.details["complete"]
        child.stdin.write("end\n")
        child.stdin.flush()
        assert child.wait() == 0
    assert load_run(path)["tick"].tolist() == list(range(len(load_run(path))))
    assert not [name for name in beside(path) if name.startswith("a.run.sqlite-")]
    library.refresh()
    assert library.search().entries[0].verdict == "bad"  # a few steps of no protocol: interrupted
    assert library.search().entries[0].details["cause"] == "stopped by the test"


def test_a_recorder_that_is_killed_leaves_an_incomplete_run(tmp_path):
    """Its file does not change when it dies."""
    path = tmp_path / "a.run.sqlite"
    library = Library.open(tmp_path)
    with _recorder(RECORDING, path) as child:
        child.stdout.readline()
        child.kill()
    with recording(path):
        pass
    assert library.refresh().read == 1
    (entry,) = library.search().entries
    assert (entry.verdict, entry.details["complete"]) == ("bad", False)


def test_a_state_of_recording_does_not_outlive_the_recorder(folder, monkeypatch):
    """The run's file stays as it is when its lock ends."""
    recorded = _recorded_now(monkeypatch, {"2.run.sqlite"})
    library = refreshed(folder)
    assert places(library, verdict="recording") == ["2.run.sqlite"]
    assert library.refresh().read == 0
    recorded.clear()
    assert library.refresh().read == 1
    assert places(library, verdict="recording") == []


RECORDING = """
import sys, threading, time
from pathlib import Path
from record.runs import META, sample
from smarig.record import Recorder, recording

path = Path(sys.argv[1])
ended = threading.Event()
threading.Thread(target=lambda: (sys.stdin.readline(), ended.set()), daemon=True).start()
with recording(path):
    recorder = Recorder(path, {**META, "start_epoch": 1.7e9})
    tick = 0
    while not ended.is_set():
        recorder.sample(sample(tick), 0, 0.0)
        tick += 1
        if tick == 20:
            print("begun", flush=True)
        time.sleep(0.005)
    recorder.close("stopped by the test")
"""

SAMPLE_AT_LEAVE = """
import sys
from pathlib import Path
from record.runs import META, sample
from smarig.record import Recorder, recording

path = Path(sys.argv[1])
with recording(path):
    recorder = Recorder(path, {**META, "start_epoch": 1.7e9})
    while not path.exists():
        pass
    print("begun", flush=True)
    sys.stdin.readline()
    recorder.sample(sample(3), 0, 0.0)
    sys.stdin.readline()
    recorder.close()
"""


def _recorder(script, path):
    """A process that records a run."""
    return subprocess.Popen(
        [sys.executable, "-c", script, str(path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=_environment(),
    )


def _recorded_now(monkeypatch, names):
    """Take the runs of these names for being recorded, until they are removed from the set that is returned."""
    for module in (scan, run_content):
        monkeypatch.setattr(module, "is_recording", lambda file: file.name in names)
    return names


def _first_entry(library):
    """The entry of the run that is being recorded, as soon as it is listed."""
    while not library.search().entries:
        library.refresh()
    (entry,) = library.search().entries
    return entry


def _environment():
    return {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT / "src"), str(ROOT / "tests"), str(ROOT)])}


def test_a_damaged_run_is_an_entry_with_a_sentence(folder):
    path = folder / "2.run.sqlite"
    with closing(sqlite3.connect(path)) as db, db:
        db.execute("UPDATE sample SET position = 7 WHERE tick = 1")
    (folder / "3.run.sqlite").write_bytes((folder / "3.run.sqlite").read_bytes()[:5000])
    (folder / "empty.run.sqlite").touch()
    (folder / "text.model.json").write_text("{")
    library = refreshed(folder)
    found = {entry.place: entry.error for entry in library.search(verdict="unreadable").entries}
    assert set(found) == {"2.run.sqlite", "3.run.sqlite", "empty.run.sqlite", "text.model.json"}
    assert all(sentence.endswith(".") and str(folder) not in sentence for sentence in found.values())
    assert "is damaged" in found["2.run.sqlite"]
    make_run(path, 2)
    library.refresh()
    assert library.search("2.run").entries[0].verdict == "good"


def test_an_error_of_the_reader_itself_is_an_entry(folder, monkeypatch):
    from smarig.console.library import run_content

    def broken(run):
        raise RecursionError("too deep")

    monkeypatch.setattr(run_content, "run_assessment", broken)
    library = refreshed(folder)
    assert {entry.error for entry in library.search(kind="run").entries} == {
        f"{k}.run.sqlite cannot be read: RecursionError: too deep." for k in range(4)
    }


HOSTILE_NAMES = [
    b"a\nb",
    b"\x1b[2J",
    b"\xff\xfe",
    b"<script>alert(1)<",
    b"x" * 150,
    b"'; DROP TABLE entry; --",
    "ä\u202e".encode(),
]


@pytest.mark.skipif(os.name == "nt", reason="names of POSIX")
@pytest.mark.parametrize("name", HOSTILE_NAMES)
def test_names_can_be_anything(tmp_path, name):
    source = make_run(tmp_path / "a.run.sqlite", cycles=1)
    inside = tmp_path / os.fsdecode(name)
    inside.mkdir()
    for ending in (b".run.sqlite", b".html", b".model.json"):
        shutil.copyfile(source, inside / os.fsdecode(name + ending))
    make_page(inside / "page.html")
    library = refreshed(tmp_path)
    found = library.search(limit=100).entries
    assert len(found) == 4
    assert all(entry.place.isprintable() and entry.name.isprintable() for entry in found)
    run = next(entry for entry in found if entry.kind == "run" and entry.place != "a.run.sqlite")
    assert (run.verdict, run.path.is_file()) == ("good", True)
    assert run.figures["stroke"].unit == "mm"
    library.tag(run.id, ["t"])
    assert {entry.place for entry in library.search(tags=["t"]).entries} == {"a.run.sqlite", run.place}
    assert library.refresh().removed == 0


@pytest.mark.skipif(os.name == "nt", reason="names of POSIX")
def test_a_name_to_which_nothing_can_be_added_is_an_entry(tmp_path):
    """SQLite cannot name a journal beside it."""
    shutil.copyfile(make_run(tmp_path / "a"), tmp_path / ("x" * 244 + ".run.sqlite"))
    (entry,) = refreshed(tmp_path).search().entries
    assert (entry.verdict, entry.kind) == ("unreadable", "run")
    assert "File name too long" in entry.error


@pytest.mark.skipif(os.name == "nt", reason="links and pipes of POSIX")
def test_links_pipes_and_loops_end(tmp_path):
    make_run(tmp_path / "in" / "a.run.sqlite")
    (tmp_path / "in" / "loop").symlink_to(tmp_path)
    (tmp_path / "self").symlink_to(tmp_path / "self")
    os.mkfifo(tmp_path / "pipe.run.sqlite")
    os.mkfifo(tmp_path / "pipe.html")
    (tmp_path / "folder.run.sqlite").mkdir()
    (tmp_path / "null.run.sqlite").symlink_to("/dev/zero")
    (tmp_path / "dangling.html").symlink_to(tmp_path / "nothing")
    (tmp_path / "link.run.sqlite").symlink_to(tmp_path / "in" / "a.run.sqlite")
    (tmp_path / ".hidden").mkdir()
    make_run(tmp_path / ".hidden" / "b.run.sqlite")
    library = refreshed(tmp_path)
    assert sorted(places(library)) == ["in/a.run.sqlite", "link.run.sqlite"]


def test_folders_in_folders_end(tmp_path):
    deep = tmp_path.joinpath(*["d"] * (found_files.DEEPEST + 5))
    make_run(deep / "a.run.sqlite")
    make_run(deep.parents[5] / "b.run.sqlite")
    assert len(places(refreshed(tmp_path))) == 1


def test_more_names_than_any_folder_has_are_left_out(folder, monkeypatch):
    monkeypatch.setattr(found_files, "MOST_NAMES", 3)
    found = Library.open(folder).refresh()
    assert found.problems == ("The folder has more than 3 files; the rest is left out.",)
    assert found.read <= 3


OTHER_FILES = 100_000 if os.environ.get("SMARIG_LONG") else 20_000


@pytest.mark.long("takes three seconds")
def test_many_other_files_are_not_opened(tmp_path, reads):
    names = [tmp_path / f"{k}.csv" for k in range(OTHER_FILES)]
    for name in names:
        os.close(os.open(name, os.O_CREAT))
    make_run(tmp_path / "a.run.sqlite")
    library = refreshed(tmp_path)
    assert (reads, places(library)) == (["a.run.sqlite"], ["a.run.sqlite"])
    for name in names:
        name.unlink()


@pytest.mark.skipif(not hasattr(os, "getuid") or os.getuid() == 0, reason="root reads every folder")
def test_a_folder_that_cannot_be_read_is_told(folder):
    make_run(folder / "shut" / "a.run.sqlite")
    (folder / "shut").chmod(0)
    found = Library.open(folder).refresh()
    (folder / "shut").chmod(0o700)
    assert found.problems == ("Folder shut/ cannot be read: Permission denied.",)


def test_a_scan_can_be_stopped_and_goes_on_where_it_was(folder, monkeypatch):
    monkeypatch.setattr(scan, "_BATCH_FILES", 1)
    stop, seen = threading.Event(), []
    library = Library.open(folder)
    found = library.refresh(
        stop, lambda done, total: seen.append((done, total)) or (done == 2 and stop.set())
    )
    assert (found.read, found.stopped, seen) == (2, True, [(1, 6), (2, 6)])
    found = library.refresh(threading.Event())
    assert (found.read, found.unchanged, found.stopped) == (4, 2, False)


def test_one_process_scans_and_the_others_read(folder):
    library = refreshed(folder)
    make_run(folder / "9.run.sqlite", 9)
    with process_lock(f"library {folder}", "It is being scanned", "Wait."):
        assert library.refresh().elsewhere
        assert library.rebuild().elsewhere
        assert library.search().total == 5
        library.tag(library.search().entries[0].id, ["meanwhile"])
    assert library.refresh().read == 1
    assert library.search(tags=["meanwhile"]).total == 1


KILLED = """
import sys
from smarig.console import Library
from smarig.console.library import scan

scan._BATCH_FILES = 1
Library.open(sys.argv[1]).refresh(progress=lambda done, total: print(done, flush=True))
"""


@pytest.mark.long("takes two seconds", cases=("3",))
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
@pytest.mark.parametrize("after", [pytest.param(1, marks=LONGER), 3, pytest.param(5, marks=LONGER)])
def test_a_scan_that_is_killed_loses_at_most_what_it_was_reading(folder, after):
    with subprocess.Popen(
        [sys.executable, "-c", KILLED, str(folder)], stdout=subprocess.PIPE, text=True, env=_environment()
    ) as child:
        for line in child.stdout:
            if int(line) == after:
                child.kill()
                break
    library = Library.open(folder)
    found = library.refresh()
    assert found.read <= 6 - after
    once = contents(library)
    library.rebuild()
    assert contents(library) == once


@pytest.mark.long("takes five seconds")
def test_two_processes_at_once_both_find_everything(folder):
    """Both scan and search until each has found all of it."""
    for k in range(4, 24):
        make_run(folder / f"{k}.run.sqlite", k)
    words = (
        "import sys; from smarig.console import Library; lib = Library.open(sys.argv[1])\n"
        "while lib.search(kind='run').total < 24: lib.refresh()\n"
        "e = lib.search('7.run').entries[0]; lib.note(e.id, sys.argv[2])\n"
    )
    children = [
        subprocess.Popen(
            [sys.executable, "-c", words, str(folder), who],
            stderr=subprocess.PIPE,
            text=True,
            env=_environment(),
        )
        for who in ("one", "two")
    ]
    assert [child.communicate()[1] for child in children] == ["", ""]
    library = Library.open(folder)
    assert {note.text for note in library.search("7.run").entries[0].notes} == {"one", "two"}
