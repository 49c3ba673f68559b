"""A run is resumed only on a rig whose values are those of its record, as far as they reach its numbers."""

import json
import shutil
import sqlite3
from contextlib import closing
from typing import get_args

import pytest
from pydantic import BaseModel

import smarig
from runner.interrupted import cut
from smarig.config import ActuatorFile, Quantity, RigFile, locate
from smarig.core.errors import DataError, UsageError
from smarig.record import load_run
from smarig.runner.resume.reach import REACH, Reach, reach_of
from smarig.runner.resume.resume_run import resume, session_for
from smarig.runner.resume.same_rig import check_same_rig
from smarig.runner.rig_description import ACTUATOR_VALUES, HASHES, RIG_VALUES, sha256

RIG = 'name = "mine"\nbase = "base.toml"\n'
NEW_KEYS = (HASHES, RIG_VALUES, ACTUATOR_VALUES, "actuator_text")


def write_files(folder):
    """A rig with a base and an actuator of its own."""
    base = locate("rigs", "one_wire_twin").read_text("utf-8")
    (folder / "base.toml").write_text(base.replace('"gorbet_one_wire"', '"wire.toml"'), "utf-8")
    (folder / "mine.toml").write_text(RIG, "utf-8")
    shutil.copy(locate("actuators", "gorbet_one_wire"), folder / "wire.toml")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    write_files(folder)
    return smarig.run("validation", rig=str(folder / "mine.toml"), out=folder / "w.run.sqlite", points=2)


@pytest.fixture
def killed(whole, tmp_path):
    write_files(tmp_path)
    return cut(whole.path, tmp_path / "r.run.sqlite", 900)


def edit(path, old, new):
    text = path.read_text("utf-8")
    assert text.count(old) == 1
    path.write_text(text.replace(old, new), "utf-8")


def compared(killed):
    """What resuming finds on the rig beside the run."""
    rig = str(killed.parent / "mine.toml")
    return check_same_rig(load_run(killed), session_for(load_run(killed), rig=rig))


def set_keys(path, **values):
    """Replace keys of the record; None removes one."""
    with closing(sqlite3.connect(path)) as db, db:
        for key, value in values.items():
            db.execute("DELETE FROM run WHERE key = ?", (key,))
            if value is not None:
                db.execute("INSERT INTO run VALUES (?, ?)", (key, json.dumps(value)))


def as_earlier_versions(killed):
    """Without the keys that earlier versions did not record."""
    set_keys(killed, **dict.fromkeys(NEW_KEYS))


# --- the record ----------------------------------------------------------------------------------------------------


def test_a_record_holds_texts_values_and_hashes(whole):
    folder, info = whole.path.parent, whole.info
    assert info.config == RIG + "\n" + (folder / "base.toml").read_text("utf-8")
    assert info.actuator_text == (folder / "wire.toml").read_text("utf-8")
    assert info.rig_values["encoder"]["counts_per_rev"] == 2000, "of the base"
    assert info.rig_values["hidden_effect"] is False, "a default"
    assert info.actuator_values["transmission"]["radius"]["value"] == 15.0
    assert set(info.rig_sha256) == {"config", "actuator_text", "rig_values", "actuator_values"}


def keys_of(schema, place=""):
    """Every key of a file, down to numbers, words and quantities."""
    for name, field in schema.model_fields.items():
        kinds = [k for k in (field.annotation, *get_args(field.annotation)) if isinstance(k, type)]
        inner = next((k for k in kinds if issubclass(k, BaseModel) and not issubclass(k, Quantity)), None)
        if inner is None:
            yield place + name
        else:
            yield from keys_of(inner, f"{place}{name}.")


@pytest.mark.parametrize(("table", "schema"), [(RIG_VALUES, RigFile), (ACTUATOR_VALUES, ActuatorFile)])
def test_every_key_of_a_file_is_in_the_list_and_no_other(table, schema):
    """A new key needs a decision: may a run be resumed after its value was changed?"""
    assert set(keys_of(schema)) == set(REACH[table])


