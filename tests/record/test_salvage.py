"""What a damaged run file still holds is said and saved; the file itself stays as it is."""

import os
import random
import shutil
import sqlite3

import numpy as np
import pytest

from record.runs import META, edited, result, sample
from record.test_recovery import KILLED_WHILE_RECORDING, killed
from smarig.core import DataError, UsageError
from smarig.record import Recorder, check_run, load_run, salvage, write_salvaged
from smarig.record.page_scan import PageScan

PAGE = 4096
LONG_TEXT = "# a rig file\n" + "key = 1\n" * 2000  # on several pages
KEYS = {f"key_{k}": "x" * 700 for k in range(40)}  # more than one page of them


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    own = Recorder(tmp_path_factory.mktemp("whole") / "a.run.sqlite", {**META, **KEYS, "config": LONG_TEXT})
    for tick in range(2500):
        own.sample(sample(tick), tick // 1000, float(tick))
        if tick % 100 == 50:
            own.step(result(tick // 100), branch="rise", target=float(tick))
            own.event(tick / 10, "mark", f"{tick} is done", level="info", tick=tick)
    own.close()
    return own.path


@pytest.fixture
def damaged(whole, tmp_path):
    """A copy of which some pages, counted from 1, are replaced."""

    def make(pages, content=bytes(PAGE)):
        image = bytearray(whole.read_bytes())
        for page in pages:
            image[(page - 1) * PAGE : page * PAGE] = content
        path = tmp_path / "damaged.run.sqlite"
        path.write_bytes(image)
        return path

    return make


def pages_of(path, table):
    with sqlite3.connect(path) as db:
        found = db.execute("SELECT pageno, pagetype FROM dbstat WHERE name = ?", (table,)).fetchall()
    db.close()
    return [n for n, kind in found if kind == "leaf"], [n for n, kind in found if kind == "internal"]


def test_a_whole_file_is_told_to_be_whole(whole):
    check = check_run(whole)
    assert (check.whole, check.samples, check.steps, check.events) == (True, 2500, 25, 26)
    assert (check.first_s, check.last_s, check.closed, check.cause, check.hashes) == (
        0.0,
        249.9,
        True,
        "done",
        "right",
    )
    assert check.sentences()[-1] == "The file is whole."


def test_all_of_a_whole_file_is_saved(whole, tmp_path):
    out = tmp_path / "saved.run.sqlite"
    write_salvaged(salvage(whole), out, force=False)
    before, after = load_run(whole), load_run(out)
    assert all(np.array_equal(before[c], after[c], equal_nan=True) for c in before.columns)
    assert (after.steps, after.events[:-1]) == (before.steps, before.events)
    assert (after.events[-1].kind, after.events[-1].level) == ("salvaged", "info")
    ends = ("end", "hashes", "salvaged")
    assert {k: v for k, v in after.meta.items() if k not in ends} == {
        k: v for k, v in before.meta.items() if k not in ends
    }
    assert after.cause == "done"


@pytest.mark.parametrize("content", [bytes(PAGE), b"\xff" * PAGE, b"\r" * PAGE], ids=["0", "255", "13"])
def test_a_lost_page_of_samples_is_named_by_its_ticks(whole, damaged, tmp_path, content):
    lost = pages_of(whole, "sample")[0][20]
    path = damaged([lost], content)
    left = path.read_bytes()
    check = check_run(path)
    ((a, b),) = check.missing
    assert not check.whole
    assert check.samples == 2500 - (b - a + 1)
    assert any(f"Missing samples: ticks {a} to {b}" in s for s in check.sentences())
    out = tmp_path / "saved.run.sqlite"
    write_salvaged(check.salvaged, out, force=False)
    saved = load_run(out)
    assert saved["tick"].tolist() == [t for t in range(2500) if not a <= t <= b]
    assert (saved["counts"] == 7 * saved["tick"]).all()
    assert len(saved.steps) == 25
    assert (saved.events[-1].kind, saved.events[-1].level) == ("salvaged", "warning")
    assert saved.events[-1].data["missing_ticks"] == [{"from": a, "to": b}]
    assert f"ticks {a} to {b} are missing" in saved.events[-1].text
    assert saved.meta["salvaged"]["from"] == path.name
    assert path.read_bytes() == left


def test_what_holds_no_row_costs_no_row(whole, damaged):
    """The first page has the schema; the inner pages of a tree and an index lead to the rows."""
    inner = [1, *pages_of(whole, "sample")[1], *pages_of(whole, "sqlite_autoindex_step_1")[0]]
    for page in inner:
        found = check_run(damaged([page])).salvaged
        assert (len(found.samples), len(found.steps), len(found.events)) == (2500, 25, 26), page
        assert (found.missing, found.unverified, found.damaged_tables) == ((), (), ()), page
        assert found.meta["config"] == LONG_TEXT


def test_pages_that_the_disk_does_not_give_are_skipped(whole, tmp_path, monkeypatch):
    path = shutil.copy(whole, tmp_path / "a.run.sqlite")
    path.with_name(f"{path.name}-wal").write_bytes(b"")
    bad = {(n - 1) * PAGE for n in pages_of(whole, "sample")[0][5:7]}
    seek, read, place = os.lseek, os.read, [0]

    def remember(handle, offset, whence):
        place[0] = offset
        return seek(handle, offset, whence)

    def failing(handle, count):
        if place[0] in bad and count == PAGE:
            raise OSError(5, "Input/output error")
        return read(handle, count)

    def not_copied(*_):
        raise OSError(5, "Input/output error")

    monkeypatch.setattr(os, "lseek", remember)
    monkeypatch.setattr(os, "read", failing)
    monkeypatch.setattr(shutil, "copyfile", not_copied)
    found = salvage(path)
    assert found.unreadable_pages == 2
    assert 2300 < len(found.samples) < 2500
    assert len(found.missing) == 1
    assert "the disk does not give 2 pages" in found.sentence()


@pytest.mark.parametrize("table", ["step", "event", "run"])
def test_a_table_that_lost_rows_is_named(whole, damaged, table):
    leaves, inner = pages_of(whole, table)
    check = check_run(damaged([*leaves, *inner]))
    assert (check.samples, check.whole) == (2500, False)
    assert table in check.damaged_tables
    assert any(f"'{table}'" in s for s in check.sentences())
    assert check.closed is (None if table == "run" else True)


def test_a_wrong_value_is_placed_by_its_block(whole, tmp_path):
    path = shutil.copy(whole, tmp_path / "a.run.sqlite")
    with sqlite3.connect(path) as db:
        db.execute("UPDATE sample SET position = 1.0 WHERE tick = 1234")
    db.close()
    check = check_run(path)
    assert (check.missing, check.unverified, check.damaged_tables) == ((), ((1000, 1999),), ("sample",))
    assert any("may be wrong in ticks 1000 to 1999" in s for s in check.sentences())


def test_a_run_without_hashes_has_gaps_only(whole, tmp_path):
    path = shutil.copy(whole, tmp_path / "a.run.sqlite")
    with edited(path) as db:
        db.execute("DELETE FROM sample WHERE tick BETWEEN 7 AND 9")
    assert check_run(path).whole
    assert check_run(path).hashes == "none"
    assert salvage(path).missing == ((7, 9),)


@pytest.mark.parametrize("share", [0.3, 0.5, 0.99])
def test_a_file_cut_off_says_so(whole, tmp_path, share):
    image = whole.read_bytes()
    path = tmp_path / "cut.run.sqlite"
    path.write_bytes(image[: int(share * len(image))])
    cut_off = (
        f"he file was cut off after {100 * share:.0f} % ({path.stat().st_size:,} of {len(image):,} bytes)"
    )
    assert any(cut_off in s for s in check_run(path).sentences())
    found = salvage(path)
    assert cut_off in found.sentence()
    assert "no gap is known" not in found.sentence()
    assert ("no sample is missing" in found.sentence()) == (len(found.samples) == 2500)
    assert salvage(whole).cut_off is None


def test_without_hashes_what_came_later_is_not_known(whole, tmp_path):
    path = shutil.copy(whole, tmp_path / "a.run.sqlite")
    with edited(path) as db:
        db.execute("DELETE FROM sample WHERE tick > 2000")
    assert "whether samples followed the last one is not known" in salvage(path).sentence()
    assert "no sample is missing" in salvage(whole).sentence()


def test_what_stands_beside_a_killed_run_is_saved_too(tmp_path):
    path, out = tmp_path / "a.run.sqlite", tmp_path / "saved.run.sqlite"
    killed(KILLED_WHILE_RECORDING, path)
    check = check_run(path)
    assert (check.whole, check.closed, check.samples) == (True, False, 300)
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    write_salvaged(salvage(path), out, force=False)
    assert before.items() <= {p.name: p.read_bytes() for p in tmp_path.iterdir()}.items()
    assert len(load_run(out)) == 300
    assert load_run(out).cause == "the run was never closed"


def test_deleted_rows_are_not_saved(whole, tmp_path):
    path = shutil.copy(whole, tmp_path / "a.run.sqlite")
    with edited(path) as db:
        db.execute("PRAGMA secure_delete=OFF")
        db.execute("DELETE FROM sample WHERE tick >= 100")
    assert [row[0] for row in salvage(path).samples] == list(range(100))


@pytest.mark.parametrize("content", [b"", b"no database", b"SQLite format 3\x00" + bytes(5000)])
def test_what_holds_nothing_of_a_run(tmp_path, content):
    path = tmp_path / "a.run.sqlite"
    path.write_bytes(content)
    with pytest.raises(DataError, match="Nothing can be saved" if content else "is empty"):
        check_run(path)
    with pytest.raises(UsageError, match="There is no run file"):
        check_run(tmp_path / "none.run.sqlite")


def test_a_file_made_to_keep_it_busy_does_not(tmp_path):
    """Rows that claim to go on for a gigabyte, on a page that leads to itself."""
    local, pages = (
        489,
        250_000,
    )  # bytes of a long row on its own page of 4096 bytes; pages that it claims beside
    size = local + pages * (PAGE - 4)
    varint = bytes([0x80 | size >> s & 0x7F for s in (28, 21, 14, 7)] + [size & 0x7F])
    page = bytearray(b"\x00\x00\x03\x00" * (PAGE // 4))  # read 495 bytes after a row begins: page 3
    page[0], page[3:5] = 0x0D, (200).to_bytes(2, "big")
    for k in range(200):
        place = 700 + k * 12
        page[8 + 2 * k : 10 + 2 * k] = place.to_bytes(2, "big")
        page[place : place + 6] = varint + b"\x01"
    overflow = (3).to_bytes(4, "big") + bytes(PAGE - 4)
    path = tmp_path / "a.run.sqlite"
    path.write_bytes(b"SQLite format 3\x00\x10\x00".ljust(PAGE, b"\0") + bytes(page) + overflow)
    with pytest.raises(DataError, match="Nothing can be saved"):
        salvage(path)


@pytest.mark.skipif(not hasattr(os, "SEEK_DATA"), reason="this system does not tell holes")
def test_holes_of_a_sparse_file_are_not_read(whole, tmp_path, monkeypatch):
    sparse = tmp_path / "sparse.run.sqlite"
    shutil.copy(whole, sparse)
    before = salvage(sparse).samples
    os.truncate(sparse, 300_000_000_000)
    reads = []
    rows_of = PageScan._rows_of

    def counted(self, number):
        reads.append(number)
        return rows_of(self, number)

    monkeypatch.setattr(PageScan, "_rows_of", counted)
    assert salvage(sparse).samples == before
    assert max(reads) < 10_000


def test_chance_damage_never_stops_it_and_nothing_untrue_is_saved_as_verified(whole, tmp_path):
    chance, image, before = random.Random(5), whole.read_bytes(), load_run(whole)
    certain_rows = 0
    path, out = tmp_path / "m.run.sqlite", tmp_path / "saved.run.sqlite"
    for _ in range(25):
        mutated = bytearray(image)
        for _ in range(chance.randrange(1, 30)):
            mutated[chance.randrange(len(image))] = chance.randrange(256)
        path.write_bytes(mutated[: len(image) - chance.choice([0, 0, 7, 9000])])
        found = salvage(path)
        write_salvaged(found, out, force=True)
        saved = load_run(out)
        if "hashes" not in found.meta:
            continue
        rows = saved["tick"].astype(int)
        certain = np.ones(rows.size, bool)
        for a, b in found.unverified:
            certain &= (rows < a) | (rows > b)
        certain_rows += int(certain.sum())
        for name in before.columns:
            np.testing.assert_array_equal(saved[name][certain], before[name][rows[certain]])
    assert certain_rows > 5_000
