"""Run files with real tables and hostile values: sizes, types, texts, and names of files that are not their own."""

import contextlib
import json
import shutil
import sqlite3
from pathlib import Path
from typing import Any

from hostile.material import Material
from hostile.run_structures import Maker, later, sql

_UPSERT = "INSERT OR REPLACE INTO run VALUES (?, ?)"
FORMULA = "=cmd|calc!A0"


def keys(**values: Any) -> Maker:
    """A killed run with these keys; a function gets the material."""

    def make(m: Material, path: Path) -> None:
        shutil.copy(m.killed, path)
        with contextlib.closing(sqlite3.connect(path)) as db, db:
            for key, value in values.items():
                db.execute(_UPSERT, (key, json.dumps(value(m) if callable(value) else value)))

    return make


def raw(key: str, text: str) -> Maker:
    """A killed run with the text of a key as it is."""

    def make(m: Material, path: Path) -> None:
        shutil.copy(m.killed, path)
        with contextlib.closing(sqlite3.connect(path)) as db, db:
            db.execute(_UPSERT, (key, text))

    return make


def started(**changes: Any) -> Maker:
    """A killed run that was started with other arguments."""

    def make(m: Material, path: Path) -> None:
        shutil.copy(m.killed, path)
        with contextlib.closing(sqlite3.connect(path)) as db, db:
            (text,) = db.execute("SELECT value FROM run WHERE key = 'begun_with'").fetchone()
            given = {k: v(m) if callable(v) else v for k, v in changes.items()}
            protocol = given.pop("protocol", None)
            db.execute(_UPSERT, ("begun_with", json.dumps({**json.loads(text), **given})))
            if protocol:
                db.execute(_UPSERT, ("protocol", json.dumps(protocol)))

    return make


def secret_file(m: Material) -> dict:
    """A setting that names somebody's file."""
    return {"file": str(m.secret)}


def event(text: str, data: str = "{}") -> Maker:
    """One more event."""

    def make(m: Material, path: Path) -> None:
        shutil.copy(m.killed, path)
        with contextlib.closing(sqlite3.connect(path)) as db, db:
            db.execute("INSERT INTO event VALUES (0, 'info', 'x', ?, ?)", (text, data))

    return make


