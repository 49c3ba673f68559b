"""A protocol through a simulated LabJack, by the command: its settled positions are those of the twin in process.

The devices run at fifty times real time. A lease of ten seconds and small steps of the current leave room for pauses
of a busy machine: no pause looks like a host that failed, or like an encoder that jumped.
"""

import numpy as np
import pytest

import smarig
from smarig.cli import run as cli

LABJACK = """
name = "fast"
base = "labjack_one_wire"
lease_s = 10.0
simulator = { speed = 50.0 }
"""
TWIN = """
name = "in_process"
base = "one_wire_twin"
encoder = { resolution = 0.002 }
"""
HELD = 20  # samples at the end of a step that are averaged


@pytest.mark.long("takes three seconds")
def test_settled_positions_are_those_of_the_twin(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    bench, twin = (settled(tmp_path, name, text) for name, text in (("bench", LABJACK), ("twin", TWIN)))
    assert len(bench) == len(twin) == 2
    for measured, expected in zip(bench, twin):
        position, spread = measured
        assert abs(position - expected[0]) < 0.01  # mm: five steps of the sensor, of a travel of 2 mm
        assert spread < 0.005
    assert twin[1][0] - twin[0][0] > 0.5


def settled(folder, name, text):
    """Mean and standard deviation of the position at the end of every current."""
    (folder / f"{name}.toml").write_text(text)
    arguments = ["run", "step_currents", "--rig", f"./{name}.toml", "-o", f"{name}.run.sqlite", "--quiet"]
    assert cli([*arguments, "--set", "currents_A=0.4,0.43"]) == 0
    run = smarig.load_run(f"{name}.run.sqlite")
    command, position = run["current_command_A"], run["position"]
    ends = [*np.flatnonzero(np.diff(command)), len(command) - 1]
    return [
        (position[end - HELD : end].mean(), position[end - HELD : end].std())
        for end in ends
        if command[end] > 0.2
    ]


@pytest.mark.parametrize(
    ("simulator", "says"),
    [("speed = 0.0", "no lock-step"), ('speed = 1.0\ntrace = "t.csv"', "no simulator.trace")],
)
def test_what_a_simulated_labjack_cannot_do_is_said(tmp_path, monkeypatch, capsys, simulator, says):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.toml").write_text(f'name = "a"\nbase = "labjack_one_wire"\n[simulator]\n{simulator}\n')
    arguments = ["run", "validation", "--rig", "./a.toml", "-o", "a.run.sqlite", "--set", "points=2"]
    assert cli([*arguments, "--quiet"]) == 2
    assert f"The simulated LabJack has {says}" in capsys.readouterr().err
