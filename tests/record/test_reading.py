"""Reading a run as columns and points; any other file is refused with one sentence."""

import sqlite3

import numpy as np
import pytest

from record.runs import META, edited, result, sample
from smarig.core.command import StepVerdict
from smarig.core.errors import DataError, UsageError
from smarig.record import Recorder, load_run
from smarig.record.schema import CREATE, SAMPLE_COLUMNS


@pytest.fixture
def path(tmp_path):
    """A finished run of 300 samples and three steps."""
    file = tmp_path / "a.run.sqlite"
    rec = Recorder(file, META)
    for tick in range(300):
        rec.sample(sample(tick), tick // 100, 0.5 * tick)
    rec.step(result(0), branch="rise", target=43.5)
    rec.step(result(1, StepVerdict.ELAPSED), branch="", target=None)
    rec.step(result(2, StepVerdict.TIMED_OUT), branch="fall", target=7.0)
    rec.close()
    return file


def test_settled_points_are_steps_with_a_target(path):
    u, y = load_run(path).points()
    assert u.tolist() == [43.5, 7.0]
    assert y.tolist() == [1.5, 3.5]


def test_void_steps_are_no_points(path):
    with edited(path) as db:
        db.execute('UPDATE step SET void = 1 WHERE "index" = 0')
    assert load_run(path).points()[0].tolist() == [7.0]


def test_without_steps_every_sample_is_a_point(tmp_path):
    file = tmp_path / "b.run.sqlite"
    rec = Recorder(file, META)
    for tick in range(5):
        rec.sample(sample(tick), None, float("nan") if tick == 2 else tick)
    rec.close()
    u, y = load_run(file).points()
    assert u.tolist() == [0, 1, 3, 4]
    assert np.allclose(y, 0.047 * u)


def test_a_run_has_a_readable_repr(path):
    run = load_run(str(path))
    assert repr(run) == "Run(wiping_out on bench (twin), 300 samples, 0.01 h, 3 steps, done)"
    assert len(run) == 300
    assert not run.has("temperature_degC")
    with pytest.raises(UsageError, match="A run has no column 'curent_A'. Its columns are: tick, t_s, step"):
        run["curent_A"]


def test_a_missing_file_is_a_matter_of_usage(tmp_path):
    absent = tmp_path / "none.run.sqlite"
    for place, words in (
        (absent, f"There is no run file {absent}"),
        (tmp_path, "is a folder. Name a run file"),
    ):
        with pytest.raises(UsageError, match=words):
            load_run(place)


# --- files that are none ----------------------------------------------------------------------------------


def text(file) -> None:
    file.write_text("time_s,current_A\n0,1\n" * 100)


def empty(file) -> None:
    file.write_bytes(b"")


def noise(file) -> None:
    file.write_bytes(np.random.default_rng(1).bytes(20_000))


def another_database(file) -> None:
    with sqlite3.connect(file) as db:
        db.execute("CREATE TABLE albums (title TEXT)")
    db.close()


def half(file) -> None:
    rec = Recorder(file, META)
    for tick in range(3000):
        rec.sample(sample(tick), 0, 0.0)
    rec.close()
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2])


def the_first_page(file) -> None:
    half(file)
    file.write_bytes(file.read_bytes()[:4096])


def with_row(sql: str, *row):
    def write(file) -> None:
        with sqlite3.connect(file) as db:
            db.executescript(CREATE)
            db.execute("INSERT INTO run VALUES ('schema_version', '1')")
            db.execute(sql, row)
        db.close()

    return write


IMPOSTORS = {
    "text": text,
    "empty": empty,
    "noise": noise,
    "another database": another_database,
    "truncated": half,
    "truncated to a page": the_first_page,
    "words for numbers": with_row("INSERT INTO sample (tick, position, quality) VALUES (1, 'far', 0)"),
    "bytes for a description": with_row("INSERT INTO run VALUES ('rig', ?)", b"\xff\xfe\x00"),
    "no description": with_row("INSERT INTO run VALUES ('rig', NULL)"),
    "half a description": with_row("INSERT INTO run VALUES ('rig', '{')"),
    "figures that are no table": with_row("INSERT INTO event VALUES (0, 'info', 'x', 'y', '3')"),
    "an endless number": with_row("INSERT INTO step VALUES (9e999,0,0,'',0,0,0,'',0,0)"),
    "event without words": with_row("INSERT INTO event VALUES (0, 'info', 'x', 'y', '[')"),
}


