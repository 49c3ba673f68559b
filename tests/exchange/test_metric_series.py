"""Series of Prometheus are columns of one table, with the units at the ends of their names."""

import json

import numpy as np
import pytest

from smarig.core import DataError
from smarig.exchange import find_tables

T = 1.69e9 + 10.0 * np.arange(240)
U = np.round(60 - 35 * np.cos(np.linspace(0, 12, T.size)), 2)
Y = np.round(2e-3 * np.tanh((U - 60) / 9), 7)


def series(name, t, x, **labels):
    pairs = [[float(time), f"{value}" if np.isfinite(value) else "NaN"] for time, value in zip(t, x)]
    return {"metric": {"__name__": name, "job": "rig", **labels}, "values": pairs}


def found(tmp_path, *result, indent=None):
    path = tmp_path / "query.json"
    document = {"status": "success", "data": {"resultType": "matrix", "result": result}}
    path.write_text(json.dumps(document, indent=indent))
    (table,) = find_tables(path)
    return table


@pytest.mark.parametrize("indent", [None, 1])
def test_readings_that_are_missing_leave_the_others_in_their_rows(tmp_path, indent):
    lost = [5, 6, 120]
    u = U.copy()
    u[77] = np.nan
    table = found(
        tmp_path,
        series("wire_stroke_meters", np.delete(T, lost) + 0.2, np.delete(Y, lost)),
        series("wire_celsius", T, u),
        indent=indent,
    )
    assert [(c.name, c.unit) for c in table.columns] == [
        ("time", "s"),
        ("wire_stroke_meters", "m"),
        ("wire_celsius", "degC"),
    ]
    time, stroke, temperature = (c.values for c in table.columns)
    np.testing.assert_array_equal(time, T)
    np.testing.assert_array_equal(temperature, u)
    assert np.flatnonzero(np.isnan(stroke)).tolist() == lost
    np.testing.assert_array_equal(np.delete(stroke, lost), np.delete(Y, lost))


def test_labels_that_differ_tell_series_of_one_name_apart(tmp_path):
    table = found(
        tmp_path,
        series("wire_kelvin", T, U + 273.15, at="top", host="a"),
        series("wire_kelvin", T, U + 274.15, at="end", host="a"),
        series("heater_duty_ratio", T, U / 100, at="top", host="b"),
        series("pulses_total", T, np.arange(T.size), host="b"),
    )
    assert [(c.name, c.unit) for c in table.columns] == [
        ("time", "s"),
        ("wire_kelvin at=top", "K"),
        ("wire_kelvin at=end", "K"),
        ("heater_duty_ratio", "1"),
        ("pulses_total", ""),
    ]
    assert table.header["job"] == "rig"
    np.testing.assert_array_equal(table.columns[2].values, U + 274.15)


def test_an_instant_is_no_table(tmp_path):
    with pytest.raises(DataError, match="without an array"):
        found(tmp_path, {"metric": {"__name__": "up"}, "value": [T[0], "1"]})
