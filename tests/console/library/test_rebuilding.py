"""The library can be made again from the files at any time, and is then the same; tags and notes are never lost."""

import contextlib
import os
import shutil
import sqlite3
import tempfile
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from console.library.folders import (
    LONG_AGO_S,
    contents,
    make_model,
    make_page,
    make_run,
    places,
    refreshed,
    settled,
)
from record.runs import edited
from smarig.console import Library
from smarig.console.library import database
from smarig.core import DataError, StorageError, UsageError

DB = "library.sqlite"
NAMES = ("a", "b", "sub/c", "sub/deeper/d", "e\nf", "g")


def _run(folder, name) -> Path:
    path = folder / f"{NAMES[name % len(NAMES)]}.run.sqlite"
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def _make(library, a, b):
    make_run(_run(library.folder, a), b, wire=f"spool {b % 2}")


def _rename(library, a, b):
    if _run(library.folder, a).exists():
        _run(library.folder, a).rename(_run(library.folder, b))


def _copy(library, a, b):
    if _run(library.folder, a).exists() and a % len(NAMES) != b % len(NAMES):
        shutil.copy(_run(library.folder, a), _run(library.folder, b))


def _remove(library, a, b):
    _run(library.folder, a).unlink(missing_ok=True)


def _damage(library, a, b):
    path = _run(library.folder, a)
    if path.exists():
        content = bytearray(path.read_bytes())
        content[(977 * b) % len(content) :: 1009] = b"!" * len(content[(977 * b) % len(content) :: 1009])
        path.write_bytes(content)


def _edit(library, a, b):
    with contextlib.suppress(sqlite3.Error):
        if _run(library.folder, a).exists():
            with edited(_run(library.folder, a)) as db:
                db.execute("INSERT OR REPLACE INTO run VALUES ('notes', ?)", (f'"{b}"',))


def _touch(library, a, b):
    if _run(library.folder, a).exists():
        os.utime(_run(library.folder, a), (LONG_AGO_S - b, LONG_AGO_S - b))


def _page(library, a, b):
    make_page(_run(library.folder, a).with_suffix(".html"), ("study", "diagnosis", "summary")[b % 3])


def _model(library, a, b):
    make_model(_run(library.folder, a).with_suffix(".model.json"))


def _junk(library, a, b):
    name = ("x.html", "x.model.json", "diagnosis.json", "report.html")[b % 4]
    _run(library.folder, a).with_name(name).write_text(
        ("", "{}", '{"verdict": "silent", "error": {}}')[a % 3]
    )


def _tag(library, a, b):
    found = library.search(limit=100, order="name").entries
    if found:
        library.tag(found[a % len(found)].id, [f"t{k}" for k in range(b % 4)], "Ann")


def _note(library, a, b):
    found = library.search(limit=100, order="name").entries
    if found:
        library.note(found[a % len(found)].id, f"note {b}", "Bo")


def _scan(library, a, b):
    library.refresh()


OPERATIONS = (
    *(_make, _rename, _copy, _remove, _damage, _edit, _touch, _page, _model, _junk, _tag, _note, _scan),
)
OPERATION = st.tuples(st.sampled_from(OPERATIONS), st.integers(0, 11), st.integers(0, 11))


def _settle_all(folder):
    """Else every file was written so recently that each scan reads it, and no change could be overlooked."""
    for file in folder.rglob("*"):
        if file.is_file() and not file.name.startswith("library.") and file.stat().st_mtime > LONG_AGO_S:
            settled(file)


@pytest.mark.long("takes five seconds")
@settings(max_examples=40)
@given(st.lists(OPERATION, min_size=4, max_size=14))
@example([(_make, 0, 0), (_copy, 0, 1), (_scan, 0, 0), (_remove, 0, 0)])
@example(
    [(_make, 0, 0), (_scan, 0, 0), (_copy, 0, 1), (_scan, 0, 0), (_tag, 0, 3), (_remove, 0, 0), (_make, 0, 5)]
)
@example([(_make, 5, 0), (_copy, 5, 0), (_scan, 0, 0), (_note, 0, 1), (_damage, 5, 2), (_rename, 0, 2)])
def test_a_library_made_again_is_the_library_that_followed_every_change(operations):
    with tempfile.TemporaryDirectory() as folder:
        library = Library.open(folder)
        for operate, a, b in operations:
            operate(library, a, b)
            _settle_all(library.folder)
        library.refresh()
        followed = contents(library)
        library.rebuild()
        assert contents(library) == followed
        (Path(folder) / DB).unlink()
        assert contents(refreshed(Path(folder))) == followed


