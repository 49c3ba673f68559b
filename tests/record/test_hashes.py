"""What changes in the file of a closed run is noticed when it is read; what was never hashed is read as before."""

import hashlib
import os
import random
import sqlite3
import struct

import numpy as np
import pytest

from record.runs import META, edited, result, sample, until
from smarig.core import DataError
from smarig.record import Continuation, Recorder, load_run
from smarig.record.new_run_file import write_run
from smarig.record.table_hashes import BLOCK_ROWS, block_hash

MUTATIONS = 5000 if os.environ.get("SMARIG_LONG") else 300
CHANGES = {
    "a value": "UPDATE sample SET position = position + 1e-12 WHERE tick = 7",
    "a value that was NULL": "UPDATE sample SET temperature_degC = 0.0 WHERE tick = 7",
    "NULL for a value": "UPDATE sample SET voltage_V = NULL WHERE tick = 7",
    "a text for the same number": "UPDATE sample SET quality = x'30' WHERE tick = 7",
    "a row too few": "DELETE FROM sample WHERE tick = 7",
    "the last row": "DELETE FROM sample WHERE tick = 2499",
    "a row too many": "INSERT INTO sample (tick) VALUES (9999)",
    "two rows exchanged": "UPDATE sample SET tick = CASE tick WHEN 7 THEN -8 ELSE -7 END WHERE tick IN (7, 8)",
    "no rows": "DELETE FROM sample",
    "a step": "UPDATE step SET void = 1",
    "a step too few": 'DELETE FROM step WHERE "index" = 0',
    "a letter of an event": "UPDATE event SET text = replace(text, 'ended', 'Ended')",
    "a moved event": "UPDATE event SET rowid = 99 WHERE rowid = 1",
    "a key": "UPDATE run SET value = '\"other\"' WHERE key = 'rig'",
    "a key too many": "INSERT INTO run VALUES ('seed', '3')",
    "the end": "DELETE FROM run WHERE key = 'end'",
    "the hashes": "DELETE FROM run WHERE key = 'hashes'",
    "a hash": "UPDATE run SET value = replace(value, '\"step\"', '\"Step\"') WHERE key = 'hashes'",
    "hashes of no kind": "UPDATE run SET value = '{\"sample\": 3}' WHERE key = 'hashes'",
}
HARMLESS = ("VACUUM", "REINDEX", "ANALYZE", "PRAGMA user_version = 7")


