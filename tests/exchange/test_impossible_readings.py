"""A few readings that no sensor can have made are masked and said; many of them say that the unit is wrong."""

import numpy as np
import pytest

from smarig.core import DataError
from smarig.exchange.checks.channel_faults import error_codes
from smarig.study import StudyOptions, study

ROWS = 400
T = np.arange(ROWS) * 0.5
U = np.round(60 - 35 * np.cos(np.linspace(0, 6 * np.pi, ROWS)), 3)
MAPPING = """
name = "made"
summary = "A test."
source = "this test"
[time]
column = "t"
[columns]
temperature_degC = { column = "T", unit = "UNIT" }
position = { column = "x", unit = "mm/mm" }
[input]
channel = "temperature_degC"
quantity = "temperature"
unit = "degC"
[output]
quantity = "strain"
unit = "mm/mm"
"""


def text(u, y):
    rows = [f"{a:g},{b:.6g},{c:.6g}" for a, b, c in zip(T, u, y, strict=True)]
    return "t,T,x\n" + "\n".join(rows) + "\n"


def codes(values, count, code):
    out = np.array(values, dtype=float)
    out[np.linspace(20, ROWS - 20, count).astype(int)] = code
    return out


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("code", [2047.75, -1999.0, 9999.0, 1e12])
@pytest.mark.parametrize("count", [1, 5, 12])
def test_a_few_are_masked(write, imported, code, count):
    path = write(text(codes(U, count, code), 0.02 * (U - 60) / 40))
    run = imported(path, mapping=str(write(MAPPING.replace("UNIT", "degC"), "m.toml")))
    assert int(np.isnan(run["input"]).sum()) == count
    assert np.isfinite(run["position"]).all()
    found = [w for w in run.info.warnings if "masked" in w]
    what = "1 reading of 400 is masked" if count == 1 else f"{count} readings of 400 are masked"
    assert found == [w for w in found if w.startswith(f"{what}: {code:g} degC in line 22")]
    assert len(found) == 1


def test_many_say_that_the_unit_is_wrong(write, imported):
    path = write(text(codes(U, 40, 2047.75), 0.02 * (U - 60) / 40))
    with pytest.raises(DataError, match=r"line 22, column 'T': 2047.75 degC .* Is the unit right\?"):
        imported(path, mapping=str(write(MAPPING.replace("UNIT", "degC"), "m.toml")))


def test_an_impossible_strain_is_masked_too(write, imported):
    strain = 0.02 * (U - 60) / 40
    mapping = str(write(MAPPING.replace("UNIT", "degC"), "m.toml"))
    run = imported(write(text(U, codes(strain, 2, 7.5))), mapping=mapping)
    assert int(np.isnan(run["position"]).sum()) == 2
    with pytest.raises(DataError, match=r"more than any shape-memory alloy recovers|Is the unit right"):
        imported(write(text(U, 100 * strain)), mapping=mapping)


def test_a_study_goes_on_and_says_so(write, tmp_path):
    y = 2 * (1 + np.tanh((U - np.where(np.gradient(U) > 0, 70, 55)) / 6))
    path = write(text(codes(U, 1, 2047.75), y).replace("t,T,x", "time_s,T_degC,x_mm"))
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    (said,) = [hint for hint in result.hints() if "masked" in hint]
    assert said.startswith("1 reading of 400 is masked: 2047.75 degC in line 22, outside -273.15 … 1500 degC")
    assert "masked" in (tmp_path / "out" / "index.html").read_text(encoding="utf-8")


def test_the_given_log(shared_data, tmp_path):
    path = shared_data / "field_cases" / "one_error_code_stops_the_file" / "log.csv"
    if not path.is_file():
        pytest.skip(f"no {path.name} in {path.parent}")
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    assert any("1 reading of 541 is masked: 2047.75" in hint for hint in result.hints())


def strains(code, rows, gaps=()):
    """Readings of a noisy channel with a code of an error, and cells without a reading."""
    out = 2000 + 1000 * np.tanh((U - 60) / 9) + np.random.default_rng(5).normal(0, 3, ROWS)
    out[list(rows)], out[list(gaps)] = code, np.nan
    return out


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("code", [-7999.0, 6999.0, -32768.0, 1e9])
@pytest.mark.parametrize("rows", [(33, 140), (50, 120, 121 + 80, 390)])
@pytest.mark.parametrize("gaps", [(), (32, 34, 77)])
def test_a_code_in_single_rows_is_masked_and_said(write, tmp_path, code, rows, gaps):
    text = text_of(strains(code, rows, gaps))
    result = study([write(text)], tmp_path / "out", StudyOptions(diagnose=False))
    (said,) = [hint for hint in result.hints() if "masked" in hint]
    code_said = f"{code:g} in single rows, the first in line " if code < 1e6 else ""  # no strain is 1000
    assert said.startswith(f"{len(rows)} readings of 400 are masked: {code_said}")
    position = result.tables[0].run["position"]
    assert sorted(np.flatnonzero(np.isnan(position)).tolist()) == sorted({*rows, *gaps})


@pytest.mark.parametrize(
    "x",
    [
        strains(7000.0, [70]),  # one spike
        strains(2000.0, [20, 60, 300]),  # within the readings
        np.minimum(strains(0, []), 2900.0),  # a channel that is clipped
        np.where(np.arange(ROWS) % 7 == 0, 5.0, strains(0, []) / 1e4),  # pulses
        np.repeat(np.arange(40.0), 10),
    ],
)
def test_what_may_be_readings_is_kept(x):
    assert not error_codes(x).any()


def test_a_code_in_a_column_of_a_condition_is_no_change_of_it(write, tmp_path):
    load = codes(5 + np.random.default_rng(1).normal(0, 0.01, ROWS), 3, -9999.0)
    y = 2 * (1 + np.tanh((U - np.where(np.gradient(U) > 0, 70, 55)) / 6))
    rows = [f"{t:g},{u:g},{x:.5g},{f:.4f}" for t, u, x, f in zip(T, U, y, load, strict=True)]
    path = write("time_s,T_degC,x_mm,load_N\n" + "\n".join(rows) + "\n")
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    assert result.tables[0].run.meta["conditions"]["load"]["mean"] == pytest.approx(5, abs=0.01)
    assert any("3 readings of 400 are masked: -9999 in single rows" in hint for hint in result.hints())


def text_of(strain):
    cells = ["" if np.isnan(x) else f"{x:.6g}" for x in strain]
    rows = [f"{t:g},{u:g},{x}" for t, u, x in zip(T, U, cells, strict=True)]
    return "time_s,T_degC,gauge (microstrain)\n" + "\n".join(rows) + "\n"
