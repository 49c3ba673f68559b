"""Each question comes with commands that answer it as they are printed: with the files, options and folder given."""

import shlex

import numpy as np
import pytest

from smarig.cli import run
from smarig.core import DataError, UsageError
from smarig.study import study
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import UnsureError, understand

K = np.arange(300)
U = 70 - 50 * np.cos(K / 25)
Y = np.tanh((np.roll(U, 3) - 70) / 9)


def file_of(tmp_path, columns, name="wire.csv"):
    path = tmp_path / name
    rows = (",".join(f"{x:.5g}" for x in row) for row in zip(*columns.values()))
    path.write_text("\n".join([",".join(columns), *rows]) + "\n", encoding="utf-8")
    return path


def commands_in(error):
    text = str(error)
    assert ": smarig study " in text, text
    return [f"smarig study {part}".rstrip(".") for part in text.split("smarig study ")[1:]]


def test_a_flag_is_no_answer_and_the_ramped_column_comes_first(tmp_path):
    """A voltage that goes in a triangle, the current that follows it, a switch, and the signal of a sensor."""
    ramp = np.interp(K, [0, 75, 150, 225, 299], [-1, 1, -1, 1, -1])
    out = np.tanh((np.roll(ramp, 6) - 0.1) / 0.3)
    switch = (np.gradient(ramp) > 0).astype(float)
    columns = {
        "t (s)": K,
        "on/off": switch,
        "I (mA)": np.gradient(out) + 0.1 * ramp,
        "set (V)": ramp,
        "AI 2 (V)": out,
    }
    with pytest.raises(UnsureError) as error:
        understand([file_of(tmp_path, columns)], StudyOptions())
    commands = [shlex.split(command.split("; ")[0]) for command in commands_in(error.value)]
    first = dict(zip(commands[0], commands[0][1:]))
    assert (first["--input"], first["--output"]) == ("set (V)", "AI 2 (V)")
    assert not any("on/off" in word for command in commands for word in command)


TABLES = {
    "a unit": {"t (s)": K, "T (degC)": U, "Foo bar": Y},
    "units of both": {"u [foo]": U, "y [bar]": Y},
    "no names": {"A1": U, "B1": Y, "C1": 0.5 * Y + 1e-4 * U**2},
    "two thermometers": {"t (s)": K, "T1 (degC)": U, "T2 (degC)": 25 + 0.5 * U, "x (mm)": Y},
    "noise": {"t (s)": K, "T (degC)": U, "Foo bar": K % 7},
    "many": {"t (s)": K, "T (degC)": U} | {f"S{k}": Y * (k + 1) + np.sin(K / 9) * k for k in range(9)},
}


MOST_ASKED = 16  # more than the others need: of many columns, the first answers and where they lead


@pytest.mark.parametrize("name", TABLES)
def test_each_command_answers_or_leads_to_one_that_does(tmp_path, name):
    path = file_of(tmp_path, TABLES[name])
    waiting, asked = [StudyOptions(split="time")], 0
    while waiting and asked < MOST_ASKED:
        options, asked = waiting.pop(), asked + 1
        try:
            understand([path], options, out=tmp_path / "my out")
        except UnsureError as error:
            for command in commands_in(error):
                words = shlex.split(command.split("; ")[0])
                assert words[2] == str(path)
                assert words[words.index("-o") + 1] == str(tmp_path / "my out")
                assert words[words.index("--split") + 1] == "time"
                given = options_of(words)
                assert given != options
                waiting.append(given)
    assert asked > 1
    assert not waiting or name == "many"


def options_of(words):
    values = dict(zip(words, words[1:]))
    units = [words[k + 1].rsplit("=", 1) for k, word in enumerate(words) if word == "--unit"]
    return StudyOptions(
        split="time", input=values.get("--input"), output=values.get("--output"), units=dict(units)
    )


def test_a_printed_command_works(tmp_path, capsys):
    path = file_of(tmp_path, {"t (s)": K, "T1 (degC)": U, "T2 (degC)": 25 + 0.5 * U, "x": Y})
    assert run(["study", str(path), "--no-diagnosis", "-o", str(tmp_path / "a b")]) == 2
    command = capsys.readouterr().err.split("answers it: ")[1].split("; ")[0]
    assert run(shlex.split(command)[1:]) == 0
    assert (tmp_path / "a b" / "index.html").is_file()


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize(
    ("columns", "others"), [({"T": U}, ["K", "degF"]), ({"Temp": U + 273}, ["degC", "degF"])]
)
def test_a_temperature_in_an_assumed_unit_is_told_with_commands_that_state_it(
    tmp_path, capsys, columns, others
):
    path = file_of(tmp_path, {"t (s)": K, **columns, "x (mm)": Y})
    (name,) = columns
    assert run(["study", str(path), "--no-diagnosis", "-o", str(tmp_path / "a b")]) == 0
    out, err = capsys.readouterr()
    assert f"{name}: input, {'K' if name == 'Temp' else 'degC'} assumed" in err
    (said,) = [line for line in out.splitlines() if "is assumed" in line]
    commands = [f"study {part.rstrip('.; ')}" for part in said.split("smarig study ")[1:]]
    assert [shlex.split(c)[3] for c in commands] == [f"{name}={unit}" for unit in others]
    assert run(shlex.split(commands[0])) == 0
    out, err = capsys.readouterr()
    assert f"{name}: input in {others[0]}" in err
    assert "assumed" not in out


@pytest.mark.parametrize("name", ["T (degC)", "T_C", "T / K"])
def test_a_stated_temperature_is_not_assumed(tmp_path, name):
    path = file_of(tmp_path, {"t (s)": K, name: U, "x (mm)": Y})
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    assert result.assumed == ""


def test_an_output_that_does_not_follow_is_refused_with_the_others(tmp_path):
    drift = 0.001 * K + np.cos(K / 4.3)  # moves, but not with the input
    path = file_of(tmp_path, {"t (s)": K, "T (degC)": U, "Stroke (mm)": drift, "R (ohm)": 2 + 0.1 * Y})
    with pytest.raises(DataError) as error:
        study([path], tmp_path / "out", StudyOptions(diagnose=False))
    (command,) = commands_in(error.value)
    assert shlex.split(command)[3:7] == ["--input", "T (degC)", "--output", "R (ohm)"]
    with pytest.raises(DataError) as stated:
        study([path], tmp_path / "out", StudyOptions(diagnose=False, output="Stroke (mm)"))
    assert "smarig study" not in str(stated.value)


@pytest.mark.parametrize("role", ["input", "output"])
@pytest.mark.parametrize(
    ("column", "why"), [("state", "some of its cells are texts"), ("gain", "the same in every row")]
)
def test_a_named_column_that_has_no_loop_is_refused_with_its_reason(tmp_path, role, column, why):
    rows = [f"{k},{u:.2f},{y:.4f},{'off' if k % 3 else 5},7" for k, (u, y) in enumerate(zip(U, Y))]
    path = tmp_path / "wire.csv"
    path.write_text("\n".join(["time_s,T_degC,x_mm,state,gain", *rows]) + "\n", encoding="utf-8")
    with pytest.raises(UsageError, match=f"column '{column}' cannot be the {role}: .*{why}"):
        understand([path], StudyOptions(**{role: column}))