@pytest.mark.parametrize("kind", IMPOSTORS)
def test_what_is_no_run_is_refused_in_one_sentence(tmp_path, kind: str):
    file = tmp_path / "x.run.sqlite"
    IMPOSTORS[kind](file)
    with pytest.raises(DataError) as refusal:
        load_run(file)
    words = str(refusal.value)
    swapped = {
        "text": "is a table of numbers, not a run: ",
        "empty": "is empty.",
        "another database": "is an SQLite database, but no run ",
    }
    assert words.startswith(f"{file} {swapped.get(kind, 'is not a run file, or is damaged: ')}")
    assert "\n" not in words
    assert refusal.value.exit_status == 4


ABSURD = {
    "start_epoch": ('"x"', "1e300", "Infinity", "true"),
    "settings": ("3", "[]"),
    "notes": ('"\\ud800"', "[" * 100_000 + "]" * 100_000, "[" * 100_000, "7"),
    "protocol": ("{}",),
    "actuator": ("4", '"' + "y" * 5000 + '"'),
    "input": ("null", '{"unit": 3}', '{"unit": null}', '{"quantity": {}}'),
    "output": ('{"per_count": "x"}', '{"per_count": NaN}', '{"\\udc00": 1}'),
    "end": ('{"cause": null}',),
    "period_s": ("-1", "1e-300", '"fast"'),
    "seed": ("0.5", "9" * 400),
    "versions": ("[1]",),
    "effects": ("3", "[null]"),
    "warnings": ('"one"', "[1]"),
    "imported": ('{"file": 3}', "7"),
    "somebody_elses": ("[" * 100_000, '["\\ud800"]'),
}


@pytest.mark.parametrize("key", ABSURD)
def test_a_description_of_another_kind_is_refused_by_its_key(path, key: str):
    for value in ABSURD[key]:
        with sqlite3.connect(path) as db:
            db.execute("INSERT OR REPLACE INTO run VALUES (?, ?)", (key, value))
        db.close()
        with pytest.raises(
            DataError, match=f"is damaged: its key '({key}|cause|unit|quantity|per_count|file)'"
        ) as no:
            load_run(path)
        assert f"'{key}'" in str(no.value)
        assert len(str(no.value)) < 400, value[:40]


def test_what_is_not_known_and_what_others_wrote_is_read(path):
    unknown = ("rig", "wire", "actuator", "start_epoch", "notes", "settings", "effects", "period_s", "seed")
    with edited(path) as db:
        db.executemany("INSERT OR REPLACE INTO run VALUES (?, 'null')", [(key,) for key in unknown])
        db.execute("INSERT INTO run VALUES ('somebody_elses', '{\"ö\": [1, 2.5, null]}')")
    run = load_run(path)
    assert [run.meta[key] for key in unknown] == [None] * len(unknown)
    assert run.meta["somebody_elses"] == {"ö": [1, 2.5, None]}


@pytest.mark.parametrize(
    ("sql", "said"), [("UPDATE run SET value = '99'", "99"), ("DELETE FROM run", "None")]
)
def test_another_schema_is_named(path, sql: str, said: str):
    with sqlite3.connect(path) as db:
        db.execute(sql + " WHERE key = 'schema_version'")
    db.close()
    with pytest.raises(DataError, match=f"has run schema version {said}; this smarig reads version 1"):
        load_run(path)


def test_reading_changes_nothing(path):
    before = path.read_bytes()
    load_run(path)
    assert path.read_bytes() == before
    assert [p.name for p in path.parent.iterdir()] == [path.name]


def test_columns_of_the_contract():
    """Design §4.2: the names other tools rely on."""
    assert (
        *("tick", "t_s", "step", "current_command_A", "current_A", "voltage_V", "temperature_degC"),
        *("input", "counts", "position", "ambient_degC", "quality"),
    ) == SAMPLE_COLUMNS