def test_an_unlisted_key_is_refused():
    assert reach_of(RIG_VALUES, "links.amplifier.gain") is Reach.NUMBERS


# --- what is refused -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("file", "old", "new", "says"),
    [
        ("wire.toml", "radius = { value = 15.0", "radius = { value = 18.0", "radius was 15 mm, is now 18 mm"),
        ("wire.toml", "current = { value = 1.0", "current = { value = 1.1", "was 1 A, is now 1.1 A"),
        ("wire.toml", "{ value = 840.0", "{ value = 840.0000001", "was 840 J/(kg K), is now 840.0000001"),
        ("wire.toml", "{ value = 4.5", "{ value = 4.6", "heating.resistance_austenite was 4.5 ohm"),
        ("wire.toml", 'surface = "one_e"', 'surface = "one_c"', "hysteresis.surface was 'one_e', is now 'one_c'"),
        ("base.toml", "counts_per_rev = 2000", "counts_per_rev = 4000", "encoder.counts_per_rev was 2000, is now 4000"),
        ("base.toml", "noise_counts = 0.4", "noise_counts = 0.5", "encoder.noise_counts was 0.4, is now 0.5"),
        ("base.toml", "ambient_degC = 22.0", "ambient_degC = 25.0", "ambient_degC was 22, is now 25"),
        ("mine.toml", RIG, RIG + "hidden_effect = true\n", "hidden_effect was False, is now True"),
        ("mine.toml", RIG, RIG + "period_s = 0.2\n", "was run on period_s '0.1', not on '0.2'"),
        ("mine.toml", RIG, RIG + "encoder.counts_per_rev = 4000\n", "encoder.counts_per_rev was 2000, is now 4000"),
    ],
)  # fmt: skip
def test_a_value_that_reaches_the_numbers_is_refused(killed, file, old, new, says):
    before = killed.read_bytes()
    edit(killed.parent / file, old, new)
    with pytest.raises(UsageError) as refusal:
        resume(killed, rig=str(killed.parent / "mine.toml"))
    assert says in str(refusal.value)
    assert killed.read_bytes() == before


def test_many_differences_are_counted(killed):
    for old, new in (("15.0", "18.0"), ("380.0", "390.0"), ("6450.0", "6451.0"), ("840.0", "841.0")):
        edit(killed.parent / "wire.toml", f"value = {old}", f"value = {new}")
    with pytest.raises(UsageError, match=r"transmission\.radius .* wire\.density .*; and 1 more"):
        compared(killed)


# --- what is told --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("file", "old", "new", "says", "reach"),
    [
        ("base.toml", "lease_s = 1.0", "lease_s = 2.0", "lease_s was 1, is now 2", Reach.SAFETY),
        ("base.toml", "temperature_max_K = 185.0", "temperature_max_K = 190.0",
         "limits.temperature_max_K was 185, is now 190", Reach.SAFETY),
        ("wire.toml", "pulley 3 cm in diameter, about", "about", "notes was", Reach.NOTHING),
        ("wire.toml", '"section 5.1.1: pulley 3 cm in diameter"', '"calliper"',
         "transmission.radius.source was", Reach.NOTHING),
        ("mine.toml", RIG, RIG + "# of June\n", "the rig file has another text, but the same values", Reach.NOTHING),
        ("wire.toml", "[wire]", "[wire]  # mine", "the actuator file has another text", Reach.NOTHING),
    ],
)  # fmt: skip
def test_another_difference_is_told(killed, file, old, new, says, reach):
    edit(killed.parent / file, old, new)
    (change,) = compared(killed).changes
    assert says in change.sentence()
    assert change.reach is reach


