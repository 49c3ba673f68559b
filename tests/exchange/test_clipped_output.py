"""A sensor whose range ends within the travel: told, and no temperature is stated that lies beyond it."""

import numpy as np
import pytest

from smarig.exchange import import_file
from smarig.exchange.checks.clipped_output import clipped_output
from smarig.record import load_run
from smarig.study import StudyOptions, study
from smarig.transformation import transformation_temperatures

ROWS = 1500
U = 330 + 45 * np.cos(np.arange(ROWS) * 6 * np.pi / ROWS + np.pi)
WARMING = np.gradient(U) > 0
X = 800 / (1 + np.exp((U - np.where(WARMING, 342, 318)) / 3.0))  # um
NOISE = np.random.default_rng(21).normal(0, 1, ROWS)


def steps(x, step):
    return step * np.round(x / step)


@pytest.mark.parametrize(
    ("y", "end"),
    [
        (np.minimum(steps(X + 2 * NOISE, 0.5), 610), 610),
        (np.maximum(X + 2 * NOISE, 130), 130),
        (np.minimum(steps(X + 2 * NOISE, 2), 700), 700),  # noise of one step
    ],
)
def test_equal_readings_at_an_end_of_a_noisy_output_are_clipped(y, end):
    assert np.array_equal(clipped_output(U, y), y == end)


STOPPED = np.clip(X, 120, 640)


@pytest.mark.parametrize(
    "y",
    [
        X + 2 * NOISE,
        steps(STOPPED + 2 * NOISE, 0.5),  # a stop: its plateau scatters
        steps(STOPPED + 2 * NOISE, 10),  # noise below the resolution
        steps(STOPPED + 3 * NOISE, 10),
        STOPPED,  # no noise anywhere
        steps(X, 1),
        steps(X, 40),
        np.repeat(steps(X + 2 * NOISE, 0.5)[::25], 25),  # read more often than it converts
    ],
)
def test_a_wire_at_its_stop_and_a_coarse_output_are_not_clipped(y):
    assert not clipped_output(U, y).any()


def test_a_reading_held_while_the_input_rests_is_not_clipped():
    still = np.r_[np.full(200, U[0]), U]
    y = np.r_[np.full(200, 810.0), X + NOISE]
    assert not clipped_output(still, y).any()


MAPPING = """name = "a"
summary = "b"
source = "c"
[time]
column = "t"
unit = "s"
[columns]
temperature_degC = { column = "T", unit = "K" }
position = { column = "x", unit = "um" }
[input]
channel = "temperature_degC"
quantity = "temperature"
unit = "degC"
[output]
quantity = "displacement"
unit = "um"
"""


@pytest.fixture
def log(tmp_path):
    path, mapping = tmp_path / "log.txt", tmp_path / "m.toml"
    y = np.minimum(steps(X + 2 * NOISE, 0.5), 610)
    rows = [f"{3 * k};{U[k]:.2f};{y[k]}" for k in range(ROWS)]
    path.write_text("\n".join(["t;T;x", *rows]) + "\n")
    mapping.write_text(MAPPING)
    return path, mapping


def test_the_temperatures_beyond_the_range_are_not_stated(tmp_path, log):
    path, mapping = log
    report = import_file(path, format="csv", out=tmp_path / "a.run.sqlite", mapping=str(mapping))
    assert "clipped output" in [f.kind for f in report.findings]
    found = transformation_temperatures(load_run(report.run))
    (run,) = found.runs
    assert {"A_f", "M_s", "stroke"} == set(run.means)
    assert run.cycles[0].why_not["A_s"] == "the output is clipped at 610 um there"
    assert "stroke                    at least" in str(found)
    assert any("A_s and M_f are not known" in note for note in run.notes)


def test_a_study_says_so_first(tmp_path, log):
    path, mapping = log
    result = study([path], tmp_path / "out", StudyOptions(mapping=str(mapping), diagnose=False))
    assert result.false_readings()[0].startswith("The output reads exactly 610 um in ")
    page = (tmp_path / "out" / "index.html").read_text()
    assert "at least" in page
