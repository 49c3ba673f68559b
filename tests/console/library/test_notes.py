"""Tags and notes are lines of a text file that is only ever appended to, by several processes and by hand."""

import json
import os
import subprocess
import sys
import threading
import time

import pytest

from console.library.folders import make_run, refreshed
from full_disk import no_file_beyond
from smarig.console import Library
from smarig.core import StorageError

FILE = "library.notes.jsonl"


@pytest.fixture
def library(tmp_path):
    make_run(tmp_path / "a.run.sqlite")
    return refreshed(tmp_path)


def only(library):
    return library.search().entries[0]


def append(library, text: bytes):
    with (library.folder / FILE).open("ab") as file:
        file.write(text)


def line(library, **changed) -> bytes:
    about = {"epoch": 1.0, "who": "X", "run": only(library).identity, "name": "a"} | changed
    return json.dumps(about).encode()


def test_a_line_says_who_when_and_on_what(library):
    before = time.time()
    library.tag(only(library).id, ["good"], " Ann\n")
    library.note(only(library).id, "Text\nof two lines.", "Bo")
    tagged, noted = (json.loads(text) for text in (library.folder / FILE).read_text("utf-8").splitlines())
    identity = only(library).identity
    assert before <= tagged.pop("epoch") <= noted.pop("epoch") <= time.time()
    assert tagged == {"who": "Ann", "run": identity, "name": "a.run.sqlite", "add": ["good"], "remove": []}
    assert noted == {"who": "Bo", "run": identity, "name": "a.run.sqlite", "note": "Text\nof two lines."}


def test_nothing_is_written_where_nothing_changes(library):
    library.tag(only(library).id, ["good"])
    size = (library.folder / FILE).stat().st_size
    library.tag(only(library).id, [" good "])
    assert (library.folder / FILE).stat().st_size == size
    library.tag(only(library).id, ["Good"])
    assert only(library).tags == ("Good",)


@pytest.mark.parametrize("cut", [1, 2, 10, 60])
def test_a_last_line_that_was_cut_off_costs_only_itself(library, cut):
    library.note(only(library).id, "first")
    library.note(only(library).id, "second")
    file = library.folder / FILE
    file.write_bytes(file.read_bytes()[:-cut])
    whole = ["first", "second"] if cut == 1 else ["first"]  # without its line break, it is whole
    again = Library.open(library.folder)
    assert [note.text for note in only(again).notes] == whole
    again.note(only(again).id, "third")
    assert [note.text for note in only(again).notes] == [*whole, "third"]
    again.rebuild()
    assert [note.text for note in only(again).notes] == [*whole, "third"]
    assert (again.refresh().problems != ()) == (cut > 1)


def test_what_another_program_appends_is_seen_at_once(library):
    library.tag(only(library).id, ["good"])
    append(library, line(library, note="by hand") + b"\n")
    append(library, line(library, add=["by hand"]))
    assert only(library).tags == ("by hand", "good")
    assert [note.text for note in only(library).notes] == ["by hand"]
    library.note(only(library).id, "after")
    assert [note.text for note in only(library).notes] == ["by hand", "after"]


def test_a_file_that_was_edited_is_read_from_its_beginning(library):
    library.note(only(library).id, "wrong")
    library.note(only(library).id, "right")
    file = library.folder / FILE
    file.write_bytes(file.read_bytes().splitlines(keepends=True)[1])
    assert [note.text for note in only(library).notes] == ["right"]
    file.unlink()
    assert only(library).notes == ()


WRONG = [
    b"",
    b"{",
    b"[]",
    b"null",
    b"\xff\x00",
    b"[" * 100_000,
    b'{"epoch": NaN}',
    b"9" * 10_000,
]
WRONG_VALUES = [
    {"run": 3},
    {"run": "../x"},
    {"run": "\ud800"},
    {"epoch": "x"},
    {"epoch": 1e300},
    {"epoch": float("nan")},
    {"add": "abc"},
    {"add": [1]},
    {"add": ["a,b"]},
    {"add": ["x" * 100]},
    {"add": ["\ud800"]},
    {"note": 3},
    {"note": "x" * 20_000},
]


def test_lines_that_are_none_are_left_out_and_counted(library):
    for text in WRONG:
        append(library, text + b"\n")
    for changed in WRONG_VALUES:
        append(
            library, line(library, **{"note": "n", **changed} if "add" not in changed else changed) + b"\n"
        )
    append(library, line(library, note="fine", who="\ud800<b>\x1b") + b"\n")
    found = library.refresh()
    count = len(WRONG) - 1 + len(WRONG_VALUES)
    assert found.problems == (f"{count} line(s) of {FILE} are neither tags nor a note and are left out.",)
    assert [(note.text, note.who) for note in only(library).notes] == [("fine", "\\ud800<b>\\x1b")]
    assert only(library).tags == ()
    assert library.refresh().problems == found.problems


@pytest.mark.skipif(os.name == "nt", reason="links and pipes of POSIX")
@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir, lambda path: path.symlink_to("/etc/passwd")])
def test_what_is_no_file_is_not_written_to(library, make):
    make(library.folder / FILE)
    with pytest.raises(StorageError, match=FILE):
        library.note(only(library).id, "x")
    assert only(library).place == "a.run.sqlite"
    assert any(FILE in sentence for sentence in library.refresh().problems)


def test_a_full_disk_is_one_sentence(library):
    library.note(only(library).id, "first")
    append(library, b" " * 3_000_000 + b"\n")  # so that the library's own files are smaller
    full = no_file_beyond((library.folder / FILE).stat().st_size + 20)
    with full, pytest.raises(StorageError, match=r"notes\.jsonl cannot be written: .*\.$"):
        library.note(only(library).id, "second")
    library.note(only(library).id, "third")
    library.rebuild()
    assert [note.text for note in only(library).notes] == ["first", "third"]


def test_tags_of_two_people_at_once_are_all_kept(library):
    """Each adds to what it saw; nobody's tag removes another's."""
    other, id = Library.open(library.folder), only(library).id
    library.tag(id, ["base"])
    seen = only(other).tags
    library.tag(id, [*seen, "mine"])
    assert other.tag(id, [*only(other).tags, "theirs"]).tags == ("base", "mine", "theirs")


@pytest.mark.long("takes three seconds")
def test_many_threads_and_processes_write_at_once(library):
    id = only(library).id
    words = (
        "import sys; from smarig.console import Library; lib = Library.open(sys.argv[1])\n"
        "for k in range(20): lib.note(sys.argv[2], f'process {k}')"
    )
    child = subprocess.Popen([sys.executable, "-c", words, str(library.folder), id])
    threads = [
        threading.Thread(target=lambda t=t: [library.note(id, f"thread {t} {k}") for k in range(20)])
        for t in range(3)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert child.wait() == 0
    expected = {f"thread {t} {k}" for t in range(3) for k in range(20)} | {f"process {k}" for k in range(20)}
    assert {note.text for note in only(library).notes} == expected
    assert len(only(library).notes) == 80
