"""A sensor that stands still while the input moves: its rows are masked and told; a wire that rests is none."""

import numpy as np
import pytest

from smarig.exchange import import_file
from smarig.exchange.checks.frozen_readings import frozen, without_frozen
from smarig.record import load_run

ROWS = 1200
LINE = np.arange(3, ROWS + 3)
U = 320 + 40 * np.sin(np.arange(ROWS) * 6 * np.pi / ROWS)
X = 70 * np.tanh((np.roll(U, 12) - 325) / 12)
NOISY = np.round(X + np.random.default_rng(8).normal(0, 0.2, ROWS), 1)


def stuck(y, first=430, rows=50):
    out = y.copy()
    out[first : first + rows] = out[first]
    return out


@pytest.mark.parametrize("first", [430, 520, 830])
def test_rows_of_a_stuck_sensor_are_masked_and_told(first):
    y, (finding,) = without_frozen("um", U, stuck(NOISY, first), LINE)
    assert 50 <= np.isnan(y).sum() <= 52  # a neighbour may have the same value
    assert np.isnan(y[first : first + 50]).all()
    assert finding.kind == "frozen readings"
    assert f"to {LINE[first + 49]}) while the input moves" in finding.text


def test_each_of_two_places_is_found():
    y = stuck(stuck(NOISY), first=830, rows=80)
    found, findings = without_frozen("um", U, y, LINE)
    assert len(findings) == 2
    assert np.isnan(found[430:480]).all()
    assert np.isnan(found[830:910]).all()


@pytest.mark.parametrize(
    ("u", "y"),
    [
        (U, NOISY),
        (U, np.round(X, -1)),  # a coarse encoder
        (U, np.round(X)),  # rests at both ends of its travel
        (U, np.clip(NOISY, -40, 40)),  # an end stop
        (np.where((np.arange(ROWS) >= 430) & (np.arange(ROWS) < 480), U[430], U), stuck(NOISY)),  # held
        (U, np.repeat(NOISY[::20], 20)),  # read more often than it converts
    ],
)
def test_a_wire_that_rests_is_not_stuck(u, y):
    assert frozen(u, y) == []


def test_the_import_leaves_them_out_and_says_so(tmp_path):
    path, mapping = tmp_path / "log.csv", tmp_path / "m.toml"
    rows = [f"{2 * k};{U[k]:.2f};{y}" for k, y in enumerate(stuck(NOISY))]
    path.write_text("\n".join(["t;T;x", *rows]) + "\n")
    mapping.write_text(
        'name = "a"\nsummary = "b"\nsource = "c"\n[time]\ncolumn = "t"\nunit = "s"\n[columns]\n'
        'temperature_degC = { column = "T", unit = "K" }\nposition = { column = "x", unit = "um" }\n'
        '[input]\nchannel = "temperature_degC"\nquantity = "temperature"\nunit = "degC"\n'
        '[output]\nquantity = "displacement"\nunit = "um"\n'
    )
    report = import_file(path, format="csv", out=tmp_path / "a.run.sqlite", mapping=str(mapping))
    assert "frozen readings" in [f.kind for f in report.findings]
    assert np.isnan(load_run(report.run)["position"][430:480]).all()
