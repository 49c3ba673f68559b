"""Simulators that follow the clock keep the time of the rig file, so that both ends agree without an option."""

import json

import pytest
from click.testing import CliRunner

from simulators import labjack, supply_bench, text_bench

BASES = {  # of a rig file with such devices: what starts them, and where its class is named
    "text": (text_bench, "TextBench", "bench_one_wire"),
    "supply": (supply_bench, "SupplyBench", "laboratory_supply"),
    "labjack": (labjack, "LabJackServer", "labjack_one_wire"),
}


class Started:
    """Notes the arguments of the simulated instruments, which it replaces."""

    def __init__(self):
        self.arguments = ()
        self.urls = {}

    def __call__(self, *arguments):
        self.arguments = arguments
        return self

    def start(self):
        return self

    def close(self):
        pass


@pytest.mark.parametrize("devices", BASES)
@pytest.mark.parametrize(("words", "speed"), [([], 20.0), (["--speed", "3"], 3.0)])
def test_the_speed_is_that_of_the_rig_file_unless_another_is_given(
    tmp_path, monkeypatch, devices, words, speed
):
    module, name, base = BASES[devices]
    make = "rigol_dp800" if devices == "supply" else ""
    path = tmp_path / "mine.toml"
    path.write_text(
        f'name = "mine"\nbase = "{base}"\n[simulator]\ndevices = "{devices}"\nspeed = 20.0\nstart = false\n'
        + (f'make = "{make}"\n' if make else "")
    )
    monkeypatch.setattr(module, name, started := Started())
    done = CliRunner().invoke(module.main, ["--rig", str(path), *words])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["speed"] == speed
    assert speed in started.arguments
    if devices == "supply":
        assert make in started.arguments
