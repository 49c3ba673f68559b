"""Tables in long format: a column for each variable on the clock of the readings, or a refusal with the cause."""

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.exchange import find_tables, import_file
from smarig.exchange.layouts.joined_clocks import joined_clocks
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft

N = 160
T = np.round(61 - 37 * np.cos(np.linspace(0, 4 * np.pi, N)), 2)
S = np.round(0.5 + 1.7 * (1 + np.tanh((T - np.where(np.gradient(T) > 0, 64, 44)) / 5)), 3)


def stamp(t):
    t += 10
    return f"2023-05-12T14:{int(t) // 60:02}:{int(t) % 60:02}.{round(t % 1 * 1000):03}Z"


def readings(every=(1, 1), shift=0.3, period=2.0):
    """(time, name, value) of temperature and stroke, of which each ``every``-th reading is there."""
    found = [(period * k, "wire_temp_C", T[k]) for k in range(0, N, every[0])]
    return found + [(period * k + shift, "stroke_mm", S[k]) for k in range(0, N, every[1])]


def historian(rows, heading="Tag;Timestamp;Value;Quality", end=(), comma=True, quality=lambda k: "Good"):
    out = [";".join((name, stamp(t), f"{v:.3f}", quality(k))) for k, (t, name, v) in enumerate(rows)]
    return "\n".join([heading, *([line.replace(".", ",") for line in out] if comma else out), *end]) + "\n"


def influx(rows):
    """A block with annotations for each series, whose names are measurements and tags."""
    out = []
    for number, name in enumerate(("wire_temp_C", "stroke_mm")):
        out += [
            "#group,false,false,false,false,true,true",
            "#datatype,string,long,dateTime:RFC3339,double,string,string",
        ]
        out += ["#default,_result,,,,,", ",result,table,_time,_value,_field,_measurement"]
        out += [f",,{number},{stamp(t)},{v},value,{n}" for t, n, v in rows if n == name] + [""]
    return "\n".join(out) + "\n"


def imported(path):
    (table,) = find_tables(path)
    guess, mapping = guess_table(table), path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    report = import_file(path, format="csv", out=path.with_suffix(".run.sqlite"), mapping=str(mapping))
    return table, guess, load_run(report.run), [finding.text for finding in report.findings]


def check(path, every=(1, 1)):
    table, guess, run, findings = imported(path)
    assert (guess.first("input").name, guess.first("output").name) == ("wire_temp_C", "stroke_mm")
    assert len(table.columns) == 3
    both = np.isfinite(run["temperature_degC"]) & np.isfinite(run["position"])
    step = max(every)
    np.testing.assert_allclose(run["temperature_degC"][both], T[::step])
    np.testing.assert_allclose(run["position"][both], S[::step])
    np.testing.assert_allclose(np.diff(run["t_s"][both]), 2.0 * step)
    return findings


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("blocks", [True, False])
@pytest.mark.parametrize(("every", "shift"), [((1, 1), 0.0), ((1, 1), 0.3), ((1, 4), 0.3), ((5, 1), -0.2)])
def test_variables_of_any_rates_are_joined_on_time(write, blocks, every, shift):
    rows = readings(every, shift) if blocks else sorted(readings(every, shift))
    findings = check(write(historian(rows, comma=False)), every)
    (sentence,) = [text for text in findings if "2 variables, which 'Tag' names" in text]
    assert f"wire_temp_C ({len(range(0, N, every[0]))})" in sentence
    assert ("the same times" if every == (1, 1) and not shift else "nothing is interpolated") in sentence


@pytest.mark.parametrize("text", [influx(readings()), influx(readings(shift=0.0))])
def test_blocks_of_influx(write, text):
    check(write(text))


def test_lines_of_json_with_a_name_and_a_value(write):
    rows = [f'{{"metric": "{n}", "time": {t:.3f}, "value": {v}}}' for t, n, v in sorted(readings())]
    check(write("\n".join(rows) + "\n"))


def test_by_turns_without_a_time(write):
    rows = [f"{name},{v}" for _, name, v in sorted(readings())]
    (table,) = find_tables(write("\n".join(["sensor,value", *rows]) + "\n"))
    assert table.names == ("wire_temp_C", "stroke_mm")
    np.testing.assert_allclose([c.values for c in table.columns], [T, S])


