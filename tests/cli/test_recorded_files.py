"""A run or a model may name any file: none is read before the user names it, and no message quotes one."""

import json
import os
import sqlite3
import sys

import pytest

import smarig
from runner.interrupted import cut
from smarig.cli import run as cli
from smarig.core import UsageError
from smarig.record import load_run
from smarig.runner import resume

SECRET = "hunter2"


def call(capsys, *arguments):
    status = cli([str(a) for a in arguments])
    out, err = capsys.readouterr()
    assert "Internal error" not in err
    return status, out, err


@pytest.fixture
def killed(tmp_path):
    """A killed run whose inputs come from a file."""
    profile = tmp_path / "profile.csv"
    profile.write_text("temperature_K\n30\n60\n20\n")
    whole = smarig.run("step_currents", rig="one_wire_twin", out=tmp_path / "w.run.sqlite", file=str(profile))
    return cut(whole.path, tmp_path / "killed.run.sqlite", int(whole["tick"][-1]) * 2 // 3)


def started_with(path, **changes):
    """Another start in the record."""
    with sqlite3.connect(path) as db:
        (text,) = db.execute("SELECT value FROM run WHERE key = 'begun_with'").fetchone()
        db.execute(
            "UPDATE run SET value = ? WHERE key = 'begun_with'",
            (json.dumps({**json.loads(text), **changes}),),
        )
    db.close()


def test_a_profile_is_read_again_only_where_the_user_names_it(capsys, tmp_path, killed):
    before = killed.read_bytes()
    status, _, err = call(capsys, "resume", killed, "--quiet")
    assert status == 2
    assert f"was made with the file '{tmp_path / 'profile.csv'}', which would be read" in err
    assert f"smarig resume {killed.name} --set file=FILE." in err
    assert killed.read_bytes() == before
    moved = (tmp_path / "profile.csv").rename(tmp_path / "moved.csv")
    assert call(capsys, "resume", killed, "--quiet", "--set", f"file={moved}")[0] == 0
    assert load_run(killed).complete


def test_a_notebook_names_it_too(tmp_path, killed):
    with pytest.raises(UsageError, match="which would be read"):
        resume(killed)
    assert resume(killed, settings={"file": str(tmp_path / "profile.csv")}).complete


def test_a_profile_of_other_contents_does_not_continue_the_run(capsys, tmp_path, killed):
    (tmp_path / "profile.csv").write_text("temperature_K\n50\n60\n20\n")
    status, _, err = call(capsys, "resume", killed, "--quiet", "--set", f"file={tmp_path / 'profile.csv'}")
    assert status == 4
    assert "its protocol now commands" in err


@pytest.mark.parametrize("pair", ["points=3", "temperatures_K=1,2"])
def test_no_other_setting_is_changed_by_resuming(capsys, killed, pair):
    status, _, err = call(capsys, "resume", killed, "--set", pair)
    assert status == 2
    assert "cannot be given. Only these name files: file" in err


def test_no_secret_is_shown_by_a_run_that_names_its_file(capsys, tmp_path, killed):
    secret = tmp_path / "secret.toml"
    secret.write_text(f'{SECRET} = "{SECRET}"\n')
    for changes in ({"settings": {"file": str(secret)}}, {"rig": str(secret)}):
        started_with(killed, **changes)
        status, out, err = call(capsys, "resume", killed, "--quiet")
        assert status == 2
        assert SECRET not in out + err
        assert str(secret) in err


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize(
    "changes",
    [
        {"settings": ["points"]},
        {"speed": "fast"},
        {"noise": {}},
        {"effects": 7},
        {"rig": [1]},
        {"rig_wire": None},
    ],
)
def test_a_start_of_another_type_is_a_damaged_record(capsys, killed, changes):
    started_with(killed, **changes)
    status, _, err = call(capsys, "resume", killed, "--quiet")
    assert status == 4
    assert "its record is damaged" in err


@pytest.mark.skipif(sys.platform != "linux", reason="names of any bytes")
def test_a_name_that_is_no_text_is_refused_alone_and_left_out_of_a_folder(capsys, tmp_path, killed):
    name = os.fsdecode(b"\xff.run.sqlite")
    (tmp_path / name).write_bytes(killed.read_bytes())
    status, _, err = call(capsys, "report", tmp_path / name)
    assert status == 2
    assert r"\udcff.run.sqlite': this name is not UTF-8 text. Rename the file" in err
    status, _, err = call(capsys, "report", tmp_path)
    assert status == 0, err
    assert "this name is not UTF-8 text" in err
    assert (tmp_path / "killed.html").exists()


@pytest.mark.long("takes three seconds")
@pytest.mark.skipif(os.name == "nt", reason="POSIX files")
def test_odd_entries_do_not_stop_the_report_of_a_folder(capsys, tmp_path, killed):
    (tmp_path / "folder.run.sqlite").mkdir()
    os.mkfifo(tmp_path / "pipe.run.sqlite")
    (tmp_path / "loop.run.sqlite").symlink_to("loop.run.sqlite")
    assert call(capsys, "report", tmp_path)[0] == 0
    status, _, err = call(capsys, "report", tmp_path / "loop.run.sqlite", "-o", tmp_path / "x.html")
    assert status == 2, err
