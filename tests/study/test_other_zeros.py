"""A sensor that was seated again between two files: the same loop with another zero is told, and nothing else is."""

import json

import numpy as np
import pytest

from smarig.study import StudyOptions, study, study_each
from study.known_data import csv_text, displacements, temperatures

pytestmark = pytest.mark.usefixtures("drawings")
QUICK = StudyOptions(diagnose=False)


def written(folder, name, *, zero=0.0, shift=0.0, gain=1.0, seed=0, rows=60):
    folder.mkdir(exist_ok=True)
    u = temperatures(2, rows)
    y = zero + gain * displacements(u - shift, seed=seed)
    (folder / name).write_text(csv_text(np.arange(u.size) * 2.0, u, y), encoding="utf-8")
    return folder / name


def told(folder, tmp_path):
    outcomes = study_each([folder], tmp_path / "out", QUICK, workers=1)
    page = (tmp_path / "out" / "index.html").read_text(encoding="utf-8")
    found = json.loads((tmp_path / "out" / "study.json").read_text(encoding="utf-8"))["other_zeros"]
    assert all(text in page for text in found.values())
    assert found == {o.file: o.other_zero for o in outcomes if o.other_zero}
    return found


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("zero", [-0.8, 0.5])
def test_the_same_loop_with_another_zero_is_told(tmp_path, zero):
    folder = tmp_path / "data"
    for k, own in enumerate((0.0, 0.0, zero)):
        written(folder, f"day{k}.csv", zero=own, seed=k, rows=60 + 5 * k)
    ((file, text),) = told(folder, tmp_path).items()
    assert file.endswith("day2.csv")
    assert text.startswith("day2.csv holds the loop of day0.csv with another zero of the output: it reads ")
    assert f" mm {'more' if zero > 0 else 'less'} throughout" in text
    assert float(text.split("reads ")[1].split()[0]) == pytest.approx(abs(zero), abs=0.02)


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("other", [{"shift": 12.0, "zero": 0.5}, {"gain": 1.4, "zero": 0.5}, {"zero": 0.0}])
def test_another_loop_has_no_zero_to_compare(tmp_path, other):
    folder = tmp_path / "data"
    written(folder, "a.csv")
    written(folder, "b.csv", seed=1, **other)
    assert told(folder, tmp_path) == {}


def test_another_load_moves_the_output_too(tmp_path):
    folder = tmp_path / "data"
    written(folder, "wire_50MPa.csv")
    written(folder, "wire_80MPa.csv", seed=1, zero=0.5)
    assert told(folder, tmp_path) == {}


@pytest.mark.parametrize(("zero", "more"), [(0.5, True), (0.0, False)])
def test_runs_that_are_given_together_tell_it_as_well(tmp_path, zero, more):
    files = [written(tmp_path, f"{k}.csv", zero=k * zero, seed=k) for k in range(2)]
    hints = [h for h in study(files, tmp_path / "out", QUICK).hints() if "another zero" in h]
    assert bool(hints) is more
    assert not more or " mm more throughout than that of the fitted runs" in hints[0]


@pytest.mark.parametrize(("zero", "more"), [(0.35, True), (0.0, False)])
def test_a_zero_is_told_beside_larger_errors_of_either_sign(tmp_path, zero, more):
    files = []
    for k in range(2):
        u = np.concatenate([temperatures(2, 80)[:-1] * scale for scale in (1.0, 0.8, 0.9)])
        late = (
            np.r_[np.full(4, u[0]), u[:-4]]
            + np.where(np.gradient(u) > 0, 2.0, -2.0) * np.arange(u.size) / u.size
        )
        path = tmp_path / f"{k}.csv"
        path.write_text(csv_text(np.arange(u.size) * 2.0, u, k * zero + displacements(late, seed=k)))
        files.append(path)
    result = study(files, tmp_path / "out", QUICK)
    assert result.evaluation.best.rms > 0.35 / 3
    hints = [h for h in result.hints() if "another zero" in h]
    assert bool(hints) is more
