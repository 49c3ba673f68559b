"""A file given in the place of another is named, with the command that takes it; a diagnosis without an actuator."""

import sqlite3

import numpy as np
import pytest

from smarig.cli import run as cli


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A table, a run with a continuous current and no actuator, its model, a page, and another program's database."""
    folder = tmp_path_factory.mktemp("swapped")
    t = np.arange(0, 900, 1.5)
    current = 0.4 - 0.4 * np.cos(2 * np.pi * t / 180)
    position, out = 0.0, []
    for k, value in enumerate(current):
        position = min(max(position, value - 0.1), value + 0.1)
        out.append(f"{t[k]},{value:.5f},{position + 0.001 * np.sin(7.0 * k * k):.5f}")
    (folder / "a.csv").write_text("time_s,current_A,position_mm\n" + "\n".join(out) + "\n")
    made = {"a.csv": folder / "a.csv", "run": folder / "r.run.sqlite", "model": folder / "m.model.json"}
    assert cli(["import", str(made["a.csv"]), "--format", "csv", "-o", str(made["run"])]) == 0
    assert cli(["identify", str(made["run"]), "--surface", "positive", "-o", str(made["model"])]) == 0
    made["database"] = folder / "db.sqlite"
    with sqlite3.connect(made["database"]) as db:
        db.execute("CREATE TABLE readings (x REAL)")
    db.close()
    made["page"] = folder / "page.html"
    made["page"].write_text("<!DOCTYPE html><html></html>")
    return made


SWAPPED = [
    ("identify model", "is a model, not a run: `smarig verify MODEL RUN"),
    ("identify a.csv", "is a table of numbers, not a run: `smarig study`"),
    ("verify run run", "is a run, not a model: `smarig identify RUN"),
    ("verify model model", "is a model, not a run"),
    ("verify a.csv run", "is a table of numbers, not a model"),
    ("import run --format csv", "is a run, not a table of numbers"),
    ("import model --format csv", "is a model, not a table of numbers"),
    ("import database --format csv", "is an SQLite database, but no run of smarig"),
    ("import page --format csv", "is a page, not a table of numbers: open it with a browser"),
    ("study run", "is a run, not a table of numbers"),
    ("study database", "is an SQLite database, but no run of smarig"),
]


@pytest.mark.parametrize(("line", "said"), SWAPPED)
def test_a_swapped_file_is_named_in_one_sentence(files, tmp_path, capsys, line, said):
    command, *words = line.split()
    out = [] if command == "verify" else ["-o", str(tmp_path / "out")]
    status = cli([command, *(str(files.get(word, word)) for word in words), *out])
    error = capsys.readouterr().err.strip().splitlines()[-1]
    assert status == 4
    assert said in error
    assert "codec" not in error


NO_TOML = [
    ("check model", "is a model, not a configuration or mapping file: `smarig verify MODEL RUN"),
    ("run validation --rig run", "is a run, not a configuration or mapping file: `smarig identify RUN"),
    ("run validation --rig a.csv", "is a table of numbers, not a configuration or mapping file"),
    ("characterise --rig page", "is a page, not a configuration or mapping file"),
    ("import a.csv --format csv --map run", "is a run, not a configuration or mapping file"),
    ("import a.csv --format csv --map model", "is a model, not a configuration or mapping file"),
]


@pytest.mark.parametrize(("line", "said"), NO_TOML)
def test_a_file_that_is_no_configuration_is_named_in_one_sentence(files, tmp_path, capsys, line, said):
    command, *words = line.split()
    out = [] if command == "check" else ["-o", str(tmp_path / "out")]
    status = cli([command, *(str(files.get(word, word)) for word in words), *out])
    error = capsys.readouterr().err.strip()
    assert status == 2
    assert said in error
    assert "codec" not in error
    assert "\n" not in error


def test_an_unknown_command_suggests_the_nearest(capsys):
    assert cli(["charakterise"]) == 2
    assert "did you mean characterise?" in capsys.readouterr().err


def test_the_american_spelling_is_understood(capsys):
    assert cli(["characterize", "--help"]) == 0
    assert "smarig characterise" in capsys.readouterr().out


def test_a_run_whose_actuator_nobody_names_is_diagnosed(files, capsys):
    assert cli(["diagnose", str(files["model"]), "--train", str(files["run"])]) == 0
    assert "a Preisach model" in capsys.readouterr().out


def test_the_unit_inch_is_no_slip(tmp_path, files):
    mapping = tmp_path / "m.toml"
    mapping.write_text(
        'name = "m"\nsummary = "s"\nsource = "o"\n[columns]\ninput = { column = "current_A", unit = "A" }\n'
        'position = { column = "position_mm", unit = "inch" }\n[input]\nchannel = "input"\nquantity = "current"\n'
        'unit = "A"\n[output]\nquantity = "displacement"\nunit = "mm"\n[ignore]\ntime_s = "not needed"\n'
    )
    out = tmp_path / "x.run.sqlite"
    assert cli(["import", str(files["a.csv"]), "--format", "csv", "--map", str(mapping), "-o", str(out)]) == 0
