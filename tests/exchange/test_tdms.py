"""LabVIEW TDMS files: groups are tables, channels keep names and units, a common waveform clock is a column."""

import sys

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from extras import skip_without
from smarig.core import DataError, MissingExtra, UsageError
from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import StudyOptions, guess_table, mapping_draft, study
from smarig.study.stated_conditions import stated_conditions

skip_without("nptdms", extra="tdms")

from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter  # noqa: E402

ROWS = 200
U = 60 - 35 * np.cos(np.linspace(0, 6 * np.pi, ROWS))
X = 2 * (1 + np.tanh((U - np.where(np.gradient(U) > 0, 70, 55)) / 6))


def written(path, groups, *, step=0.5, unit_key="unit_string"):
    """A file of groups {name: {channel: (values, unit)}}."""
    objects = [RootObject(properties={"name": "rig"})]
    for group, channels in groups.items():
        objects.append(GroupObject(group))
        for name, (values, unit) in channels.items():
            properties = {unit_key: unit} | ({"wf_increment": step} if step else {})
            objects.append(ChannelObject(group, name, np.asarray(values), properties=properties))
    with TdmsWriter(path) as writer:
        writer.write_segment(objects)
    return path


CHANNELS = {"Temperature": (U, "degC"), "Displacement": (X, "mm")}


@pytest.mark.parametrize("unit_key", ["unit_string", "NI_UnitDescription"])
@pytest.mark.parametrize("kind", ["f8", "f4", "i2"])
def test_a_group_is_a_table_with_units_and_the_clock(tmp_path, unit_key, kind):
    channels = {"Temperature": (U.astype(kind), "degC"), "Displacement": ((1000 * X).astype(kind), "um")}
    (table,) = find_tables(written(tmp_path / "a.tdms", {"Run": channels}, unit_key=unit_key))
    assert table.names == ("time", "Temperature", "Displacement")
    assert [column.unit for column in table.columns] == ["s", "degC", "um"]
    np.testing.assert_allclose(table.columns[0].values, 0.5 * np.arange(ROWS))
    np.testing.assert_array_equal(table.columns[1].values, U.astype(kind))
    assert table.header == {"name": "rig"}


def test_each_group_is_a_table_and_texts_and_other_lengths_are_left_out(tmp_path):
    groups = {
        "one": CHANNELS | {"short": (U[:50], "V")},
        "two": {name: (values[:90], unit) for name, (values, unit) in CHANNELS.items()},
        "alone": {"Temperature": (U, "degC")},
        "comments": {"Operator": (np.array(["Li", "Roy"]), "")},
    }
    tables = find_tables(written(tmp_path / "a.tdms", groups, step=0))
    assert [(t.name, t.names, len(t)) for t in tables[:2]] == [
        ("one", ("Temperature", "Displacement"), ROWS),
        ("two", ("Temperature", "Displacement"), 90),
    ]
    assert len(tables) == 2


def channel(group, name, values, step, start, **properties):
    clock = {"wf_increment": step, "wf_start_time": np.datetime64("2021-05-04T08:00:00") + start}
    return ChannelObject(group, name, np.asarray(values), properties=clock | properties)


def test_channels_of_several_clocks_are_joined_on_time(tmp_path):
    late = np.timedelta64(1000, "ms")
    path = tmp_path / "a.tdms"
    with TdmsWriter(path) as writer:
        writer.write_segment(
            [
                channel("Run", "Dev1/ai3", U[2::4], 2.0, late, unit_string="degC", NI_ChannelName="bath"),
                channel("Run", "Dev2/ai0", X, 0.5, 0 * late, unit_string="mV/V"),
            ]
        )
    (table,) = find_tables(path)
    clock, bath, ratio = table.columns
    np.testing.assert_allclose(clock.values, 0.5 * np.arange(ROWS))
    np.testing.assert_array_equal(ratio.values, X)
    np.testing.assert_array_equal(bath.values[2::4], U[2::4])
    assert np.isfinite(bath.values).sum() == U[2::4].size
    assert (bath.comment, ratio.comment) == ("bath", "")
    draft = tmp_path / "m.toml"
    draft.write_text(mapping_draft(guess_table(table), "m"), encoding="utf-8")
    report = import_file(path, format="tdms", out=tmp_path / "a.run.sqlite", mapping=str(draft))
    (told,) = [f.text for f in report.findings if "The rows are the readings of" in f.text]
    assert "'Dev2/ai0', and those of another stand in the row that is nearest in time" in told
    assert not any("empty or NaN" in f.text for f in report.findings)


