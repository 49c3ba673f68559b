"""A pipe or a device under the name of a file is refused in a sentence, before it is read: neither may ever end."""

import os
import signal
from pathlib import Path

import pytest

from smarig.cli import run

pytestmark = pytest.mark.skipif(os.name == "nt", reason="POSIX files")

RIG = ("--rig", "one_wire_twin")
COMMANDS = [  # with a pipe of that name
    ("pipe.csv", "study pipe.csv -o s --yes"),
    ("pipe.csv", "study pipe.csv -o s --each"),
    ("pipe.toml", "study data.csv --map pipe.toml -o s"),
    ("pipe.csv", "import pipe.csv --format csv --rig one_wire_twin -o o.run.sqlite"),
    ("pipe.py", "run ./pipe.py --rig one_wire_twin -o o.run.sqlite"),
    ("pipe.py", "run validation --rig one_wire_twin -o o.run.sqlite --effect ./pipe.py=3"),
    ("pipe.csv", "run validation --rig one_wire_thermomechanical --load pipe.csv --dry-run"),
    ("pipe.py", "check --driver ./pipe.py"),
    ("pipe.toml", "check ./pipe.toml"),
    ("pipe.toml", "check with_base.toml"),
    ("pipe.run.sqlite", "check pipe.run.sqlite"),
    ("pipe.run.sqlite", "resume pipe.run.sqlite"),
    ("pipe.model.json", "verify pipe.model.json pipe.run.sqlite"),
]


@pytest.fixture
def pipes(tmp_path, monkeypatch):
    """Pipes with names of every kind in the present folder. What waits for one is ended, and fails."""

    def give_up(*_):
        raise AssertionError("it waits for a pipe")

    monkeypatch.chdir(tmp_path)
    for end in ("csv", "toml", "py", "run.sqlite", "model.json"):
        os.mkfifo(f"pipe.{end}")
    Path("with_base.toml").write_text('base = "pipe.toml"\n')
    Path("data.csv").write_text("time,position\n" + "".join(f"{k},{k % 7}\n" for k in range(40)))
    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(20)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.usefixtures("pipes")
@pytest.mark.parametrize(("name", "command"), COMMANDS)
def test_a_pipe_is_refused_in_one_sentence(capsys, name, command):
    assert run(command.split()) == 2
    told = capsys.readouterr().err.splitlines()[-1]
    assert told.endswith(f"{name} is not a regular file, so it is not read. Give another name.")


@pytest.mark.usefixtures("pipes")
def test_a_device_that_never_ends_is_no_data(capsys):
    Path("zero.csv").symlink_to("/dev/zero")
    assert run(["study", "zero.csv", "-o", "s", "--yes"]) == 2
    assert "zero.csv is not a regular file" in capsys.readouterr().err


@pytest.mark.usefixtures("pipes")
def test_an_earlier_result_that_is_a_pipe_is_not_read(capsys):
    """It is looked for in the folder of results, which may have come from anywhere."""
    Path("s/data.csv").mkdir(parents=True)
    os.mkfifo("s/data.csv/study.json")
    assert run(["study", "data.csv", "-o", "s", "--each"]) == 2
    assert "study.json is not a regular file, so it is not replaced" in capsys.readouterr().err
