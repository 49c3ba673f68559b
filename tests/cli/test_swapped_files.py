"""A file given in the place of another is named, with the command that takes it; a diagnosis without an actuator."""

import sqlite3

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.config import locate


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
    contents = {
        "picture": b"\x89PNG\r\n\x1a\n1 2 3\n",
        "curves": b"MicroMag 2900/3900 Data File\nFirst-order reversal curves\n\n+1,+1\n",
        "notes": b"Nothing was measured.\n",
        "cut": made["run"].read_bytes()[:100],
        "empty": b"",
        "other.toml": b'[project]\nname = "x"\n',
        "bare.toml": b'name = "x"\n',
    }
    for name, content in contents.items():
        made[name] = folder / name
        made[name].write_bytes(content)
    return made


SWAPPED = [
    ("identify model", "is a model, not a run: `smarig verify MODEL RUN"),
    ("report model", "`smarig report RUN --model MODEL`"),
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
    ("check database", "is an SQLite database, but no run of smarig"),
    ("report cut", "was cut off after 100 byte(s), before anything of a run"),
    ("check cut", "was cut off after 100 byte(s), before anything of a run"),
    ("report notes", "is not a run file: it is no SQLite database"),
    ("view empty", "is empty."),
    ("view model", "is a model, not a run"),
    ("report run --model a.csv", "is a table of numbers, not a model"),
    ("report run --model picture", "is a picture, not a model"),
    ("report run --summary --model curves", "is a file of reversal curves, not a model"),
    ("regulate page --setpoint 1 --rig one_wire_twin", "is a page, not a model"),
    ("track run --reference steps --rig one_wire_twin", "is a run, not a model"),
    ("export a.csv --to parquet", "is a table of numbers, not a run"),
    ("export a.csv --to c", "is a table of numbers, not a model"),
    (
        "run step_currents --rig one_wire_twin --dry-run --set file=model",
        "is a model, not a table of numbers",
    ),
]


def given(files, word):
    key, equals, name = word.rpartition("=")
    return f"{key}{equals}{files.get(name, name)}"


@pytest.mark.parametrize(("line", "said"), SWAPPED)
def test_a_swapped_file_is_named_in_one_sentence(files, tmp_path, capsys, line, said):
    command, *words = line.split()
    out = [] if command in ("verify", "view", "check") else ["-o", str(tmp_path / "out")]
    status = cli([command, *(given(files, word) for word in words), *out])
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
    ("import a.csv --format csv --map rig_file", "is a rig file, not a mapping file: give it with `--rig`"),
    ("check actuator_file", "is an actuator file, not a rig file: name it in a rig file"),
    ("check campaign_file", "is a campaign file, not a rig file: `smarig run` takes it"),
    ("run validation --rig mapping_file", "is a mapping file, not a rig file: give it to `smarig import`"),
    ("check other.toml", "is the settings of a Python project, not a rig file"),
    ("check bare.toml", "is not a rig file: 11 of 12 required keys are missing"),
    ("run rig_file --rig one_wire_twin", "is a rig file, not a campaign file"),
    ("run a.csv --rig one_wire_twin", "is a table of numbers, not a protocol or campaign: `smarig study`"),
    ("run model --rig one_wire_twin", "is a model, not a protocol or campaign"),
    ("run notes --rig one_wire_twin", "is neither a protocol (NAME.py) nor a campaign (NAME.toml)"),
    ("run validation --rig one_wire_thermomechanical --load run", "is a run, not a load"),
    ("run validation --rig one_wire_thermomechanical --load notes", "is no load. Give a force in N"),
    ("report run --summary --forc", "--summary and --forc write different pages"),
]
SHIPPED = {
    "rig_file": "rigs/one_wire_twin",
    "actuator_file": "actuators/gorbet_one_wire",
    "campaign_file": "campaigns/characterise",
    "mapping_file": "imports/ferrite_nested",
}


@pytest.mark.parametrize(("line", "said"), NO_TOML)
def test_a_file_that_is_no_configuration_is_named_in_one_sentence(files, tmp_path, capsys, line, said):
    command, *words = line.split()
    out = [] if command == "check" else ["-o", str(tmp_path / "out")]
    shipped = {name: locate(*place.split("/")) for name, place in SHIPPED.items()}
    status = cli([command, *(given(files | shipped, word) for word in words), *out])
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


@pytest.mark.long("takes ten seconds")
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