def test_stamps_coarser_than_the_readings_are_joined_by_turns(write):
    rows = [(np.floor(t / 4), n, v) for t, n, v in sorted(readings())]
    _, _, run, findings = imported(write(historian(rows)))
    assert any("A row is a scan" in text for text in findings)
    assert run["position"].size == np.unique([t for t, _, _ in rows]).size


def test_rows_of_the_log_itself_are_left_out_and_counted(write):
    rows = sorted(readings())
    text = historian(rows, end=("$RT_OFF$;2023-05-12T14:30:00Z;0;2", f"$RT_COUNT$;{len(rows)};;"))
    findings = check(write(text))
    assert "Rows that are no readings of them are left out: 2 ('$RT_OFF$', '$RT_COUNT$')." in findings


def test_readings_that_are_not_valid_are_masked(write):
    bad = {10, 12, 100}
    text = historian(sorted(readings()), quality=lambda k: "Bad" if k in bad else "Good")
    _, _, run, findings = imported(write(text))
    assert np.flatnonzero(np.isnan(run["temperature_degC"])).tolist() == [k // 2 for k in sorted(bad)]
    assert "Readings that 'Quality' marks as not valid are masked: 3." in findings


@pytest.mark.parametrize("units", ["mm", "mixed"])
def test_a_column_of_units(write, units):
    def row(k, t, n, v):
        small = units == "mixed" and n == "stroke_mm" and v < 1
        unit = "degC" if n != "stroke_mm" else "um" if small else "mm"
        return f"{n};{stamp(t)};{1000 * v if small else v:.3f};{unit}"

    rows = [row(k, *r) for k, r in enumerate(sorted(readings()))]
    _, guess, run, _ = imported(write("\n".join(["Point name;Time;Value;Unit", *rows]) + "\n"))
    assert guess.first("output").name.startswith("stroke_mm [")
    np.testing.assert_allclose(run["position"] * (1e-3 if run.unit == "um" else 1), S, atol=1e-9)


def test_what_nothing_joins_is_refused(write, tmp_path, capsys):
    rows = [f"{name};{v}" for _, name, v in readings()]
    assert (
        cli(["study", str(write("\n".join(["Signal;Wert", *rows]) + "\n")), "-o", str(tmp_path / "out")]) == 4
    )
    printed = capsys.readouterr().err
    assert "is in long format" in printed
    assert f"'Signal' names: wire_temp_C ({N}), stroke_mm ({N})" in printed


@pytest.mark.parametrize("names", ["Channel;t [s];Value;T [°C]", "Loop;t [s];Value;T [°C]"])
def test_a_value_beside_another_signal_is_left_alone(write, names):
    rows = [f"{'AB'[k % 80 > 40]};{k};{S[k]};{T[k]}" for k in range(N)]
    (table,) = find_tables(write("\n".join([names, *rows]) + "\n"))
    assert table.names == tuple(names.split(";"))


def test_a_list_of_parameters_before_a_table_is_left_alone(write):
    rows = [f"{k};{T[k]};{S[k]}" for k in range(N)]
    text = (
        "\n".join(["Parameter;Value", "Load;12", "Length;80", "Wire;7", "", "t [s];T [°C];s [mm]", *rows])
        + "\n"
    )
    assert find_tables(write(text))[-1].names == ("t [s]", "T [°C]", "s [mm]")


def test_slow_channels_meet_in_the_rows_of_a_fast_one():
    fast, slow, slower = np.arange(0, 20, 0.1), np.arange(0.0, 20.0), np.arange(0.3, 20.0)
    found = joined_clocks([slow, fast, slower])
    assert (found.base, found.left_out) == (1, 0)
    assert (found.rows[0] == found.rows[2]).all()
    assert found.shift == pytest.approx(0.3)


def test_a_reading_within_a_pause_has_no_row():
    steady = np.arange(60.0)
    with_pause = steady[(steady < 20) | (steady > 40)]
    found = joined_clocks([with_pause, np.array([1.2, 18.4, 30.0, 42.0])])
    assert found.rows[1].tolist() == [1, 18, -1, 21]
    assert found.left_out == 1


def test_a_row_has_one_reading_of_a_channel_the_nearest():
    found = joined_clocks([np.arange(5.0), np.array([0.4, 1.9, 2.2, 3.1])])
    assert found.rows[1].tolist() == [0, 2, -1, 3]
