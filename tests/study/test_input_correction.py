"""Transformation temperatures of a thermometer whose lag or drift a diagnosis named are those of the wire."""

from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run, lagged
from smarig.diagnosis import Finding
from smarig.study.input_correction import corrected_run, named_correction
from smarig.study.transformation_figures import transformation_of

WIRE, DT = RelayWire(4), 0.5
TEMPERATURES = ("A_s", "A_f", "M_s", "M_f")


def finding(value, name="lag_s", unit="s"):
    return Finding(
        "input_lag", 1.0, {name: {"value": value, "ci95": [0.9 * value, 1.1 * value], "unit": unit}}
    )


def drive(rates):
    """Cycles between 15 and 105 °C, each branch at a rate in K/s."""
    ends = [15.0, *([105.0, 15.0] * (len(rates) // 2))]
    legs = [np.arange(a, b, np.sign(b - a) * r * DT) for a, b, r in zip(ends, ends[1:], rates)]
    return np.concatenate([*legs, [ends[-1]]])


def measured(lag_s, rates, *, clock=True):
    """The run of a thermometer with a lag, and that of the wire itself."""
    u = drive(rates)
    y, noise = WIRE.strain(u), (0.02, 0.004)
    dt = DT if clock else None
    return as_run("read", lagged(u, lag_s, DT), y, dt=dt, noise=noise), as_run(
        "true", u, y, dt=dt, noise=noise
    )


def means(run, lag=None):
    found = transformation_of([run], lag)
    (figures,) = found.result.runs
    return np.array([figures.means[name].value for name in TEMPERATURES]), found


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize(
    ("lag_s", "rates"), [(4.0, (1.0, 1.0, 2.0, 2.0)), (8.0, (0.5, 1.0)), (3.0, (2.0, 0.7))]
)
def test_temperatures_are_those_of_the_wire_and_the_page_says_so(lag_s, rates):
    read, true = measured(lag_s, rates)
    wanted, _ = means(true)
    recorded, plain = means(read)
    corrected, found = means(read, finding(lag_s))
    assert np.abs(recorded - wanted).max() > 0.5 * lag_s * min(rates)
    np.testing.assert_allclose(corrected, wanted, atol=0.15 * lag_s * max(rates))
    assert not plain.correction
    assert f"the lag of the thermometer, {lag_s:.3g} s (" in found.correction
    assert found.lines()[-1] == found.correction
    assert found.to_json()["corrected_for"]["name"] == "input_lag"


def test_temperatures_of_a_thermometer_that_drifts_are_those_of_its_start():
    u = np.tile(drive((1.0, 1.0))[:-1], 2)
    hours = DT * np.arange(u.size) / 3600
    true = as_run("true", u, WIRE.strain(u), dt=DT, noise=(0.02, 0.004))
    read = as_run("read", u + 60.0 * hours, WIRE.strain(u), dt=DT, noise=(0.02, 0.004))
    drift = Finding("input_drift", 1.0, {"drift_per_h": {"value": -60.0, "ci95": None, "unit": "degC per h"}})
    corrected, found = means(read, drift)
    np.testing.assert_allclose(corrected, means(true)[0], atol=0.3)
    assert "the drift of the thermometer, -60 degC per h;" in found.correction


def test_a_lag_in_rows_is_corrected_too():
    read, true = measured(4.0, (1.0, 2.0), clock=False)
    lag = finding(4.0 / DT, "lag_rows", "rows")
    np.testing.assert_allclose(means(read, lag)[0], means(true)[0], atol=1.0)
    assert "8 rows (7.2 to 8.8 rows)" in means(read, lag)[1].correction


def test_rows_without_a_reading_stay_as_they_are():
    read, _ = measured(4.0, (1.0, 1.0))
    read["input"][5] = np.nan
    found = corrected_run(read, finding(4.0))
    np.testing.assert_array_equal(np.isnan(found["input"]), np.isnan(read["input"]))
    assert found["position"] is read["position"]


def test_only_a_diagnosis_that_names_a_lag_has_one():
    assert named_correction(None) is None
    assert named_correction(SimpleNamespace(verdict=SimpleNamespace(word="named"))) is None
