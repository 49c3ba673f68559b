"""``smarig check FOLDER``: what killed processes left unfinished is named, and removed only if asked for."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from smarig.cli import run

pytestmark = pytest.mark.skipif(os.name == "nt", reason="process numbers of POSIX")
WRITING = """
import sys
from pathlib import Path
from smarig.core import new_file
with new_file(Path(sys.argv[1]), force=False) as part:
    part.write_text("half")
    print("written", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def writing(tmp_path):
    """A process within the creation of a file."""
    with subprocess.Popen(
        [sys.executable, "-c", WRITING, tmp_path / "a.txt"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout.readline() == "written\n"
        yield process
        process.kill()


def checked(capsys, *words: str | Path) -> list[dict]:
    """The unfinished files that the command names."""
    assert run(["check", *map(str, words), "--json"]) == 0
    return json.loads(capsys.readouterr().out)["leftovers"]


def test_a_file_that_is_being_written_is_named_and_kept(writing, tmp_path, capsys):
    (found,) = checked(capsys, tmp_path, "--remove-leftovers")
    assert (found["of"], found["writer"], found["removed"]) == ("a.txt", "alive", False)
    writing.stdin.close()
    assert writing.wait() == 0
    assert (tmp_path / "a.txt").read_text() == "half"
    assert checked(capsys, tmp_path) == []


def test_what_a_killed_process_left_is_removed_on_request(writing, tmp_path, capsys):
    other = tmp_path / "own.part"
    other.write_text("of the user")
    writing.send_signal(signal.SIGKILL)
    writing.wait()
    (found,) = checked(capsys, tmp_path)
    assert (found["of"], found["writer"], found["removed"]) == ("a.txt", "ended", False)
    assert Path(found["file"]).read_text() == "half"
    (found,) = checked(capsys, tmp_path, "--remove-leftovers")
    assert found["removed"]
    assert list(tmp_path.iterdir()) == [other]


@pytest.mark.parametrize(
    "name", [".a.txt.00000000-1-0123456789abcdef.part", ".a.txt.0123456789abcdef.part-wal"]
)
def test_a_file_of_another_computer_or_version_is_kept(tmp_path, capsys, name):
    (tmp_path / name).touch()
    (found,) = checked(capsys, tmp_path, "--remove-leftovers")
    assert (found["of"], found["writer"], found["removed"]) == ("a.txt", "unknown", False)


def test_other_options_are_refused(tmp_path):
    assert run(["check", str(tmp_path), "--force"]) == 2
    assert run(["check", "one_wire_twin", "--remove-leftovers"]) == 2
