"""Stamps that an apostrophe protects from a spreadsheet, and C as the unit of a temperature."""

import numpy as np
import pytest

from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

ROWS = 240
U = np.round(60 - 35 * np.cos(np.linspace(0, 4 * np.pi, ROWS)), 2)
R = np.round(100 + 0.39 * U, 3)


def stamp(t, day, order):
    days, rest = divmod(int(t), 86400)
    date = {"y": f"21-04-{day + days:02d}", "d": f"{day + days:02d}-04-21"}[order]
    return f"'{date} {rest // 3600:02d}:{rest // 60 % 60:02d}:{rest % 60:02d}.{round(t % 1 * 1000):03d}"


def log(path, start_s, order="y", names=("U1-1[C]", "U1-2[ohm]"), first=U, day=7):
    head = ['"File name","A.CSV"', '"Mode","Temperature","Resistance"', ""]
    head.append(",".join(f'"{name}"' for name in ("Time", *names)))
    rows = [
        f'"{stamp(start_s + 0.5 * k, day, order)}",{u:.5E},{r:.5E}' for k, (u, r) in enumerate(zip(first, R))
    ]
    path.write_text("\r\n".join([*head, *rows]) + "\r\n", newline="")
    return path


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("order", ["y", "d"])
@pytest.mark.parametrize("start_s", [36753, 86340.5, 86399])
@pytest.mark.parametrize("day", [7, 21])
def test_stamps_with_an_apostrophe_are_a_clock(tmp_path, start_s, order, day):
    """Past midnight too, whichever of year and day comes first."""
    path = log(tmp_path / "a.csv", start_s, order, day=day)
    (table,) = find_tables(path)
    guess, mapping = guess_table(table), path.with_suffix(".toml")
    assert guess.first("time").name == "Time"
    mapping.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    run = load_run(import_file(path, format="csv", out=tmp_path / "a.run.sqlite", mapping=str(mapping)).run)
    np.testing.assert_allclose(run["t_s"], 0.5 * np.arange(ROWS), atol=1e-6)
    np.testing.assert_allclose(run["temperature_degC"], U, atol=1e-3)


@pytest.mark.parametrize("name", ["U1-1[C]", "CH101 (C)", "probe 3 [C]"])
def test_numbers_like_temperatures_in_C_are_degrees(tmp_path, name):
    guess = guess_table(*find_tables(log(tmp_path / "a.csv", 0, names=(name, "x [ohm]"))))
    drive = guess.first("input")
    assert (drive.name, drive.quantity, drive.unit) == (name, "temperature", "degC")
    assert guess.doubts == []


@pytest.mark.parametrize(
    ("name", "values"), [("charge [C]", U), ("Q (C)", U), ("CH1 [C]", np.round(np.sin(U / 9), 3))]
)
def test_a_charge_stays_a_charge(tmp_path, name, values):
    guess = guess_table(*find_tables(log(tmp_path / "a.csv", 0, names=(name, "x [ohm]"), first=values)))
    assert {c.name: c.unit for c in guess.columns}[name] == "C"
