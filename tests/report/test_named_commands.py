"""A command that the page of a run names can be typed as it stands there."""

import shlex

import pytest

from smarig.cli import run as cli
from smarig.record import load_run
from smarig.report.runs.run_assessment import run_assessment

RUNS = {
    "minor_loops": ["--set", "low_A=0", "--set", "high_A=0.9", "--set", "loops=1", "--set", "loop_s=90"],
    "first_order_descending": ["--set", "partition_K=0,20,40,60,90,120,170"],
}


@pytest.mark.parametrize(
    "protocol",
    ["minor_loops", pytest.param("first_order_descending", marks=pytest.mark.long("takes three seconds"))],
)
def test_it_makes_a_model(protocol, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli(["run", protocol, "--rig", "one_wire_twin", *RUNS[protocol], "-o", "a.run.sqlite"]) == 0
    advice = run_assessment(load_run("a.run.sqlite")).advice
    _, _, command = advice.partition(": smarig ")
    assert cli(shlex.split(command.removesuffix("."))) == 0
    assert (tmp_path / "wire.model.json").is_file()


def test_a_waveform_has_no_holds_that_settle(tmp_path):
    run = tmp_path / "a.run.sqlite"
    assert cli(["run", "minor_loops", "--rig", "one_wire_twin", *RUNS["minor_loops"], "-o", str(run)]) == 0
    assert "settled" not in run_assessment(load_run(run)).quality