def recorded(path, samples=2500):
    own = Recorder(path, META)
    for tick in range(samples):
        own.sample(sample(tick), tick // 1000, 0.0)
    own.step(result(0), branch="rise", target=1.0)
    own.event(3.0, "mark", "half way", level="info")
    own.close()
    return path


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return recorded(tmp_path_factory.mktemp("whole") / "a.run.sqlite")


@pytest.fixture
def path(whole, tmp_path):
    copy = tmp_path / "a.run.sqlite"
    copy.write_bytes(whole.read_bytes())
    return copy


def change(path, sql):
    db = sqlite3.connect(path, isolation_level=None)
    db.execute(sql)
    db.close()


@pytest.mark.parametrize("kind", CHANGES)
def test_a_changed_cell_is_noticed_and_the_table_named(path, kind):
    change(path, CHANGES[kind])
    table = CHANGES[kind].removeprefix("UPDATE ").removeprefix("DELETE FROM ").removeprefix("INSERT INTO ")
    table = "step" if kind == "a hash" else table.split()[0]
    with pytest.raises(DataError, match=rf"is damaged: .*'{table}'.* `smarig check .*` shows what can be"):
        load_run(path)


def test_what_changes_no_cell_is_no_damage(path):
    before = load_run(path)
    for sql in HARMLESS:
        change(path, sql)
    assert load_run(path)["position"].tolist() == before["position"].tolist()


def test_a_run_without_hashes_is_read(path):
    with edited(path) as db:
        db.execute("UPDATE sample SET position = 5.0")
    run = load_run(path)
    assert run.complete
    assert set(run["position"]) == {5.0}


def test_a_resumed_run_has_the_hashes_of_all_of_it(path):
    own = Recorder(path, {}, continuation=Continuation(void_all=True))
    assert not {"end", "hashes"} & load_run(path).meta.keys()
    own.shift((0, 2499), 0, 5, 0.047)
    own.sample(sample(2500), 9, 0.0)
    own.close()
    assert len(load_run(path)) == 2501
    change(path, CHANGES["a value"])
    with pytest.raises(DataError, match="damaged"):
        load_run(path)


def test_a_run_that_was_written_at_once_has_hashes_of_its_own(tmp_path, whole):
    """The description of another run may have been copied, with its end and hashes."""
    path = tmp_path / "b.run.sqlite"
    columns = {"tick": np.arange(3), "position": [1, np.nan, True], "step": [0.0, 1.5, None]}
    write_run(path, load_run(whole).meta, columns, [], force=False)
    assert load_run(path)["position"].tolist()[::2] == [1.0, 1.0]
    change(path, "UPDATE sample SET position = 2.0 WHERE tick = 2")
    with pytest.raises(DataError, match="'sample'"):
        load_run(path)


LATE = {
    "an earlier sample": lambda own: own.sample(sample(3), 0, 0.0),
    "another zero": lambda own: own.shift((0, 2499), 0, 5, 0.047),
    "nothing": lambda own: None,
}


@pytest.mark.parametrize("kind", LATE)
def test_samples_that_change_after_they_were_hashed(tmp_path, kind):
    """Blocks are hashed while the run is recorded; what was hashed too early is hashed again."""
    own = Recorder(tmp_path / "a.run.sqlite", META)
    for tick in range(10, 2500):
        own.sample(sample(tick), 0, 0.0)
    own.step(result(0), branch="rise", target=1.0)
    until(lambda: bool(own._hashes.hashes))
    LATE[kind](own)
    own.step(result(1), branch="rise", target=2.0)
    own.close()
    run = load_run(own.path)
    assert len(run.meta["hashes"]["sample"]) == 3
    change(own.path, CHANGES["a value"].replace("tick = 7", "tick = 999"))
    with pytest.raises(DataError, match="'sample'"):
        load_run(own.path)


def test_a_resumed_run_is_hashed_while_it_goes_on(path):
    own = Recorder(path, {}, continuation=Continuation())
    for tick in range(2500, 2503):
        own.sample(sample(tick), 0, 0.0)
        own._wake.set()
        until(lambda: not own._rows)
    own._wake.set()
    until(lambda: len(own._hashes.hashes) == 2)
    own.close()
    assert len(load_run(path)) == 2503


def test_rejected_samples_leave_right_hashes(tmp_path):
    own = Recorder(tmp_path / "a.run.sqlite", META)
    for tick in (1, 2, 2, 3):
        own.sample(sample(tick), 0, 0.0)
    with pytest.raises(DataError, match="1 samples were not recorded"):
        own.close()
    run = load_run(own.path)
    assert (run["tick"].tolist(), run.complete, "hashes" in run.meta) == ([1, 2, 3], True, True)


def encoded(cell) -> bytes:
    """A cell as the format of the hashes describes it."""
    if cell is None:
        return b"N"
    if isinstance(cell, float):
        return b"g" + struct.pack("<d", cell)
    if isinstance(cell, str):
        return b"u" + struct.pack("<i", len(cell.encode())) + cell.encode()
    if -(2**31) <= cell < 2**31:
        return b"i" + struct.pack("<i", cell)
    digits = [abs(cell) >> k & 0x7FFF for k in range(0, abs(cell).bit_length(), 15)]
    return b"l" + struct.pack(f"<i{len(digits)}H", len(digits) * (1 if cell > 0 else -1), *digits)


def test_the_hashes_are_those_of_the_documented_bytes():
    """So a file of one Python is right for another, and for other programs."""
    chance = random.Random(3)
    cells = [None, 0, -1, 2**31, -(2**31) - 1, 2**62, 0.0, -0.0, 1e-300, float("inf"), "", "rise", "ö 中 😀"]
    rows = [tuple(chance.choices(cells, k=12)) for _ in range(BLOCK_ROWS)]
    rows.append(tuple("rise" for _ in range(12)))
    documented = b"".join(b"(" + struct.pack("<i", 12) + b"".join(map(encoded, row)) for row in rows)
    assert block_hash(rows) == hashlib.sha256(documented).hexdigest()[:16]


def same(run, other) -> bool:
    """Whether two runs tell the same: every number, step, event and key."""
    return all(np.array_equal(run[name], other[name], equal_nan=True) for name in run.columns) and (
        run.steps,
        run.events,
        run.meta,
    ) == (other.steps, other.events, other.meta)


def test_no_mutated_file_is_read_with_other_numbers(tmp_path):
    """Files with one byte or one bit changed: refused, or the same."""
    whole = recorded(tmp_path / "a.run.sqlite", 700)
    chance, before, image = random.Random(10), load_run(whole), whole.read_bytes()
    told = {"refused": 0, "the same": 0, "other": 0}
    for number in range(MUTATIONS):
        mutated = bytearray(image)
        k = chance.randrange(len(image))
        mutated[k] = mutated[k] ^ 1 << chance.randrange(8) if number % 2 else chance.randrange(256)
        path = tmp_path / "m.run.sqlite"
        path.write_bytes(mutated)
        try:
            told["the same" if same(load_run(path), before) else "other"] += 1
        except DataError:
            told["refused"] += 1
    print(told)
    assert told["other"] == 0
    assert told["refused"] > MUTATIONS / 2
