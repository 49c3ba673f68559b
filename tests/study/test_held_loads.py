"""One file at several loads, each held for whole cycles, is a run for each load."""

import numpy as np
import pytest

from smarig.core import DataError
from smarig.exchange import import_file
from smarig.record import load_run
from smarig.study import StudyOptions, study
from smarig.study.held_loads import tables_of_loads
from smarig.study.understanding import understand
from study.known_data import displacements, table_of, temperatures

CYCLE = np.concatenate([temperatures(2, 120), np.full(5, 25.0)])


def record(loads, *, ramp=0, noise=0.05):
    """Temperatures, displacements and forces, a cycle after the other, with rows on the way between the loads."""
    rng, u, x, f = np.random.default_rng(4), [], [], []
    for k, load in enumerate(loads):
        way = np.linspace(load, loads[k + 1], ramp + 2)[1:-1] if k + 1 < len(loads) else []
        u += [*CYCLE, *np.full(len(way), 25.0)]
        x += [*displacements(CYCLE + 0.2 * (60 - load), seed=k), *np.zeros(len(way))]
        f += [*np.full(CYCLE.size, load), *way]
    force = np.array(f) + rng.normal(0, noise, len(f))
    return np.array(u), np.array(x), force


def columns(u, x, force, unit="N"):
    t = np.arange(u.size) * 0.5
    return {"time [s]": t, f"Last [{unit}]": force, "Weg [mm]": x, "T_Draht [°C]": u, "Ofen [°C]": u + 1}


@pytest.mark.parametrize("ramp", [0, 2])
@pytest.mark.parametrize("loads", [(20.0, 40.0, 60.0), (60.0, 45.0), (20.0, 40.0, 20.0)])
def test_each_load_is_a_table(loads, ramp):
    found = tables_of_loads(table_of(**columns(*record(loads, ramp=ramp))))
    assert len(found) == len(loads)
    for k, (table, load) in enumerate(zip(found, loads)):
        assert len(table) == CYCLE.size
        first = k * (CYCLE.size + ramp) + 1
        assert table.layout["rows"] == {"first": first, "last": first + CYCLE.size - 1}
        assert np.mean(table.columns[1].values) == pytest.approx(load, abs=0.1)
        assert table.name == f"{load:g} N part {k + 1}"


def test_other_forces_are_one_record():
    u, x, force = record((20.0, 40.0))
    for other in (np.full(u.size, 30.0) + 0.1 * force, 20 + 0.2 * u, np.where(u > 70, 20.0, 40.0), 3 * x):
        table = table_of(**columns(u, x, other))
        assert tables_of_loads(table) == [table]


def test_the_loads_are_those_of_the_runs(tmp_path):
    path = tmp_path / "a.txt"
    data = columns(*record((20.0, 40.0, 60.0), ramp=2))
    rows = "\n".join("\t".join(f"{value:.4f}" for value in row) for row in zip(*data.values()))
    path.write_text("\t".join(data) + f"\n{rows}\n", encoding="utf-8")
    assert len(understand([path], StudyOptions()).guesses) == 3
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    means = [table.run.info.conditions["load"]["mean"] for table in result.tables]
    assert means == pytest.approx([20, 40, 60], abs=0.1)
    assert [len(table.run) for table in result.tables] == [CYCLE.size] * 3
    assert any("One model of all loads needs their stress" in reason for reason in result.reasons)


def test_more_rows_than_there_are_is_an_error(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("t,u,x\n" + "".join(f"{k},{k % 7},{k % 5}\n" for k in range(20)))
    text = """name = "a"\nsummary = "a"\nsource = "a"\n[file]\ndelimiter = "comma"\n[rows]\nfirst = 3\nlast = %d
[time]\ncolumn = "t"\n[columns]\ninput = { column = "u", unit = "V" }\nposition = { column = "x", unit = "mm" }
[input]\nchannel = "input"\nquantity = "voltage"\nunit = "V"\n[output]\nquantity = "displacement"\nunit = "mm"\n"""
    (tmp_path / "m.toml").write_text(text % 21)
    with pytest.raises(DataError, match="the table has 20 rows, but \\[rows\\] ends at row 21"):
        import_file(path, format="csv", out=tmp_path / "a.run.sqlite", mapping=str(tmp_path / "m.toml"))
    (tmp_path / "m.toml").write_text(text % 12)
    report = import_file(path, format="csv", out=tmp_path / "a.run.sqlite", mapping=str(tmp_path / "m.toml"))
    np.testing.assert_allclose(load_run(report.run)["t_s"], np.arange(2, 12))
    assert "Rows 3 to 12 of 20 are read, as the mapping says." in [f.text for f in report.findings]
