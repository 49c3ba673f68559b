"""Files as instruments and their programs write them: names, units and readings are found, and a mapping reads them."""

import numpy as np
import pytest
from scipy.io import savemat

from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

U = 50 - 40 * np.cos(np.linspace(0, 4 * np.pi, 200))
X = np.tanh((np.roll(U, 6) - 50) / 9)
T = np.arange(U.size) * 0.5


def _imported(path):
    """The first and the last guess on a file: its largest table, and the run that its draft imports."""
    guess, report = _reported(path)
    return guess, load_run(report.run)


def _reported(path):
    """The same, with the report of the import in place of the run."""
    table = max(find_tables(path), key=len)
    guess = guess_table(table)
    mapping = path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    out = path.with_suffix(".run.sqlite")
    return guess, import_file(path, format=table.format, out=out, mapping=str(mapping))


def test_labview_states_units_before_the_table(tmp_path):
    head = [
        "LabVIEW Measurement\t",
        "Separator\tTab",
        "***End_of_Header***\t",
        "\t",
        "Channels\t2\t\t",
        "Samples\t200\t200\t",
        "Y_Unit_Label\tDeg C\tmm\t",
        "X_Dimension\tTime\tTime\t",
        "***End_of_Header***\t\t\t",
        "X_Value\tThermocouple\tLVDT\tComment",
    ]
    path = tmp_path / "wire.lvm"
    rows = [f"{a:.6f}\t{b:.6f}\t{c:.6f}\t" for a, b, c in zip(T, U, X)]
    path.write_text("\r\n".join([*head, *rows]) + "\r\n", newline="")
    guess, run = _imported(path)
    roles = {role: (c.name, c.unit) for role in ("input", "output") for c in guess.of_role(role)}
    assert roles == {"input": ("Thermocouple", "degC"), "output": ("LVDT", "mm")}
    np.testing.assert_allclose(run["position"], X, atol=1e-6)
    np.testing.assert_allclose(run["t_s"], T)


def test_an_oscilloscope_states_units_in_its_preamble(tmp_path):
    path = tmp_path / "T0007ALL.CSV"
    lines = ["Model,DPO2024B", "Horizontal Units,S,", "Sample Interval,0.5,", "Vertical Units,V,V", "Label,,"]
    head = "\r\n".join([*lines, "TIME,CH1,CH2", ""])
    path.write_text(
        head + "".join(f"{a:.6e},{b:.5f},{c:.5f}\r\n" for a, b, c in zip(T, U / 50 - 1, X)), newline=""
    )
    guess, _ = _imported(path)
    assert (guess.first("input").name, guess.first("input").unit) == ("CH1", "V")
    assert (guess.first("output").name, guess.first("output").unit) == ("CH2", "V")


def test_segments_of_a_magnetometer_with_a_header_that_blanks_align(tmp_path):
    field = 0.3 * np.cos(np.linspace(0, 2 * np.pi, 80))
    rows = [f"{h:+.6E},{m:+.6E}" for h, m in zip(field, 1e-6 * np.tanh(np.roll(field, 3) * 9))]
    text = "MicroMag 2900/3900 Data File (Series 0016.002)\nDirect moment vs. field; Multiple segments\n\nSETTINGS\n"
    text += "Averaging time    +100.0E-03\n\n    Field         Moment   \n     (T)          (Am²)    \n"
    text += "\n".join(rows[:40]) + "\n\n" + "\n".join(rows[40:]) + "\n\nMicroMag 2900/3900 Data File ends\n"
    path = tmp_path / "loop.txt"
    path.write_text(text, encoding="latin-1")
    guess, run = _imported(path)
    assert [(c.name, c.unit) for c in guess.columns] == [("Field", "T"), ("Moment", "A m^2")]
    assert len(run) == 80, "both segments, without the closing line"


@pytest.mark.parametrize("extra", [{}, {"comment": "wire A", "more": {"fs": 2.0}}])
def test_structs_in_a_matlab_file(tmp_path, extra):
    path = tmp_path / "daq.mat"
    inner = {"temperature_C": U[:, None], "displacement_mm": X[:, None]}
    savemat(path, {"data": {"time": T[:, None], "ch": inner, "n": 3.0}, **extra})
    guess, run = _imported(path)
    assert guess.first("input").name == "data/ch/temperature_C"
    assert guess.first("output").name == "data/ch/displacement_mm"
    np.testing.assert_allclose(run["position"], X)


def test_one_sweep_without_names_has_no_output_and_says_so(tmp_path):
    from smarig.core import UsageError
    from smarig.study import StudyOptions, study

    path = tmp_path / "curie.dat"
    path.write_text(
        "".join(f"{a:.1f} {4 - 4 / (1 + np.exp((600 - a) / 20)):.5f}\n" for a in np.arange(140, 700, 2.0))
    )
    with pytest.raises(UsageError, match="no column looks like an output"):
        study([path], tmp_path / "out", StudyOptions(accept=True))


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("end", ["\r", "\n", "\r\n"])
@pytest.mark.parametrize(("name", "unit"), [("signal", "mOhm"), ("'R (wire)'", "mohm"), ("w2", "mm")])
def test_igor_text_states_units_in_its_commands(tmp_path, end, name, unit):
    rows = [f"\t{a:.3f}\t{b:.4f}\t{c:.5f}" for a, b, c in zip(T, U + 273.15, X)]
    commands = [
        'X SetScale/P x 0,1,"", clock; SetScale d 0,0,"s", clock',
        f'X SetScale/P x 0,1,"", stage, {name}; SetScale d 0,0,"K", stage',
        f'X SetScale d 0,0,"{unit}", {name}',
        'X Note stage, "thermometer on the stage; SetScale d of none"',
    ]
    lines = ["IGOR", f"WAVES/D\tclock\tstage\t{name}", "BEGIN", *rows, "END", *commands]
    path = tmp_path / "waves.itx"
    path.write_bytes(end.join([*lines, ""]).encode())
    guess, report = _reported(path)
    run = load_run(report.run)
    assert guess.table.names == ("clock", "stage", name.strip("'"))
    assert [c.unit for c in guess.columns] == ["s", "K", unit.replace("Ohm", "ohm")]
    assert len(run) == U.size
    np.testing.assert_allclose(run["position"], X, atol=1e-5)
    np.testing.assert_allclose(run["temperature_degC"], U, atol=1e-4)
    assert not any("incomplete" in warning for warning in report.warnings)


@pytest.mark.parametrize("end", ["\r", "\n", "\r\n"])
def test_a_whole_last_line_is_not_incomplete_whatever_ends_it(tmp_path, end):
    rows = [f"{a:.3f},{b:.4f},{c:.5f}" for a, b, c in zip(T, U, X)]
    path = tmp_path / "data.csv"
    path.write_bytes(end.join(["time (s),T (degC),x (mm)", *rows, "1,,", ""]).encode())
    _, report = _reported(path)
    assert not any("incomplete" in warning for warning in report.warnings)
