"""Names and units that numbered lines before a table list are those of its columns."""

import numpy as np
import pytest

from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

U = np.round(60 - 35 * np.cos(np.linspace(0, 4 * np.pi, 160)), 2)
X = np.round(3 + 2 * np.tanh((U - np.where(np.gradient(U) > 0, 66, 54)) / 6), 3)
T = np.round(0.05 * np.arange(U.size), 4)
NAMES = ("Time (min)", "Temperature (°C)", "Strain (%)", "Frequency (Hz)")


def written(
    path, lines, names=NAMES, before=("Version\t4.5A", "Size\t35.0\t12.65\t3.12\tmm", "Date\t12-Nov-2019")
):
    columns = (T, U, X, np.ones(U.size))[: len(names)]
    rows = ["\t".join(f"{x:g}" for x in row) for row in zip(*columns)]
    path.write_text("\n".join([*before, *lines, "StartOfData", *rows]) + "\n", encoding="utf-16")
    return path


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("line", ["Sig{k}\t{name}", "Column {k}: {name}", "# {k} = {name}", "CH{k} {name}"])
@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize("number", [3, 4])
def test_listed_names_are_those_of_the_columns(tmp_path, line, first, number):
    names = NAMES[:number]
    lines = [line.format(k=k, name=name) for k, name in enumerate(names, first)]
    path = written(tmp_path / "a.txt", [f"Nsig\t{number}", *lines], names)
    (table,) = find_tables(path)
    assert table.names == names
    guess, mapping = guess_table(table), tmp_path / "a.toml"
    roles = {role: (c.name, c.unit) for role in ("time", "input", "output") for c in guess.of_role(role)}
    assert roles == {
        "time": ("Time (min)", "min"),
        "input": ("Temperature (°C)", "degC"),
        "output": ("Strain (%)", "%"),
    }
    mapping.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    run = load_run(import_file(path, format="csv", out=tmp_path / "a.run.sqlite", mapping=str(mapping)).run)
    np.testing.assert_allclose(run["t_s"], 60 * T)
    np.testing.assert_allclose(run["position"], X)


@pytest.mark.parametrize(
    "lines",
    [
        ["Sig1\tTime (min)", "Sig2\tTemperature (°C)"],  # fewer than the columns
        ["Sig1\tTime", "Sig3\tTemperature", "Sig2\tStrain", "Sig4\tForce"],  # in another order
        ["Seg1\t20 min", "Seg2\tHeat", "Sig3\tHold", "Sig4\tCool"],  # two lists
        ["Sig1\t0.5", "Sig2\t0.6", "Sig3\t0.7", "Sig4\t0.8"],  # values
    ],
)
def test_other_lines_are_no_names(tmp_path, lines):
    (table,) = find_tables(written(tmp_path / "a.txt", lines))
    assert table.names == tuple(f"column {k}" for k in range(1, 5))


STEPS = [
    "Equilibrate at 20.00 °C",
    "Ramp 5.00 °C/min to 120.00 °C",
    "Mark end of cycle 1",
    "Repeat segment 2",
]


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("step", ["OrgMethod\t{k}: {text}", "{k}: {text}", "{k}) {text}"])
@pytest.mark.parametrize("delimiter", ["\t", "  "])
def test_steps_of_a_method_are_no_names(tmp_path, step, delimiter):
    signals = [f"Sig{k}\t{name}" for k, name in enumerate(NAMES, 1)]
    path = written(
        tmp_path / "a.txt", [*signals, *(step.format(k=k, text=text) for k, text in enumerate(STEPS, 1))]
    )
    path.write_text(path.read_text("utf-16").replace("StartOfData\n", "").replace("\t", delimiter), "utf-16")
    (table,) = find_tables(path)
    assert table.names == NAMES


@pytest.mark.parametrize(
    "remark", ["# REM by hand, with the lid open", "# REM two", "see the notes for more"]
)
def test_a_remark_below_the_list_is_no_header(tmp_path, remark):
    names = ("Setting of stage B", "Reading of stage B", "Drive 3")
    head = [*(f"# NAME{k} = {name}" for k, name in enumerate(names)), "#", remark, "# END_HEADER"]
    rows = [f"{t:g} {u:g} {x:g}" for t, u, x in zip(T, U, X)]
    path = tmp_path / "a.dat"
    path.write_text("\n".join(["# DIM = 3", *head, *rows]) + "\n")
    (table,) = find_tables(path)
    assert table.names == names
    np.testing.assert_allclose(table.columns[1].values, U)
