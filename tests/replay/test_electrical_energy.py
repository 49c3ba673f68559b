"""The electrical energy of a run, and the heat of the heating model: sums in closed form, on the page and in JSON."""

import json

import numpy as np
import pytest

import smarig
from smarig.cli import run as cli
from smarig.plant import Actuator
from smarig.replay import electrical_energy
from smarig.report import run_page

WIRE = Actuator.named("gorbet_one_wire")  # R_M = 5, R_A = 4.5 ohm


class Samples:
    """Ten samples of 0.5 A at 5 ohm, 0.1 s apart; the fourth and fifth were lost, the last has no voltage."""

    def __init__(self, blocks):
        ticks = np.array([1, 2, 3, 6, 7, 8, 9, 10])
        self.columns = {"tick": ticks, "current_A": np.full(8, 0.5), "voltage_V": np.full(8, 2.5)}
        self.columns["voltage_V"][-1] = np.nan
        self.info, self.cuts = type("Info", (), {"period_s": 0.1}), blocks

    def has(self, name):
        return name in self.columns

    def blocks(self, names):
        for part in np.array_split(np.arange(8), self.cuts):
            yield {name: self.columns[name][part] for name in names}


@pytest.mark.parametrize("blocks", [1, 3, 8])
def test_lost_ticks_count_and_readings_without_voltage_do_not(blocks):
    found = electrical_energy(Samples(blocks), WIRE)
    assert found.electrical_J == pytest.approx(9 * 0.1 * 1.25)
    assert found.mean_resistance_J == pytest.approx(9 * 0.1 * 0.25 * 4.75)
    assert found.difference_percent == pytest.approx(100 * (5 / 4.75 - 1))


@pytest.mark.long("takes three seconds")
def test_page_and_json_state_both_and_what_heated_the_twin(tmp_path, capsys):
    wire = tmp_path / "balanced.toml"
    assert cli(["new", "actuator", "balanced", "-o", str(wire)]) == 0
    wire.write_text(
        wire.read_text(encoding="utf-8").replace("[heating]", '[heating]\ntwin_heat = "phase_resistance"')
    )
    rig = tmp_path / "rig.toml"
    rig.write_text(f'name = "rig"\nbase = "one_wire_twin"\nactuator = "{wire}"\n', encoding="utf-8")
    for name, words in (
        ("one_wire_twin", "this twin is heated by it, as in the thesis"),
        (str(rig), "by V i"),
    ):
        run = smarig.run(
            "step_currents", rig=name, out=tmp_path / "a.run.sqlite", force=True, currents_A=(0.3, 0.8)
        )
        assert words in run_page(run)
        capsys.readouterr()
        assert cli(["report", str(run.path), "--json", "--force"]) == 0
        energy = json.loads(capsys.readouterr().out)["energy"]
        power = float(np.sum(run["voltage_V"] * run["current_A"]) * 0.1)
        assert energy["electrical_J"] == pytest.approx(power, rel=1e-5)
