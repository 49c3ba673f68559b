"""Files written before the restructuring still open, report, export, resume and simulate as they did.

Together they contain every kind of event, every key of a run's description and every kind of hysteresis of
that time; old_files/README.md lists the contents of each.
"""

import contextlib
import json
import os
import sqlite3

import pytest

from frozen.answers import Questions, load
from frozen.asking import ask
from frozen.comparing import differences
from frozen.old import names, unpacked

EVENTS = {
    *("start", "mark", "zero", "end", "paused", "unpaused", "interrupted", "resumed", "shift"),
    *("clock", "history", "lost", "blind", "read_back", "resistance", "jump", "slip", "still"),
}
KEYS = {
    *(
        "schema_version",
        "recorder_pid",
        "protocol",
        "settings",
        "actuator",
        "seed",
        "effects",
        "input",
        "output",
    ),
    *("versions", "rig", "wire", "source", "start_epoch", "period_s", "initial", "encoder_zero", "config"),
    *("notes", "device", "own_files", "begun_with", "closed_loop", "wire_history", "history_until_tick"),
    *("shift", "end", "model", "along", "imported", "warnings", "t0_s", "conditions", "header", "forc"),
    "companions",
}
VERDICTS = {"settled", "timed_out", "elapsed", "interrupted"}
HYSTERESES = {"fod_surface constant", "fod_surface parabolic", "fod_surface exponential", "fod_table"} | {
    *("mirrored forc_table", "mirrored fod_surface exponential", "mirrored fod_table"),
}
MOST_SHOWN = 30
LONG = bool(os.environ.get("SMARIG_LONG"))
WITH_A_LIKE = {  # of the same kind: effects on two wires, a mirrored table, an exponential surface
    f"old/model/{name}"
    for name in ("two_wire_exponential", "mirrored_exponential", "one_wire_constant", "one_wire_parabolic")
}


@pytest.fixture(scope="module")
def kept():
    return load()


@pytest.fixture(scope="module")
def questions(tmp_path_factory):
    return Questions(tmp_path_factory.mktemp("old"))


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    return unpacked("runs", tmp_path_factory.mktemp("runs"))


@pytest.mark.long(
    "takes three seconds",
    cases=(
        "old/box",
        "old/model/effects_one_wire",
        "old/model/effects_two_wire",
        "old/model/mirrored_table",
        "old/model/one_wire_exponential",
        "old/own/rig",
        "old/report",
        "old/resume/stopped_serial",
        "old/run/forc",
        "old/run/waveform",
    ),
)
@pytest.mark.parametrize(
    "name", [name for name in load() if name.startswith("old/") and (LONG or name not in WITH_A_LIKE)]
)
def test_an_old_file_gives_the_numbers_it_gave(kept, questions, name):
    found = list(differences(kept[name], questions.answer(name), name, exact=False))
    assert not found, "\n".join(found[:MOST_SHOWN])


@pytest.mark.parametrize("ending", ["mat", "nc", "parquet"])
def test_old_runs_are_exported_with_all_they_hold(runs, ending):
    if ending == "parquet":
        pytest.importorskip("pyarrow")
    if ending == "nc":
        pytest.importorskip("h5netcdf")
    kind = {"nc": "netcdf"}.get(ending, ending)
    for name in names("runs", ".run.sqlite") if LONG else ("shifted", "forc", "imported"):
        out = runs / f"{name}.{ending}"
        assert ask("export", runs / f"{name}.run.sqlite", "--to", kind, "-o", out)["exit_status"] == 0, name
        assert out.stat().st_size > 1000


def test_they_hold_every_kind_of_event_every_key_and_every_verdict(runs):
    kinds, keys, verdicts = set(), set(), set()
    for path in runs.glob("*.run.sqlite"):
        with contextlib.closing(sqlite3.connect(path)) as db:
            kinds |= {kind for (kind,) in db.execute("SELECT kind FROM event")}
            keys |= {key for (key,) in db.execute("SELECT key FROM run")}
            verdicts |= {verdict for (verdict,) in db.execute("SELECT verdict FROM step")}
    assert (kinds, keys, verdicts) == (EVENTS, KEYS, VERDICTS)


def test_they_hold_every_kind_of_hysteresis(tmp_path):
    found = set()
    for path in unpacked("models", tmp_path).glob("*.model.json"):
        hysteresis = json.loads(path.read_text(encoding="utf-8"))["hysteresis"]
        words = []
        while hysteresis:
            words += [hysteresis["kind"], hysteresis.get("form", "")]
            hysteresis = hysteresis.get("image")
        found.add(" ".join(word for word in words if word))
    assert found == HYSTERESES