@pytest.fixture
def library(tmp_path):
    """A library with a tag and a note."""
    for k in range(3):
        make_run(tmp_path / f"{k}.run.sqlite", k)
    library = refreshed(tmp_path)
    entry = library.search("1.run").entries[0]
    library.tag(entry.id, ["good"], "Ann")
    library.note(entry.id, "seen", "Bo")
    return library


def test_a_deleted_library_is_made_again_with_its_notes(library):
    before = contents(library)
    for file in library.folder.glob(f"{DB}*"):
        file.unlink()
    assert library.search().total == 0  # of the library that is open
    library.refresh()
    assert contents(library) == before
    assert places(library, tags=["good"], text="seen") == ["1.run.sqlite"]


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("how", ["garbage", "cut", "middle", "head", "empty"])
@pytest.mark.parametrize("noticed", ["at opening", "by a scan"])
def test_a_damaged_library_is_made_again_with_its_notes(library, how, noticed):
    before = contents(library)
    file = library.folder / DB
    whole = file.read_bytes()
    middle = bytearray(whole)
    middle[4096:] = bytes(b ^ 0x5A for b in middle[4096:])
    file.write_bytes(
        {
            "garbage": b"\xa5" * len(whole),
            "cut": whole[: len(whole) // 2 + 7],
            "middle": bytes(middle),
            "head": b"\0" * 100 + whole[100:],
            "empty": b"",
        }[how]
    )
    if noticed == "at opening":
        library = Library.open(library.folder)
    elif how != "empty":
        with pytest.raises(DataError, match=r"Rebuild the library: no tags or notes are lost"):
            library.facets()
    library.refresh()
    assert contents(library) == before
    assert how == "empty" or (library.folder / "library.damaged.sqlite").exists()


def change(library, *statements):
    with contextlib.closing(sqlite3.connect(library.folder / DB)) as db, db:
        for statement in statements:
            db.execute(statement)


def test_a_library_of_a_newer_smarig_is_refused_and_can_be_rebuilt(library):
    before = contents(library)
    change(
        library, f"PRAGMA user_version = {database.VERSION + 1}", "ALTER TABLE entry ADD COLUMN later TEXT"
    )
    with pytest.raises(DataError, match="was made by a newer smarig") as refused:
        Library.open(library.folder)
    assert str(refused.value).count(". ") == 1
    assert "rebuild the library" in str(refused.value)
    again = Library.open(library.folder, rebuild=True)
    again.refresh()
    assert contents(again) == before


def test_a_library_of_an_older_layout_is_made_again(library):
    before = contents(library)
    change(library, "ALTER TABLE entry ADD COLUMN former TEXT", "CREATE VIEW v AS SELECT 1")
    assert Library.open(library.folder).search().total == 0
    assert contents(refreshed(library.folder)) == before
    change(library, "PRAGMA user_version = 0")
    assert contents(refreshed(library.folder)) == before


def test_what_a_hand_has_changed_is_gone_after_a_rebuild(library):
    before = contents(library)
    change(
        library, "UPDATE entry SET wire = 'x'", "INSERT INTO tag VALUES ('00', 'y', 'y')", "DELETE FROM note"
    )
    library.refresh()
    assert contents(library) != before
    library.rebuild()
    assert contents(library) == before


def test_a_file_of_another_program_is_left_alone(tmp_path):
    file = tmp_path / DB
    with contextlib.closing(sqlite3.connect(file)) as db, db:
        db.execute("CREATE TABLE mine (x)")
    whole = file.read_bytes()
    with pytest.raises(UsageError, match="is a database of another program"):
        Library.open(tmp_path, rebuild=True)
    assert file.read_bytes() == whole
    file.unlink()
    file.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(UsageError, match="is not a regular file"):
        Library.open(tmp_path)
    assert not (tmp_path / "elsewhere").exists()


@pytest.fixture
def small_files():
    """Processes of this test cannot write files of more than the given size."""
    resource = pytest.importorskip("resource")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    yield lambda size: resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.long("takes a second")
def test_a_full_disk_is_one_sentence_and_costs_nothing(library, small_files):
    before = contents(library)
    for k in range(60):
        make_run(library.folder / f"more {k}.run.sqlite", 10 + k)
    small_files(70_000)
    with pytest.raises(StorageError, match=r"library\.sqlite cannot be written: .*\.$"):
        library.refresh()
    assert library.search("0.run").total >= 1
    small_files(-1)
    library.refresh()
    assert library.search().total == 63
    for k in range(60):
        (library.folder / f"more {k}.run.sqlite").unlink()
    library.refresh()
    assert contents(library) == before
