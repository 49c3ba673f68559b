"""Repairs mask or drop what the findings name, nothing else, and the run keeps which rows."""

import numpy as np
import pytest

from exchange.test_import_mapping_files import PLAIN

MAPPING = PLAIN.replace('unit = "K"', 'unit = "degC"')


@pytest.fixture
def table():
    """A loop of 200 rows, 25 to 85 °C."""
    T = np.concatenate([np.linspace(25, 85, 100), np.linspace(84.7, 25, 100)])
    x = np.where(np.arange(200) < 100, np.clip(T - 50, 0, 20), np.clip(T - 40, 0, 20)) * 100
    return T, x


@pytest.fixture
def run_of(write, imported):
    def do(T, x, **options):
        text = "T;x\n" + "".join(f"{a!r};{b!r}\n" for a, b in zip(T.tolist(), x.tolist()))
        return imported(write(text), mapping=str(write(MAPPING, "map.toml")), **options)

    return do


def test_dropouts_are_found_and_masked_in_the_input_and_its_channel(table, run_of):
    T, x = table
    T[[30, 31, 150]] = 0.0
    plain, run = run_of(T, x), run_of(T, x, repair=True)
    assert any("exactly 0 degC in 3 rows" in w for w in plain.info.warnings)
    kinds, left = ({f.kind for f in r.info.import_findings} for r in (plain, run))
    assert kinds - left == {"drop-outs"}  # they were masked
    assert {f.text for f in plain.info.import_findings} <= set(plain.info.warnings)
    assert plain["input"][30] == 0.0
    for name in ("input", "temperature_degC"):
        assert np.flatnonzero(np.isnan(run[name])).tolist() == [30, 31, 150]
    assert not np.isnan(run["position"]).any()
    kept = run.info.repairs["drop-outs"]
    assert (kept["treatment"], kept["count"], kept["rows"]) == ("masked", 3, [[30, 31], [150, 150]])


def test_a_spike_is_masked_in_its_own_channel_alone(table, run_of):
    T, x = table
    x[120] += 5000.0
    run = run_of(T, x, repair=True)
    assert np.flatnonzero(np.isnan(run["position"])).tolist() == [120]
    assert not np.isnan(run["input"]).any()
    assert set(run.info.repairs) == {"spikes of position"}


def test_rows_written_twice_are_dropped(table, run_of):
    T, x = (np.insert(column, 80, column[79]) for column in table)
    run = run_of(T, x, repair=True)
    assert len(run) == 200
    assert run.info.repairs["repeated rows"]["rows"] == [[80, 80]]
    np.testing.assert_allclose(run["input"], table[0])


def test_sound_data_are_not_touched(table, run_of):
    run = run_of(*table, repair=True)
    assert run.info.repairs == {}
    np.testing.assert_array_equal(run["position"], run_of(*table)["position"])
    assert not any("Repaired" in w for w in run.info.warnings)


def test_a_passage_through_zero_is_no_dropout(table, run_of):
    T, x = table
    run = run_of(np.round(T - 55.0), x, repair=True)
    assert np.any(run["input"] == 0)
    assert "drop-outs" not in run.info.repairs
