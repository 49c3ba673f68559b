"""The typed description of a run: every key has an attribute, nothing is lost, and unusual values do no
harm."""

import json
from dataclasses import fields

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from smarig.record.metadata import KEY_TYPES, check_metadata
from smarig.record.run_info import RunInfo, SignalInfo

META = {
    "schema_version": 1,
    "protocol": "wiping_out",
    "settings": {"cycles": "3"},
    "rig": "one_wire_twin",
    "wire": "A",
    "actuator": "gorbet_one_wire",
    "source": "twin",
    "seed": 7,
    "effects": ["fatigue(rate=0.1)"],
    "start_epoch": 1.8e9,
    "period_s": 0.1,
    "input": {"quantity": "wire temperature above ambient", "unit": "K", "from": "heating model"},
    "output": {"quantity": "displacement", "unit": "mm", "per_count": 0.047},
    "begun_with": {"rig": "one_wire_twin", "effects": []},
    "closed_loop": True,
    "shift": {"ticks": 3, "counts": -2},
    "imported": {"file": "a.csv", "format": "csv", "mapping": None, "sha256": "0"},
    "conditions": {"stress": {"unit": "MPa", "mean": 50.0}},
    "warnings": ["It was hot."],
    "end": {"cause": "done", "epoch": 1.8e9},
    "of a newer version": [1, {"a": None}],
}
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=8,
)
NAMES = sorted({*KEY_TYPES, *META, "header", "companions", "forc", "recorder_pid"})
INNER = st.dictionaries(
    st.sampled_from(["quantity", "unit", "from", "per_count", "cause", "epoch", "file"]), JSON, max_size=4
)
ANY_META = st.dictionaries(st.sampled_from(NAMES) | st.text(), JSON | INNER, max_size=12)


def test_keys_are_typed_attributes():
    info = RunInfo.of(META)
    assert (info.protocol, info.rig, info.wire, info.source, info.seed) == (
        "wiping_out",
        "one_wire_twin",
        "A",
        "twin",
        7,
    )
    assert (info.input.from_, info.output.per_count, info.output.resolution) == (
        "heating model",
        0.047,
        0.047,
    )
    assert info.effects == ("fatigue(rate=0.1)",)
    assert info.launch_args == META["begun_with"]
    assert info.closed_loop
    assert info.end is not None
    assert info.end.cause == "done"
    assert info.imported is not None
    assert info.imported.file == "a.csv"
    assert info.extra == {"of a newer version": [1, {"a": None}]}


def test_an_empty_description_has_defaults():
    info = RunInfo.of({})
    assert info == RunInfo()
    assert (info.protocol, info.settings, info.warnings, info.end, info.launch_args) == (
        None,
        {},
        (),
        None,
        None,
    )
    assert info.output == SignalInfo()
    assert info.output.resolution == 0.0


def test_a_null_key_is_present_and_an_absent_one_is_not():
    info = RunInfo.of({"rig": None})
    assert info.rig is None
    assert info.has("rig")
    assert not info.has("wire")
    assert (info.text_of("rig", "unnamed"), info.text_of("wire", "unnamed")) == ("None", "unnamed")


@pytest.mark.parametrize("key", sorted(KEY_TYPES))
def test_every_key_that_is_checked_has_an_attribute(key):
    assert {"begun_with": "launch_args"}.get(key, key) in {f.name for f in fields(RunInfo)}


@pytest.mark.parametrize("key", sorted(KEY_TYPES))
def test_a_value_of_another_type_is_not_known_but_kept(key):
    odd = {"seven": 7} if key in ("effects", "warnings", "findings", "own_files", "instruments") else [7]
    with pytest.raises(TypeError, match=f"its key '{key}' is not"):
        check_metadata({key: odd})
    info = RunInfo.of({key: odd})
    attribute = {"begun_with": "launch_args"}.get(key, key)
    assert getattr(info, attribute) == getattr(RunInfo(), attribute)
    assert info.extra[key] == odd


@pytest.mark.long("takes three seconds")
@given(meta=ANY_META)
@example(meta=META)
@example(meta={"actuator": "\ud800"})
@example(meta={"imported": {}, "input": None, "effects": [7, None], "closed_loop": "yes"})
def test_nothing_is_lost_and_nothing_fails(meta):
    info = RunInfo.of(meta)
    again = info.to_json()
    assert again == meta
    assert list(again) == list(meta)
    assert json.dumps(again) == json.dumps(meta)
    assert RunInfo.of(again) == info
    for key in meta:
        assert info.has(key)
        assert isinstance(info.text_of(key, ""), str)
    assert info.output.resolution == (info.output.per_count or 0.0)


@given(meta=ANY_META)
def test_what_a_file_may_hold_is_read_as_it_stands(meta):
    """Whatever the loader lets through stands in an attribute or, null or unknown, in ``extra``."""
    try:
        check_metadata(meta)
    except (TypeError, AttributeError):
        return
    info = RunInfo.of(meta)
    for key in set(meta) & set(KEY_TYPES):
        assert key not in info.extra or meta[key] in (None, {})


@pytest.mark.parametrize(
    "stored", [{"kind": [], "text": "x"}, {"kind": {}, "text": 1}, {"kind": "new", "text": "x"}, 7, None]
)
def test_a_finding_of_an_unknown_kind_has_none(stored):
    assert [f.kind for f in RunInfo.of({"findings": [stored]}).import_findings] in ([None], [])
