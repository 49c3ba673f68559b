"""A bring-up heats the wire, so it enters the wire's history, as a run does."""

import json
import re
import signal

import pytest

import smarig
from runner.lasting_devices import rig_file, started
from smarig.cli import run as cli
from smarig.record import load_wire_history
from smarig.record.wire_history import WireHistory


@pytest.fixture(scope="module")
def urls():
    with started() as found:
        yield found


@pytest.fixture
def rig(tmp_path, urls, monkeypatch):
    monkeypatch.setenv("SMARIG_HISTORY_DIR", str(tmp_path / "wires"))
    return str(rig_file(tmp_path / "rig.toml", urls))


def history():
    return load_wire_history("lasting", twin=True)


def test_a_run_after_a_bring_up_knows_how_hot_the_wire_was(rig, tmp_path, capsys):
    WireHistory("lasting", twin=True, cycles=3, largest_input_K=5.0).save()
    assert cli(["check", rig, "--json"]) == 0
    checks = {c["name"]: c["seen"] for c in json.loads(capsys.readouterr().out)["checks"]}
    heated_K = float(re.search(r"([\d.]+) K \(heating model\)", checks["encoder direction"])[1])
    assert heated_K > 20, "the check heats"
    found = history()
    assert found.largest_input_K == pytest.approx(heated_K, abs=1.0)
    assert (found.runs, found.cycles) == (0, 3), "it is no run, and rose above no half of the range"
    assert found.heat is not None
    assert found.heat.wire_K[0] < 1.0, "it cools the wire again"
    run = smarig.run("validation", rig=rig, out=tmp_path / "a.run.sqlite", points=2)
    assert run.meta["wire_history"] == found.sentence()


def test_a_bring_up_that_is_stopped_leaves_the_heat_of_its_wire(rig, monkeypatch):
    def stop_once_hot(text):
        if "K (heating model)" in text and "+0 K" not in text:
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr("smarig.cli.rig_bring_up.show_message", stop_once_hot)
    assert cli(["check", rig]) == 130
    found = history()
    assert found.largest_input_K > 0.5
    assert found.heat.wire_K[0] == pytest.approx(found.largest_input_K, abs=0.5), "still as hot as it got"


@pytest.mark.long("takes two seconds")
def test_a_history_that_cannot_be_read_ends_no_bring_up(rig, tmp_path, capsys):
    WireHistory("lasting", twin=True).save()
    next((tmp_path / "wires").iterdir()).write_text("{}", "utf-8")
    assert cli(["check", rig]) == 0
    assert "The wire's history was not written: Wire history" in capsys.readouterr().err
