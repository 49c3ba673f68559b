"""Files of one channel each with equal clocks are one record, and the study says so; other files are runs."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.study import study
from smarig.study.joined_channels import joined_channels
from smarig.study.study_options import StudyOptions

T = np.arange(600) * 0.002
H = 3 * np.interp(T * 2.5 % 1, [0, 0.25, 0.75, 1], [0, 1, -1, 0])
P = np.tanh(np.roll(H, 12) / 0.8)


def file_of(folder, name, t, column, y):
    path = folder / name
    path.write_text("\n".join([f"t [s],{column}", *(f"{a:.5f},{b:.5f}" for a, b in zip(t, y))]) + "\n")
    return path


def test_channels_of_one_clock_are_one_record(tmp_path):
    paths = [
        file_of(tmp_path, f"x_{k}.csv", T, f"{name} [V]", y)
        for k, (name, y) in enumerate([("A", H), ("B", P)])
    ]
    result = study(paths, tmp_path / "out", StudyOptions(diagnose=False))
    (table,) = result.tables
    np.testing.assert_allclose(table.run["input"], H, atol=1e-5)
    np.testing.assert_allclose(table.run["position"], P, atol=1e-5)
    assert any("x_0.csv, x_1.csv have equal clocks" in hint for hint in result.hints())


@pytest.mark.parametrize("change", ["clock", "name", "more"])
def test_another_clock_the_same_channel_or_a_whole_record_is_another_run(tmp_path, change):
    t, name = (T + 0.5, "B [V]") if change == "clock" else (T, "A [V]" if change == "name" else "B [V]")
    paths = [file_of(tmp_path, "x_0.csv", T, "A [V]", H), file_of(tmp_path, "x_1.csv", t, name, P)]
    if change == "more":
        lines = [f"{line},{k % 9}" for k, line in enumerate(paths[1].read_text().splitlines())]
        paths[1].write_text("\n".join(["t [s],B [V],C [V]", *lines[1:]]) + "\n")
    tables = [find_tables(path)[0] for path in paths]
    found = joined_channels(tables, tmp_path / "out")
    assert not found.sentence
    assert found.tables == tables
    assert not (tmp_path / "out").exists()
