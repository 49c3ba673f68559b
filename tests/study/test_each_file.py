"""Many files: a page each, one that compares them, failures listed, and nothing done twice."""

import json

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.study import StudyOptions, find_files, study_each
from study.known_data import csv_text, displacements, temperatures

pytestmark = pytest.mark.usefixtures("drawings")
QUICK = StudyOptions(diagnose=False)


@pytest.fixture
def folder(tmp_path):
    """Two measurements, one of them in a folder below, a table that is none, and texts that are no data."""
    data = tmp_path / "data"
    (data / "day 2").mkdir(parents=True)
    for k, name in enumerate(("a.csv", "day 2/b.csv")):
        u = temperatures(2, 50)
        (data / name).write_text(csv_text(np.arange(u.size) * 0.5, u, displacements(u, k)), encoding="utf-8")
    (data / "broken.csv").write_text("Nothing was measured on Sunday.\n")
    (data / "notes.txt").write_text("Nothing was measured on Sunday.\n")
    (data / "README.md").write_text("1 2\n3 4\n5 6\n")
    return data


def test_a_page_each_and_one_that_compares_them(folder, tmp_path):
    out = tmp_path / "out"
    outcomes = study_each([folder], out, QUICK, workers=1)
    assert [o.found is not None for o in outcomes] == [True, False, True, False, False]
    assert [o.failed for o in outcomes] == [False, True, False, False, False]
    page = (out / "index.html").read_text(encoding="utf-8")
    for o in outcomes:
        if o.found:
            name = o.folder.rsplit("/", 1)[-1]
            assert f'href="{name}/index.html"' in page
            assert "smarig-figures.js" in (out / name / "index.html").read_text(encoding="utf-8")
    assert "broken.csv holds no table" in page
    assert "1</strong><span>file<" in page.split("Failed", 1)[1]
    assert page.count("<svg") == 2, "a thumbnail of each loop"
    for name in ("notes.txt", "README.md"):
        assert f"{name}: not data, left out" in page


@pytest.mark.long("takes three seconds")
def test_what_was_done_is_not_done_again_unless_it_changed(folder, tmp_path):
    out = tmp_path / "out"
    study_each([folder], out, QUICK, workers=1)
    done = out / "a.csv" / "index.html"
    done.write_text("kept", encoding="utf-8")
    (out / "day_2_b.csv" / "index.html").unlink()  # as if interrupted before its end
    outcomes = study_each([folder], out, QUICK, workers=1)
    assert [o.reused for o in outcomes] == [True, True, False, False, False]
    assert done.read_text(encoding="utf-8") == "kept"
    source = folder / "a.csv"
    source.write_text(
        source.read_text(encoding="utf-8").replace("Messprogramm 2.1", "Messprogramm 2.2"), encoding="utf-8"
    )
    again = study_each([folder], out, QUICK, workers=1)
    assert [o.reused for o in again] == [False, True, True, False, False]
    other = StudyOptions(diagnose=False, split="none")
    assert not any(o.reused for o in study_each([folder], out, other, workers=1))


@pytest.mark.long("takes three seconds")
def test_a_folder_on_the_command_line_in_two_processes(folder, tmp_path, capsys):
    out = tmp_path / "out"
    assert cli(["study", str(folder), "-o", str(out), "--no-diagnosis", "--workers", "2", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["studied"] == 2
    assert list(found["failed"]) == [str(folder / "broken.csv")]
    assert found["left_out"] == {str(folder / n): "not data, left out" for n in ("README.md", "notes.txt")}


def test_an_output_inside_the_data_is_refused(folder, capsys):
    assert cli(["study", str(folder), "-o", str(folder / "out")]) == 2
    assert "Give another folder" in capsys.readouterr().err


def test_files_are_compared_in_the_order_in_which_people_count(tmp_path):
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


def test_files_are_listed_in_the_order_of_their_numbers(tmp_path):
    names = ["7 MPa.csv", "50 MPa.csv", "100 MPa.csv", "200 MPa.csv"]
    for name in names:
        (tmp_path / name).write_text("1 2\n")
    assert [file.name for file in find_files([tmp_path]).data] == names
    by_a_shell = sorted(tmp_path.glob("*.csv"))
    assert [file.name for file in find_files(by_a_shell).data] == names
    chosen = [tmp_path / name for name in ("50 MPa.csv", "200 MPa.csv", "7 MPa.csv")]
    assert list(find_files(chosen).data) == chosen


@pytest.mark.parametrize(
    ("name", "text", "data"),
    [
        ("loop.txt", "T\tx\n" + "20,5\t1,25\n" * 5, True),
        ("loop", "# a long remark\n" + "2020-01-01 10:00 1.5 2.5\n" * 5, True),
        ("empty.txt", "", True),  # its reader says that it is empty
        ("README.txt", "1 2\n3 4\n5 6\n7 8\n", False),
        ("Notes on the wire", "Measured at 25 °C on 3 days.\n" * 9, False),
        ("remarks.txt", "Measured at 25 °C on 3 days.\n" * 9, False),
        ("fit.py", "1 2\n3 4\n5 6\n", False),
    ],
)
def test_notes_and_programs_are_no_data(tmp_path, name, text, data):
    (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "sure.csv").write_text("1 2\n")
    found = find_files([tmp_path])
    assert (tmp_path / name in found.data) == data
    assert (tmp_path / name in found.left_out) != data
    assert find_files([tmp_path / name]).data == (tmp_path / name,)  # a file that is named is used
