"""A few readings that no sensor can have made are masked and said; many of them say that the unit is wrong."""

import numpy as np
import pytest

from smarig.core import DataError
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
