"""−127 °C and 85 °C of a DS18B20 are no temperatures where the wire is far from them; others are."""

import numpy as np
import pytest

from smarig.exchange import import_file
from smarig.record import load_run

ROWS = 400
U = np.round(16 * (55 - 33 * np.cos(np.linspace(0, 4 * np.pi, ROWS)))) / 16  # steps of the thermometer
FROM_CELSIUS = {"degC": lambda u: u, "degF": lambda u: 32 + 1.8 * u, "K": lambda u: u + 273.15}


def imported(tmp_path, u, unit="degC"):
    """The temperature of a run whose file states ``u`` in °C in ``unit``, and its findings."""
    rows = [
        f"{0.75 * k:.2f},{a:.4f},{np.tanh(b):.5f}"
        for k, (a, b) in enumerate(zip(FROM_CELSIUS[unit](u), (U - 55) / 9))
    ]
    (tmp_path / "a.csv").write_text("\n".join(["t,T,x", *rows]) + "\n")
    mapping = f'''
name = "m"
summary = "Stroke against temperature."
source = "a.csv"
[file]
delimiter = "comma"
[time]
column = "t"
unit = "s"
[columns]
temperature_degC = {{ column = "T", unit = "{unit}" }}
position = {{ column = "x", unit = "mm" }}
[input]
channel = "temperature_degC"
quantity = "temperature"
unit = "degC"
[output]
quantity = "displacement"
unit = "mm"
'''
    (tmp_path / "m.toml").write_text(mapping)
    report = import_file(
        tmp_path / "a.csv", format="csv", out=tmp_path / "a.run.sqlite", mapping=str(tmp_path / "m.toml")
    )
    return load_run(report.run)["input"], [text for text in report.warnings if "DS18B20" in text]


@pytest.mark.parametrize("unit", FROM_CELSIUS)
@pytest.mark.parametrize("rows", [[37], [0, 150, 151, 152, ROWS - 1], list(range(90, 240))])
def test_no_answer(tmp_path, unit, rows):
    u = U.copy()
    u[rows] = -127
    read, texts = imported(tmp_path, u, unit)
    assert np.flatnonzero(np.isnan(read)).tolist() == rows
    (text,) = texts
    assert f"{len(rows)} of {ROWS} readings are masked, because they are exactly -127 degC" in text
    assert f"(first: line {rows[0] + 2})" in text


def test_the_value_at_power_on_beside_no_answer(tmp_path):
    u = U.copy()
    u[[0, 180, 395]], u[[50, 51]] = 85, -127
    read, texts = imported(tmp_path, u)
    assert np.flatnonzero(np.isnan(read)).tolist() == [0, 50, 51, 180, 395]
    assert [text.split("(")[0].split("exactly")[1].split(",")[0] for text in texts] == [
        " -127 degC",
        " 85 degC",
    ]


STEPS = np.repeat([20.0, 55.0, 85.0, 55.0], 100)
TEMPERATURES = {
    "through 85": np.round(U),
    "held at 85": STEPS,
    "85 in every other row": np.tile([25.0, 85.0], 200),
    "cooled through -127": np.round(-120 + 40 * np.cos(np.linspace(0, 6, ROWS))),
}


@pytest.mark.parametrize("name", TEMPERATURES)
def test_temperatures_of_the_wire_stay(tmp_path, name):
    u = TEMPERATURES[name]
    assert np.isin(u, [85, -127]).any()
    read, texts = imported(tmp_path, u)
    assert not texts
    np.testing.assert_allclose(read, u)
