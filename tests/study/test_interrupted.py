"""A study that is interrupted, loses a worker, or whose files change or vanish: one sentence, and it continues."""

import os

import numpy as np
import pytest

from smarig.core.errors import DataError, StorageError
from smarig.exchange import FileChangedError, import_file
from smarig.study import StudyOptions, each_file, study, study_each
from smarig.study.parallel import completed
from study.known_data import csv_text, displacements, temperatures
from study.worker_tasks import kill_itself, own_process

QUICK = StudyOptions(diagnose=False)
POSIX = pytest.mark.skipif(os.name == "nt", reason="POSIX signals")


@pytest.fixture
def folder(tmp_path):
    data = tmp_path / "data"
    data.mkdir()
    u = temperatures(2, 40)
    for k in range(3):
        text = csv_text(np.arange(u.size) * 0.5, u, displacements(u, k))
        (data / f"{k}.csv").write_text(text, encoding="utf-8")
    return data


def test_after_ctrl_c_the_same_command_continues(folder, tmp_path):
    said = []

    def interrupt(text):
        said.append(text)
        if text.startswith("2 of 3: "):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        study_each([folder], tmp_path / "out", QUICK, workers=1, progress=interrupt)
    assert said[-1] == "2 of 3 files are done and kept; the same command continues."
    (folder / "0.csv").unlink()
    outcomes = study_each([folder], tmp_path / "out", QUICK, workers=1)
    assert [(o.file[-5:], o.reused) for o in outcomes] == [("1.csv", True), ("2.csv", False)]
    page = (tmp_path / "out" / "index.html").read_text(encoding="utf-8")
    assert 'href="1.csv/index.html"' in page
    assert "0.csv" not in page


def test_a_file_removed_meanwhile_is_one_sentence(folder, tmp_path):
    def remove(text):
        if text.startswith("1 of 3: "):
            (folder / "1.csv").unlink()

    outcomes = study_each([folder], tmp_path / "out", QUICK, workers=1, progress=remove)
    assert outcomes[1].failure == f"There is no file {folder / '1.csv'}."
    assert [o.found is not None for o in outcomes] == [True, False, True]


def test_a_file_changed_while_it_is_read_is_refused(folder, tmp_path, monkeypatch):
    file = folder / "0.csv"

    def append(text):
        if text == "reading":
            with file.open("a", encoding="utf-8") as stream:
                stream.write("80,0;25,000;0,0000\r\n")

    with pytest.raises(FileChangedError, match=r"0\.csv was changed while it was read"):
        study([file], tmp_path / "one", QUICK, progress=append)
    monkeypatch.setattr(each_file, "study", lambda *a, **k: study(*a, **k, progress=append))
    assert "was changed" in study_each([file], tmp_path / "out", QUICK, workers=1)[0].failure
    monkeypatch.undo()
    again = study_each([file], tmp_path / "out", QUICK, workers=1)[0]
    assert again.found is not None  # the failure said nothing of the file, so it was not kept


def test_a_full_disk_ends_the_study_of_a_folder(folder, tmp_path, monkeypatch):
    def refuse(*_a, **_k):
        raise StorageError("The disk is full.")

    monkeypatch.setattr(each_file, "study", refuse)
    with pytest.raises(StorageError):
        study_each([folder], tmp_path / "out", QUICK, workers=1)


def test_an_import_that_is_overtaken_writes_no_run(folder, tmp_path, monkeypatch):
    from smarig.exchange import importing

    file, out = tmp_path / "a.csv", tmp_path / "a.run.sqlite"
    file.write_text("time_s,current_A,position_mm\n0,0,0\n1,0,0\n2,0,0\n")
    read = importing.catalogue_entry("smarig.exchange.readers", "csv")

    def slowly(*a, **k):
        draft = read(*a, **k)
        file.write_text("time_s,current_A,position_mm\n0,0,0\n1,0,0\n")
        return draft

    monkeypatch.setattr(importing, "catalogue_entry", lambda *_: slowly)
    with pytest.raises(FileChangedError):
        import_file(file, format="csv", out=out)
    assert not out.exists()


@POSIX
def test_a_killed_worker_is_one_sentence():
    with pytest.raises(DataError, match="A worker process was ended from outside"):
        list(completed(kill_itself, range(3), 2))


@POSIX
def test_an_interruption_ends_the_workers_at_once():
    answers = completed(own_process, range(3), 2)
    number, ignores = next(answers)
    assert ignores  # Ctrl-C goes to all processes of a terminal: the parent ends the others
    answers.close()
    with pytest.raises(ProcessLookupError):
        os.kill(number, 0)