def test_a_lowered_limit_is_recorded_as_a_warning_and_a_comment_as_a_remark(killed):
    edit(killed.parent / "base.toml", "temperature_max_K = 185.0", "temperature_max_K = 184.0")
    edit(killed.parent / "wire.toml", "[wire]", "[wire]  # mine")
    run = resume(killed, rig=str(killed.parent / "mine.toml"))
    assert run.cause == "done"
    found = {e.data["key"]: (e.level, e.text) for e in run.events if e.kind == "rig"}
    assert found == {
        "limits.temperature_max_K": (
            "warning",
            "Since the interruption: limits.temperature_max_K was 185, is now 184.",
        ),
        "actuator_text": (
            "info",
            "Since the interruption: the actuator file has another text, but the same values.",
        ),
    }
    (resumed,) = [e for e in run.events if e.kind == "resumed"]
    assert "limits.temperature_max_K was 185, is now 184; the actuator file has" in resumed.text


def test_an_unchanged_rig_is_not_mentioned(killed):
    assert compared(killed).remarks == ()
    rig = str(killed.parent / "mine.toml")
    assert not [e for e in resume(killed, rig=rig).events if e.kind == "rig"]


def test_the_noise_of_a_twin_reaches_no_number_of_hardware(killed):
    set_keys(killed, source="bench")
    edit(killed.parent / "base.toml", "noise_counts = 0.4", "noise_counts = 0.5")
    assert [c.key for c in compared(killed).changes] == ["encoder.noise_counts"]
    edit(killed.parent / "base.toml", "counts_per_rev = 2000", "counts_per_rev = 4000")
    with pytest.raises(UsageError, match="counts_per_rev was 2000"):
        compared(killed)


# --- records of other versions, and damage -------------------------------------------------------------------------


def test_a_record_of_an_earlier_version_is_compared_as_far_as_it_goes(killed):
    as_earlier_versions(killed)
    assert compared(killed).changes == ()
    assert "no values of its actuator" in compared(killed).not_compared
    edit(killed.parent / "base.toml", "noise_counts = 0.4", "noise_counts = 0.5")
    with pytest.raises(UsageError, match=r"encoder\.noise_counts was 0\.4, is now 0\.5"):
        compared(killed)


@pytest.mark.parametrize("text", ["", "no rig file", RIG])
def test_its_scale_is_compared_even_if_its_text_is_no_rig(killed, text):
    as_earlier_versions(killed)
    set_keys(killed, config=text)
    assert "no values of its rig and actuator" in compared(killed).not_compared
    edit(killed.parent / "wire.toml", "radius = { value = 15.0", "radius = { value = 18.0")
    with pytest.raises(UsageError, match=r"one count of the encoder was 0\.0471239 mm, is now 0\.0565487 mm"):
        compared(killed)


def test_a_key_that_files_have_only_since_then_is_no_difference(killed):
    values = dict(load_run(killed).meta[RIG_VALUES])
    assert values.pop("hidden_effect") is False
    hashes = load_run(killed).meta[HASHES] | {RIG_VALUES: sha256(values)}
    set_keys(killed, **{RIG_VALUES: values, HASHES: hashes})
    assert compared(killed).changes == ()


@pytest.mark.parametrize("key", ["config", "actuator_text", RIG_VALUES, ACTUATOR_VALUES])
@pytest.mark.parametrize("how", ["missing", "changed"])
def test_values_that_differ_from_their_hash_are_damage(killed, key, how):
    value = load_run(killed).meta[key]
    other = value + " " if isinstance(value, str) else value | {"name": "another"}
    set_keys(killed, **{key: None if how == "missing" else other})
    with pytest.raises(DataError, match=f"its {key} differs from its hash. The record is damaged"):
        compared(killed)


@pytest.mark.parametrize(
    "values", [{}, {"links": 3}, {"links": {"amplifier": 3}}, {"links": {"amplifier": {}}}, {"limits": []}]
)
def test_values_of_no_form_are_a_sentence(killed, values):
    hashes = load_run(killed).meta[HASHES] | {RIG_VALUES: sha256(values)}
    set_keys(killed, **{RIG_VALUES: values, HASHES: hashes})
    with pytest.raises((DataError, UsageError), match="damaged|was made with other values"):
        compared(killed)
