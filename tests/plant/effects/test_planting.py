"""Effects from command lines, model files and seeds, and the rig with a hidden effect."""

import json
from dataclasses import replace

import pytest

from smarig.cli import run
from smarig.config import load_rig
from smarig.core.errors import DataError, UsageError
from smarig.plant.effect_catalogue import effect_types, effects_from_json, effects_from_pairs, mystery_effects
from smarig.record import load_run
from smarig.rig.twin import Twin
from smarig.runner.preview import preview


def test_pairs_name_strengths_and_parameters():
    settling, walking = effects_from_pairs(["settling.time_constant_s=900", "walking=0.5", "settling=3"])
    assert settling.values == {"share_percent": 3.0, "time_constant_s": 900.0}
    assert walking.strength == 0.5
    assert effects_from_pairs(["creep"])[0].strength == 1.0


@pytest.mark.parametrize(
    ("pair", "message"),
    [
        ("setling=1", "No effect 'setling'; did you mean settling"),
        ("settling=much", "'settling=much' is not NAME=NUMBER"),
        ("settling.tau=3", "settling has no parameter 'tau'"),
        ("settling=50", "settling.share_percent = 50.0 must lie between 0 and 10 %"),
        ("settling=nan", "must lie between"),
        ("", "No effect ''"),
        ("settling.share_percent", "not NAME=NUMBER"),
    ],
)
def test_what_is_no_effect_is_refused(pair, message):
    with pytest.raises(UsageError, match=message):
        effects_from_pairs([pair])


def test_a_model_file_gives_back_what_was_written():
    effects = effects_from_pairs(["settling=3", "walking=-0.5"])
    assert effects_from_json(json.loads(json.dumps([e.to_json() for e in effects]))) == effects
    wrong = [
        {},
        {"name": "x", "parameters": {}},
        {"name": "creep", "parameters": {"a": 1}},
        3,
        {"name": "creep"},
    ]
    for record in wrong:
        with pytest.raises(DataError):
            effects_from_json([record])


def test_duplicate_or_longer_entries_are_no_effects():
    creep = {"name": "creep", "parameters": {"percent_per_decade": 1.0}}
    with pytest.raises(DataError, match="creep occurs twice"):
        effects_from_json([creep, creep])
    with pytest.raises(DataError, match="unexpected keyword"):
        effects_from_json([creep | {"since": 1997}])


def test_one_wire_has_no_other_that_would_warm_it():
    with pytest.raises(UsageError, match="cross_talk needs two wires, but this rig has one"):
        Twin.named("one_wire_twin", effects=effects_from_pairs(["cross_talk=2"]))
    assert Twin.named("two_wire_twin", effects=effects_from_pairs(["cross_talk=2"]))


def test_kinds_of_a_rig_leave_out_what_needs_another():
    assert {k.name for k in effect_types()} - {k.name for k in effect_types("one_wire")} == {
        "cross_talk",
        "training",
    }
    assert {k.name for k in effect_types()} - {k.name for k in effect_types("two_wire")} == {
        "training"
    }  # rigs' wires are trained


def test_a_seed_hides_one_effect_or_none_and_every_effect_has_seeds():
    drawn = [mystery_effects(seed, "one_wire") for seed in range(600)]
    assert drawn == [mystery_effects(seed, "one_wire") for seed in range(600)]
    assert 0.08 < sum(not d for d in drawn) / 600 < 0.25
    assert {d[0].kind.name for d in drawn if d} == {k.name for k in effect_types("one_wire")}
    for hidden in drawn:
        for e in hidden:
            share = abs(e.strength / e.kind.primary.typical)
            assert 0.6 <= share <= 1.8


@pytest.mark.long("takes five seconds")
def test_the_mystery_rig_behaves_like_its_hidden_effect_and_does_not_reveal_it(tmp_path):
    seed = next(
        s
        for s in range(99)
        if mystery_effects(s, "one_wire") and mystery_effects(s, "one_wire")[0].kind.name == "backlash"
    )
    hides = Twin.named("mystery", seed=seed)
    openly = Twin.named("one_wire_twin", seed=seed, effects=mystery_effects(seed, "one_wire"))
    drive = [0.8] * 200 + [0.3] * 200
    assert [hides.step(i)[0].counts for i in drive] == [openly.step(i)[0].counts for i in drive]
    out = tmp_path / "m.run.sqlite"
    assert run(["run", "wiping_out", "--rig", "mystery", "--seed", str(seed), "-o", str(out), "--quiet"]) == 0
    meta = load_run(out).meta
    assert meta["effects"] == []
    assert "backlash" not in json.dumps(meta)


@pytest.mark.long("takes five seconds")
def test_run_plants_effects_on_a_twin_and_records_them(tmp_path):
    out = tmp_path / "c.run.sqlite"
    line = ["run", "wiping_out", "--rig", "one_wire_twin", "-o", str(out), "--quiet"]
    assert run([*line, "--effect", "walking=0.5", "--effect", "settling"]) == 0
    assert load_run(out).meta["effects"] == [
        "walking(percent_per_cycle=0.5)",
        "settling(share_percent=2, time_constant_s=600)",
    ]
    assert run([*line, "--force", "--effect", "walkin=0.5"]) == 2
    assert load_run(out).meta["effects"]  # what was there stays


@pytest.mark.parametrize(
    ("pairs", "said"),
    [
        (["backlash."], "not NAME=NUMBER"),
        (["backlash=1", "backlash=2"], "repeats"),
        (["backlash=1", "backlash.play_percent=1"], "repeats"),
    ],
)
def test_repeated_or_incomplete_pairs_are_refused(pairs, said):
    with pytest.raises(UsageError, match=said):
        effects_from_pairs(pairs)


def test_a_preview_reveals_nothing_of_a_mystery():
    plain, hidden = (preview("wiping_out", load_rig(name)) for name in ("one_wire_twin", "mystery"))
    assert replace(hidden, protocol=plain.protocol) == plain
