"""A column that was held in each run and differs between runs is a condition of the runs, whatever it measures."""

import numpy as np
import pytest

from smarig.study import next_step, study
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand

PHASE = np.linspace(0, 2 * np.pi, 200)
NOISE = np.random.default_rng(7)


def file_of(folder, name, columns):
    path = folder / name
    lines = ["\t".join(columns), *("\t".join(f"{x:.5f}" for x in row) for row in zip(*columns.values()))]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def runs(folder, name, levels, *, drive="H (Oe)", out="M (emu)", width=lambda level: 900 - 2 * level):
    """A loop at each level of a column that holds it within noise."""
    found = []
    for k, level in enumerate(levels):
        u = 4000 * np.cos(PHASE)
        y = np.tanh((u + np.sign(np.sin(PHASE)) * width(level)) / 700)
        held = level + NOISE.normal(0, 0.05, u.size)
        columns = {"t (s)": PHASE * 100, drive: u, out: y, name: held, "n": np.arange(u.size)}
        found.append(file_of(folder, f"part_{'abc'[k]}.txt", columns))
    return found


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize(
    ("name", "key"),
    [
        ("Temp (K)", "temperature"),
        ("T_stage [°C]", "temperature"),
        ("F [N]", "load"),
        ("tilt (deg)", "angle"),
        ("pressure (kPa)", "pressure"),
    ],
)
def test_what_was_held_differs_between_runs(tmp_path, name, key):
    guesses = understand(runs(tmp_path, name, (40.0, 90.0, 150.0)), StudyOptions()).guesses
    assert [guess.roles[name].role for guess in guesses] == ["condition"] * 3
    result = study([g.table.path for g in guesses], tmp_path / "out", StudyOptions(diagnose=False))
    means = [table.run.info.conditions[key]["mean"] for table in result.tables]
    assert means == pytest.approx([40, 90, 150], abs=0.1)
    fields = [loops.to_json() for loops in result.field_loops]
    assert [f["conditions"][key]["value"] for f in fields] == pytest.approx(means)
    assert [f["coercive"]["value"] for f in fields] == pytest.approx([820, 720, 600], abs=20)
    assert any(f"The {key} differs: " in reason for reason in result.reasons)
    assert "another day" not in next_step(result)


@pytest.mark.parametrize("levels", [(90.0, 90.01), (90.0, 90.3)])
def test_what_scatters_as_much_within_a_run_is_none(tmp_path, levels):
    name = "tilt (deg)"
    guesses = understand(runs(tmp_path, name, levels), StudyOptions()).guesses
    assert [guess.roles[name].role for guess in guesses] == ["ignored"] * 2


def test_a_loop_at_each_temperature_of_one_file_is_a_run(tmp_path):
    u = np.tile(4000 * np.cos(PHASE), 3)
    held = np.repeat([90.0, 180.0, 270.0], PHASE.size) + NOISE.normal(0, 0.05, u.size)
    y = np.tanh((u + np.tile(np.sign(np.sin(PHASE)), 3) * (900 - 2 * held)) / 700)
    columns = {"t (s)": np.arange(u.size), "Temperature (K)": held, "H (Oe)": u, "M (emu)": y}
    found = understand([file_of(tmp_path, "all.txt", columns)], StudyOptions()).guesses
    assert [len(guess.table) for guess in found] == [PHASE.size] * 3
    assert all(guess.roles["Temperature (K)"].role == "condition" for guess in found)


def test_a_column_in_another_unit_than_its_condition_is_none(tmp_path):
    """Numbers that the names of the files call a frequency, and a force in counts of a converter."""
    paths = []
    for k, hertz in enumerate((2, 5)):
        u = 4000 * np.cos(PHASE)
        columns = {
            "t (s)": PHASE * 100,
            "H (Oe)": u,
            "M (emu)": np.tanh(u / (900 + k)),
            "A7": np.full(u.size, hertz),
        }
        path = file_of(
            tmp_path, f"run_{hertz}Hz.txt", columns | {"load cell": np.full(u.size, 700 + 300 * k)}
        )
        paths.append(path)
    result = study(paths, tmp_path / "out", StudyOptions(diagnose=False))
    assert [table.run.info.conditions["frequency"]["mean"] for table in result.tables] == [2, 5]
    assert all("load" not in table.run.info.conditions for table in result.tables)


def test_a_column_of_the_quantity_of_the_output_is_a_result(tmp_path):
    paths = runs(tmp_path, "M rem (emu)", (2.0, 9.0), width=lambda level: 700 + level)
    guesses = understand(paths, StudyOptions()).guesses
    assert [guess.first("output").name for guess in guesses] == ["M (emu)"] * 2
    assert all(guess.roles["M rem (emu)"].role == "ignored" for guess in guesses)
