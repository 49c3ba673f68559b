"""Cells that carry their unit: one unit for each column, converted where units mix, or a refusal with the cell."""

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

N = 120
T = np.round(62 - 38 * np.cos(np.linspace(0, 4 * np.pi, N)), 1)
S_MM = np.round(0.3 + 2.3 * (1 + np.tanh((T - np.where(np.gradient(T) > 0, 68, 54)) / 5)), 3)


def degrees(value):
    return f"{value} °C"


def length(value):
    """As a dashboard writes it: the prefix by the size."""
    return f"{value:.2f} mm" if value >= 1 else f"{1000 * value:.0f} µm"


def dashboard(
    t=degrees, s=length, sign=",", comma=False, before=(), heading="Time,Wire temperature,Stroke,Fan"
):
    rows = [
        [f"2023-05-12 20:{k // 60:02}:{k % 60:02}", t(T[k]), s(S_MM[k]) if k % 37 else "", f"{40 + k % 2}%"]
        for k in range(N)
    ]
    rows = [[cell.replace(".", ",") for cell in row] if comma else row for row in rows]
    return "\n".join([*before, heading.replace(",", sign), *map(sign.join, rows)]) + "\n"


def imported(path):
    (table,) = find_tables(path)
    guess, mapping = guess_table(table), path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    report = import_file(path, format="csv", out=path.with_suffix(".run.sqlite"), mapping=str(mapping))
    return table, guess, load_run(report.run), [finding.text for finding in report.findings]


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("before", [(), ("Panel: SMA", "Load;120 N")])
@pytest.mark.parametrize(("sign", "comma"), [(",", False), (";", False), (";", True), ("\t", True)])
def test_mixed_lengths_become_one_column(write, sign, comma, before):
    table, guess, run, findings = imported(write(dashboard(sign=sign, comma=comma, before=before)))
    most = "µm" if (S_MM < 1).sum() > N / 2 else "mm"
    assert table.names == ("Time", "Wire temperature [°C]", f"Stroke [{most}]", "Fan [%]")
    assert (guess.first("input").unit, guess.first("output").name) == ("degC", f"Stroke [{most}]")
    np.testing.assert_allclose(run["temperature_degC"], T)
    there = np.arange(N) % 37 != 0
    in_mm = run["position"] * (1e-3 if run.unit == "um" else 1)
    np.testing.assert_allclose(in_mm[there], S_MM[there], atol=0.0051)
    assert np.isnan(in_mm[~there]).all()
    assert f"{(S_MM[there] >= 1).sum()} cells in mm are converted" in " ".join(findings) or most == "mm"


def test_one_unit_is_not_converted(write):
    text = dashboard(s=lambda s: f"{s:.3f} mm", heading="Time,Wire temperature (°C),Stroke,Fan")
    table, _, run, findings = imported(write(text))
    assert table.names == ("Time", "Wire temperature [°C]", "Stroke [mm]", "Fan [%]")
    assert np.nanmax(np.abs(run["position"] - S_MM)) < 1e-12
    assert not any("converted" in text for text in findings)


def test_temperatures_of_two_scales(write):
    _, _, run, _ = imported(write(dashboard(t=lambda t: f"{t + 273.15:.2f} K" if t > 60 else f"{t:.2f} °C")))
    celsius = run["temperature_degC"]
    np.testing.assert_allclose(celsius, T, atol=1e-9)


@pytest.mark.parametrize(
    ("cell", "why"),
    [("12 N", "cannot be converted"), ("12 xyz", "cannot be converted"), ("4.75", "has no unit")],
)
def test_what_cannot_be_converted_is_refused(write, tmp_path, capsys, cell, why):
    text = dashboard(s=lambda s: cell if s > 4.5 else length(s))
    assert cli(["study", str(write(text)), "-o", str(tmp_path / "out")]) == 4
    printed = capsys.readouterr().err
    line = 2 + int(np.flatnonzero((S_MM > 4.5) & (np.arange(N) % 37 != 0))[0])
    assert f"line {line}, column 'Stroke': '{cell}' {why}" in printed


def test_a_unit_that_is_not_known_is_kept_as_it_is_written(write):
    text = dashboard(t=degrees).replace("40%", "40 widgets").replace("41%", "41 widgets")
    assert find_tables(write(text))[0].names[-1] == "Fan [widgets]"


@pytest.mark.parametrize("remark", ["door open", "10A", "5 min"])
def test_remarks_beside_plain_numbers_are_left_alone(write, remark):
    rows = [f"{k},{T[k]},{S_MM[k]},{remark if k == 7 else ''}" for k in range(N)]
    (table,) = find_tables(write("\n".join(["t [s],T [°C],s [mm],Remark", *rows]) + "\n"))
    assert table.names == ("t [s]", "T [°C]", "s [mm]", "Remark")


@pytest.mark.parametrize(
    ("cells", "sign", "expected"),
    [
        (("1,234.5 µm", "2 mm", "3,100 µm"), ";", (1234.5, 2000, 3100)),
        (("1.234,5 µm", "2 mm", "3.100 µm"), ";", (1234.5, 2000, 3100)),
        (("12,5 µm", "2,5 mm", "3e2 µm"), ";", (12.5, 2500, 300)),
        (("12.5 µm", "1,002.5 mm", "13 µm"), ";", (12.5, 1002500, 13)),
        (("12,5 µm", "1.002,5 mm", "13 µm"), ";", (12.5, 1002500, 13)),
        (('"1,234.5 µm"', "+2.5 mm", "-.5 µm"), ",", (1234.5, 2500, -0.5)),
    ],
)
def test_thousands_and_decimal_signs_of_converted_cells(write, cells, sign, expected):
    rows = [f"{k}{sign}{cell}" for k, cell in enumerate(cells)]
    (table,) = find_tables(write("\n".join([f"n{sign}s", *rows]) + "\n"))
    assert table.names == ("n", "s [µm]")
    np.testing.assert_allclose(table.columns[1].values, expected)


@pytest.mark.parametrize("cell", ["1.2.3 mm", "1,2,3 mm", "1e999 mm", "12 mm mm", "-- mm"])
def test_a_cell_that_is_no_quantity_is_no_reading(write, cell):
    text = dashboard().splitlines()
    text[6] = f'2023-05-12 20:00:05,30 °C,"{cell}",40%'
    values = find_tables(write("\n".join(text) + "\n"))[0].columns[2].values
    assert np.isnan(values[5])
    assert np.isfinite(values[1:5]).all()
