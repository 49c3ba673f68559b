"""``smarig tour``: its steps are commands that exist, and it says truly what was hidden and what was found."""

import json

import click
import pytest

from smarig.cli import cli
from smarig.cli import run as smarig_
from smarig.cli.commands import tour
from smarig.config import load_campaign


@pytest.mark.parametrize("line", [line for _, line in tour.STEPS])
def test_each_step_is_a_command_with_these_options(line, tmp_path):
    name, *words = (word.format(out=tmp_path, rig=tour.RIG, seed=22) for word in line.split())
    command = cli.get_command(click.Context(cli), name)
    assert command is not None
    command.make_context(name, words)  # an error if an option or a value is wrong


def test_its_campaign_can_be_run(tmp_path):
    file = tmp_path / "hunt.toml"
    file.write_text(tour.CAMPAIGN, encoding="utf-8")
    assert [step.purpose for step in load_campaign(str(file)).step] == ["train", "held_out"]


@pytest.mark.parametrize(
    ("hidden", "verdict", "names", "said"),
    [
        (["slip"], "named", ["slip"], "The diagnosis named it."),
        (["slip"], "named", ["walking"], "The diagnosis named walking, wrongly."),
        ([], "named", ["walking"], "The diagnosis named walking, wrongly."),
        ([], "silent", [], "The diagnosis found nothing, rightly."),
        (["dead_zone"], "silent", [], "found nothing: a free density imitates"),
        (["slip"], "ambiguous", ["walking", "slip"], "has it in its set: walking, slip"),
        (["slip"], "unknown", [], "gave it no name"),
    ],
)
def test_it_admits_what_the_diagnosis_did(hidden, verdict, names, said):
    assert said in tour._outcome(hidden, verdict, names)


def test_it_replaces_no_file(tmp_path, capsys):
    (tmp_path / "hunt.toml").write_text("mine", encoding="utf-8")
    assert smarig_(["tour", "-o", str(tmp_path)]) == 2
    assert "hunt.toml exists" in capsys.readouterr().err
    assert (tmp_path / "hunt.toml").read_text(encoding="utf-8") == "mine"


@pytest.mark.long("takes half a minute")
@pytest.mark.parametrize("as_json", [False, True])
def test_the_slip_of_the_tutorial_is_named(tmp_path, capsys, as_json):
    out = tmp_path / "tour"
    assert smarig_(["tour", "-o", str(out), *(["--json"] if as_json else [])]) == 0
    said = capsys.readouterr().out
    if as_json:
        found = json.loads(said)
        assert found["verdict"] == "named"
        assert found["set"] == ["slip"]
        assert found["hidden"][0].startswith("slip(")
    else:
        assert "$ smarig diagnose" in said
        assert "The diagnosis named it." in said
    assert (out / "diagnosis" / "report.html").is_file()
