"""An entry is refused when it is added, with the sentence of the command line, if its command would be refused."""

import json
import os
import shlex

import pytest

from console.queue.entries import opened, request
from smarig.cli import run as cli
from smarig.console.command_process import process_command
from smarig.console.queue.entry_preview import _pace
from smarig.console.queue.entry_request import entry_command, shown_command
from smarig.console.queue.queue import Queue
from smarig.core import InUse, UsageError
from smarig.record import recording


@pytest.mark.parametrize(
    "changes",
    [{"rig": "one_wire_twn"}, {"settings": {"points": "x"}}, {"effects": ("crep",)}, {"seed": -1}],
    ids=lambda changes: next(iter(changes)),
)
def test_the_sentence_is_that_of_the_command_line(tmp_path, capsys, changes):
    wrong = request(**changes)
    status = cli([*entry_command(wrong)[1:], "--dry-run", "--json"])
    sentence = json.loads(capsys.readouterr().out)["error"]
    assert status == 2
    with Queue.open(tmp_path) as queue:
        with pytest.raises(UsageError) as refused:
            queue.add(wrong)
        assert not queue.entries()
    assert str(refused.value) == sentence


def test_an_own_protocol_of_the_folder_is_previewed_and_no_module_of_it_imported(tmp_path):
    (tmp_path / "rest.py").write_text(
        "from smarig.core import Elapsed, Hold\n\n\n"
        "def rest(setup, *, seconds: float = 30.0):\n"
        '    """Wait."""\n    yield Hold(0.0, Elapsed(seconds))\n'
    )
    (tmp_path / "click.py").write_text("raise SystemExit('imported')\n")
    with Queue.open(tmp_path) as queue:
        own = request(experiment="./rest.py", settings={"seconds": "60"}, speed=10.0)
        entry = queue.entry(queue.add(own))
    assert entry.duration_s == pytest.approx(60.0, abs=0.2)
    assert entry.expected_s == pytest.approx(6.0, abs=0.02)


def test_a_characterisation_is_previewed_as_its_campaign(tmp_path, capsys):
    (tmp_path / "short.toml").write_text(
        'name = "short"\nsummary = "One run."\n'
        '[[step]]\nprotocol = "validation"\npurpose = "held_out"\nset = { points = "2" }\n'
    )
    campaign = str(tmp_path / "short.toml")
    assert (
        cli(["characterise", "--rig", "one_wire_twin", "--out", str(tmp_path / "o"), "--campaign", campaign])
        == 2
    )
    assert "no step with purpose" in capsys.readouterr().err
    (tmp_path / "short.toml").write_text((tmp_path / "short.toml").read_text().replace("held_out", "train"))
    words = ["characterise", "--rig", "one_wire_twin", "--out", str(tmp_path / "o"), "--campaign", campaign]
    assert cli([*words, "--dry-run", "--json"]) == 0
    (preview,) = json.loads(capsys.readouterr().out)["preview"]
    assert preview["protocol"] == "validation"
    assert not (tmp_path / "o").exists()


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"out": "../v.run.sqlite"}, "is outside"),
        ({"out": "/tmp/v.run.sqlite"}, "is outside"),
        ({"out": "link/v.run.sqlite"}, "is outside"),
        ({"out": "."}, "name of the console itself"),
        ({"out": "queue.logs/v.run.sqlite"}, "name of the console itself"),
        ({"out": "there.run.sqlite"}, "there.run.sqlite exists"),
        ({"out": "there.run.sqlite/v.run.sqlite"}, "is not a folder"),
        ({"out": "new/"}, "is a folder"),
        ({"out": "taken.run.sqlite"}, "Entry 1 writes to taken.run.sqlite"),
        ({"out": "x" * 300 + "/../../v"}, "is outside|no usable name"),
        ({"out": ""}, "needs the argument 'out'"),
        ({"rig": "a\0b"}, "null character"),
        ({"notes": "\ud800"}, "not UTF-8"),
        ({"notes": "n" * 60_000}, "may have 50000 characters"),
        ({"notes": 3}, "must be text"),
        ({"kind": "tea"}, "no kind of entry 'tea'"),
        ({"experiment": "--help"}, "no protocol or campaign '--help'"),
        ({"experiment": "quick_look"}, "is a campaign, not a protocol"),
        ({"kind": "campaign", "out": "c"}, "is no campaign"),
        ({"kind": "campaign", "experiment": "quick_look", "out": "full"}, "is not empty"),
        ({"kind": "campaign", "experiment": "quick_look", "out": "there.run.sqlite"}, "is not a folder"),
        ({"kind": "characterise", "experiment": "quick_look", "out": "c"}, "has no argument 'settings'"),
    ],
)
def test_what_no_command_line_would_tell_is_refused_too(tmp_path, changes, says):
    folder = tmp_path / "lab"
    with opened(folder) as queue:
        (folder / "link").symlink_to(tmp_path)
        (folder / "there.run.sqlite").write_text("")
        (folder / "full").mkdir()
        (folder / "full" / "notes.txt").write_text("mine")
        queue.add(request("taken"))
        with pytest.raises(UsageError, match=says) as refused:
            queue.add(request(**changes))
        assert len(queue.entries()) == 1
    assert str(refused.value).count("\n") == 0


def test_a_run_that_is_being_recorded_is_refused(tmp_path):
    locked, release = os.pipe(), os.pipe()
    recorder = os.fork()
    if recorder == 0:
        with recording(tmp_path / "v.run.sqlite"):
            os.write(locked[1], b"1")
            os.close(release[1])
            os.read(release[0], 1)
        os._exit(0)
    try:
        os.read(locked[0], 1)
        with opened(tmp_path) as queue, pytest.raises(InUse, match="v.run.sqlite is being recorded"):
            queue.add(request())
    finally:
        os.close(release[1])
        os.waitpid(recorder, 0)


def test_the_command_can_be_copied_and_options_are_not_injected(tmp_path):
    given = request(notes="--force", wire="it's; rm", settings={"file": "-x"}, effects=("settling=3",))
    words = entry_command(given, continued=True)
    assert words[:3] == ["smarig", "run", "validation"]
    assert "--notes=--force" in words
    assert "--force" not in words
    assert words[-1] == "--continue"
    line = shown_command(given, tmp_path / "a b")
    assert shlex.split(line)[3:] == entry_command(given)
    assert process_command(words)[1:4] == ["-P", "-m", "smarig"]


def test_the_expected_time_follows_the_pace_of_the_rig(tmp_path):
    assert _pace(request(rig="one_wire_twin"), tmp_path) is None
    assert _pace(request(rig="one_wire_twin", speed=20.0), tmp_path) == 20.0
    assert _pace(request(rig="bench_one_wire"), tmp_path) == 1.0
    assert _pace(request(rig="one_wire_serial", speed=4.0), tmp_path) == 4.0
