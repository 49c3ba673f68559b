"""What the checks of a rig file cost: a console makes them for every rig of a folder at each look."""

import smarig.plant.actuator as actuator_module
from smarig.config import load_rig
from smarig.rig import inconsistencies


def test_the_file_of_the_actuator_is_read_once(monkeypatch):
    read, load = [], actuator_module.load_actuator
    monkeypatch.setattr(actuator_module, "load_actuator", lambda name: read.append(name) or load(name))
    assert inconsistencies(load_rig("two_wire_serial")) == []
    assert read == ["gorbet_two_wire"]


def test_an_actuator_whose_file_is_wrong_is_said_once(tmp_path):
    (tmp_path / "wrong.toml").write_text("name = 7\n")
    (tmp_path / "rig.toml").write_text('base = "one_wire_serial"\nname = "r"\nactuator = "wrong.toml"\n')
    (problem,) = inconsistencies(load_rig(str(tmp_path / "rig.toml")))
    assert "wrong.toml is not an actuator file" in problem
