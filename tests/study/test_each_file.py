"""Many files: a page each, one that compares them, failures listed, and nothing done twice."""

import json

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.study import StudyOptions, study_each
from smarig.study.natural_order import natural_key
from study.known_data import csv_text, displacements, temperatures

QUICK = StudyOptions(diagnose=False)


@pytest.fixture
def folder(tmp_path):
    """Two measurements, one of them in a folder below, a text and a damaged workbook."""
    data = tmp_path / "data"
    (data / "day 2").mkdir(parents=True)
    for k, name in enumerate(("a.csv", "day 2/b.csv")):
        u = temperatures(2, 50)
        (data / name).write_text(csv_text(np.arange(u.size) * 0.5, u, displacements(u, k)), encoding="utf-8")
    (data / "notes.txt").write_text("Nothing was measured on Sunday.\n")
    (data / "README.md").write_text("1 2\n3 4\n5 6\n")
    return data


def test_a_page_each_and_one_that_compares_them(folder, tmp_path):
    out = tmp_path / "out"
    outcomes = study_each([folder], out, QUICK, workers=1)
    assert [o.found is not None for o in outcomes] == [True, True, False]
    page = (out / "index.html").read_text(encoding="utf-8")
    for o in outcomes:
        if o.found:
            name = o.folder.rsplit("/", 1)[-1]
            assert f'href="{name}/index.html"' in page
            assert "smarig-figures.js" in (out / name / "index.html").read_text(encoding="utf-8")
    assert "notes.txt holds no table" in page
    assert page.count("<svg") == 2, "a thumbnail of each loop"
    assert "README" not in page


def test_what_was_done_is_not_done_again_unless_it_changed(folder, tmp_path):
    out = tmp_path / "out"
    study_each([folder], out, QUICK, workers=1)
    done = out / "a.csv" / "index.html"
    done.write_text("kept", encoding="utf-8")
    (out / "day_2_b.csv" / "index.html").unlink()  # as if interrupted before its end
    outcomes = study_each([folder], out, QUICK, workers=1)
    assert [o.reused for o in outcomes] == [True, False, True]
    assert done.read_text(encoding="utf-8") == "kept"
    source = folder / "a.csv"
    source.write_text(
        source.read_text(encoding="utf-8").replace("Messprogramm 2.1", "Messprogramm 2.2"), encoding="utf-8"
    )
    assert [o.reused for o in study_each([folder], out, QUICK, workers=1)] == [False, True, True]
    other = StudyOptions(diagnose=False, split="none")
    assert not any(o.reused for o in study_each([folder], out, other, workers=1))


def test_a_folder_on_the_command_line_in_two_processes(folder, tmp_path, capsys):
    out = tmp_path / "out"
    assert cli(["study", str(folder), "-o", str(out), "--no-diagnosis", "--workers", "2", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["studied"] == 2
    assert list(found["failed"]) == [str(folder / "notes.txt")]


def test_an_output_inside_the_data_is_refused(folder, capsys):
    assert cli(["study", str(folder), "-o", str(folder / "out")]) == 2
    assert "Give another folder" in capsys.readouterr().err


def test_files_are_compared_in_the_order_in_which_people_count(tmp_path):
    assert sorted(["200 MPa", "7 MPa", "50 MPa"], key=natural_key) == ["7 MPa", "50 MPa", "200 MPa"]
    data = tmp_path / "data"
    data.mkdir()
    u = temperatures(1, 50)
    for name in ("wire 10.csv", "wire 9.csv", "wire 1.csv"):
        (data / name).write_text(csv_text(np.arange(u.size) * 0.5, u, displacements(u)), encoding="utf-8")
    out = tmp_path / "out"
    study_each([data], out, QUICK, workers=1)
    page = (out / "index.html").read_text(encoding="utf-8")
    places = [page.index(f'href="wire_{k}.csv/index.html"') for k in (1, 9, 10)]
    assert places == sorted(places)