_COUNT = "WITH RECURSIVE r(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM r WHERE x < {}) "
CONTENTS: dict[str, Maker] = {
    "note of 50 MB": later(lambda: keys(notes="n" * 50_000_000)),
    "note of 20 MB of markup": later(lambda: keys(notes="<&\n" * 7_000_000)),
    "rig file of 30 MB": later(lambda: keys(config="#" * 30_000_000)),
    "unit of 1 MB": later(lambda: keys(output={"unit": "m" * 1_000_000})),
    "protocol of 5 MB": later(lambda: keys(protocol="p" * 5_000_000)),
    "cause of 5 MB": later(lambda: keys(end={"cause": "c" * 5_000_000})),
    "100 000 settings": later(lambda: keys(settings={f"s{k}": k for k in range(100_000)})),
    "100 000 keys": sql(_COUNT.format(100_000) + "INSERT INTO run SELECT 'k' || x, '1' FROM r"),
    "100 000 effects": later(lambda: keys(effects=["e"] * 100_000)),
    "100 000 warnings": later(lambda: keys(warnings=["w" * 100] * 100_000)),
    "deep settings": later(lambda: raw("settings", '{"a": ' + "[" * 100_000 + "]" * 100_000 + "}")),
    "endless number": later(lambda: raw("seed", "9" * 5_000_000)),
    "large number": raw("settings", '{"points": ' + "9" * 4000 + "}"),
    "event of 50 MB": later(lambda: event("e" * 50_000_000)),
    "event with 20 MB of data": later(lambda: event("e", json.dumps({"x": [0] * 7_000_000}))),
    "deep event": later(lambda: event("e", "[" * 100_000)),
    "500 000 events": sql(
        _COUNT.format(500_000) + "INSERT INTO event SELECT x, 'info', 'k', 't', '{}' FROM r"
    ),
    "300 000 steps": sql(
        _COUNT.format(300_000)
        + "INSERT INTO step SELECT x + 1000, 0, 0, 'b', 1, 1, 2, 'settled', 1, 1 FROM r"
    ),
    "a word for a position": sql("UPDATE sample SET position = 'far' WHERE tick = 3"),
    "a blob for a current": sql("UPDATE sample SET current_A = x'00ff' WHERE tick = 3"),
    "a blob of 50 MB": sql("UPDATE sample SET current_A = zeroblob(50000000) WHERE tick = 3"),
    "infinite positions": sql("UPDATE sample SET position = 9e999", "UPDATE step SET position = -9e999"),
    "huge positions": sql("UPDATE sample SET position = 1e300", "UPDATE step SET position = 1e300"),
    "huge ticks": sql("UPDATE sample SET tick = tick + 9000000000000000000"),
    "huge steps": sql('UPDATE step SET "index" = "index" + 9000000000000000000'),
    "huge numbers of samples": sql("UPDATE step SET n = 9000000000000000000"),
    "infinite numbers of samples": sql("UPDATE step SET n = 9e999"),
    "time runs back": sql("UPDATE sample SET t_s = -t_s"),
    "time stands": sql("UPDATE sample SET t_s = 0"),
    "endless time": sql("UPDATE sample SET t_s = t_s * 1e12", "UPDATE step SET t_end_s = 1e300"),
    "no samples": sql("DELETE FROM sample"),
    "one sample": sql("DELETE FROM sample WHERE tick > 1"),
    "all null": sql(
        "UPDATE sample SET t_s = NULL, step = NULL, input = NULL, counts = NULL, position = NULL"
    ),
    "half a character": raw("protocol", '"\\ud800"'),
    "bytes for a text": sql("UPDATE event SET text = CAST(x'fffe' AS TEXT)"),
    "zeros in a text": event("a\x00b"),
    "escape sequences": keys(protocol="\x1b]0;owned\x07\x1b[2J", end={"cause": "\x1b[31m\r\nsmarig: done"}),
    "markup": keys(protocol="<script>alert(1)</script>", notes="</script><img src=x onerror=alert(1)>"),
    "formula as unit": keys(
        output={"quantity": f"\n{FORMULA}", "unit": f"\n{FORMULA}"}, input={"unit": f"x\r{FORMULA}"}
    ),
    "formula at the start": keys(output={"unit": FORMULA}, input={"quantity": "@x", "unit": "+1"}),
    "unit with commas": keys(output={"unit": 'mm",0\n"'}, input={"unit": "\x1b[2J,\t;"}),
    "secret as rig": started(rig=lambda m: str(m.secret)),
    "secret as a profile": started(protocol="step_currents", settings=secret_file),
    "device as a profile": started(protocol="step_currents", settings={"file": "/dev/zero"}),
    "secret as actuator": keys(actuator=lambda m: str(m.secret)),
    "own protocol": started(protocol=lambda m: str(m.evil)),
    "own effect": started(effects=lambda m: [f"{m.evil}=3"]),
    "protocol beside it": started(protocol="../evil"),
    "a billion points": started(protocol="validation", settings={"points": 10**9}),
    "settings of the wrong type": started(settings=["points"]),
    "settings of no kind": started(settings={"partition_K": {"a": [1]}}),
    "speed as a word": started(speed="fast"),
    "infinite speed": started(speed=1e308),
    "noise as a table": started(noise={}),
    "effects as a number": started(effects=7),
    "hours as period": keys(period_s=1e9),
    "tiny period": keys(period_s=1e-6),
    "no period": keys(period_s=0),
    "own files of no kind": keys(own_files=[{"kind": [], "name": {}}]),
    "a wire with a path": keys(wire="../../x"),
    "a wire of 1 MB": later(lambda: keys(wire="w" * 1_000_000)),
    "zero of a count": keys(output={"unit": "mm", "per_count": 0}),
    "huge count": keys(output={"unit": "mm", "per_count": 1e300}),
    "conditions of no kind": keys(conditions={"stress": {"value": "x", "unit": 3}, "load": 7}),
    "deep conditions": keys(conditions={"a" * 3000: {"value": 1e308, "unit": "\x00"}}),
}