def test_loads_in_names_and_two_rates_give_the_right_channels(tmp_path):
    rng = np.random.default_rng(3)
    path = tmp_path / "rig.tdms"
    with TdmsWriter(path) as writer:
        for load, name in ((2.0, "2 lbf"), (3.5, "3.5 lbf")):
            x = -7 + load * X + rng.normal(0, 0.01, ROWS)
            supply = 5 + rng.normal(0, 1e-3, ROWS)
            room = 22 + rng.normal(0, 0.02, U[::2].size)
            channels = {"a0": (x, 1, "mV/V"), "b0": (U[::2], 2, "deg C"), "b1": (room, 2, "deg C")}
            for own, (values, step, unit) in (channels | {"a1": (supply, 1, "V")}).items():
                at = np.timedelta64(0, "s")
                writer.write_segment([channel(name, own, values, float(step), at, unit_string=unit)])
    tables = find_tables(path)
    for table, load in zip(tables, (2.0, 3.5), strict=True):
        guess = guess_table(table)
        assert [c.name for role in ("time", "input", "output") for c in guess.of_role(role)] == [
            "time",
            "b0",
            "a0",
        ]
        assert not guess.doubts
        assert stated_conditions(guess)["load"][:2] == (load, "lbf")


def test_channels_of_times_and_an_own_time(tmp_path):
    when = np.datetime64("2024-03-01T12:00:00") + (500 * np.arange(ROWS)).astype("timedelta64[ms]")
    path = written(tmp_path / "a.tdms", {"Run": {"time": (when, "")} | CHANNELS})
    (table,) = find_tables(path)
    assert table.names == ("time", "Temperature", "Displacement")
    np.testing.assert_allclose(table.columns[0].values, 0.5 * np.arange(ROWS), atol=1e-6)


def test_a_draft_reads_the_group_again_and_a_study_models_it(tmp_path):
    path = written(tmp_path / "a.tdms", {"Run": CHANNELS, "other": CHANNELS})
    guess = guess_table(find_tables(path)[0])
    draft = tmp_path / "m.toml"
    draft.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    report = import_file(path, format="tdms", out=tmp_path / "a.run.sqlite", mapping=str(draft))
    run = load_run(report.run)
    np.testing.assert_allclose(run["input"], U)
    np.testing.assert_allclose(run["t_s"], 0.5 * np.arange(ROWS))
    draft.write_text(draft.read_text().replace('"Run"', '"Ran"'))
    with pytest.raises(UsageError, match="no group 'Ran'. Its groups are: Run, other"):
        import_file(path, format="tdms", out=tmp_path / "b.run.sqlite", mapping=str(draft))
    with pytest.raises(UsageError, match="needs a mapping file"):
        import_file(path, format="tdms", out=tmp_path / "b.run.sqlite")
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    assert result.unit == "mm"


def test_a_file_without_a_table(tmp_path):
    path = written(tmp_path / "a.tdms", {"Run": {"Temperature": (U, "degC")}}, step=0)
    with pytest.raises(DataError, match="no group with two numeric channels"):
        find_tables(path)


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_damaged_bytes_are_an_error_of_one_sentence(tmp_path, data):
    good = written(tmp_path / "good.tdms", {"Run": CHANNELS}).read_bytes()
    at = data.draw(st.integers(4, 600))
    bad = (
        good[:at]
        if data.draw(st.booleans())
        else good[:at] + bytes([data.draw(st.integers(0, 255))]) + good[at + 1 :]
    )
    path = tmp_path / "bad.tdms"
    path.write_bytes(bad)
    try:
        find_tables(path)
    except DataError as error:
        assert str(path) in str(error)  # noqa: PT017


def test_without_the_package_the_extra_is_named(tmp_path, monkeypatch):
    path = written(tmp_path / "a.tdms", {"Run": CHANNELS})
    monkeypatch.setitem(sys.modules, "nptdms", None)
    with pytest.raises(
        MissingExtra, match=r"LabVIEW TDMS file needs the extra 'tdms': pip install 'smarig\[tdms\]'"
    ):
        find_tables(path)


def test_the_given_file(shared_data):
    path = shared_data / "field_cases" / "other_containers" / "rig.tdms"
    if not path.is_file():
        pytest.skip(f"no {path.name} in {path.parent}")
    (table,) = find_tables(path)
    assert table.names == ("time", "Current", "Temperature", "Displacement")
    assert [column.unit for column in table.columns] == ["s", "A", "degC", "mm"]


def test_an_impossible_length_is_damage_and_no_lack_of_memory(tmp_path, monkeypatch):
    """A few damaged bytes ask for gigabytes of text."""
    path = written(tmp_path / "a.tdms", {"Run": CHANNELS})

    def asks_for_all(*_, **__):
        raise MemoryError

    monkeypatch.setattr("nptdms.TdmsFile.open", asks_for_all)
    with pytest.raises(DataError, match=r"is no TDMS file, or is damaged \(an impossible length\)"):
        find_tables(path)
