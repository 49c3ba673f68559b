"""``smarig calibrate`` starts from the actuator of the runs; kelvins of another one are refused."""

import pytest

import smarig
from smarig.cli import run as cli
from smarig.config import actuator_text
from smarig.core.catalogue import own_files
from smarig.plant import Actuator


@pytest.fixture(scope="module")
def wave(tmp_path_factory):
    """A loop on a wire of one's own, which 1 A heats by 250 K, its model, and the folder."""
    folder = tmp_path_factory.mktemp("own")
    text = actuator_text("gorbet_one_wire").replace("gorbet_one_wire", "my_wire")
    (folder / "my_wire.toml").write_text(text.replace("174.1, unit", "250.0, unit", 1), encoding="utf-8")
    (folder / "mine.toml").write_text('base = "one_wire_twin"\nname = "mine"\nactuator = "./my_wire.toml"\n')
    with own_files():
        out = folder / "loop.run.sqlite"
        smarig.run(
            "minor_loops", rig=str(folder / "mine.toml"), out=out, low_A=0, high_A=0.8, loops=1, loop_s=90
        )
        assert cli(["identify", str(out), "--surface", "positive", "-o", str(folder / "w.model.json")]) == 0
    return folder


def calibrated(wave, *more):
    return cli(
        ["calibrate", str(wave / "loop.run.sqlite"), "--model", str(wave / "w.model.json"), *map(str, more)]
    )


@pytest.mark.long("takes three seconds")
def test_the_file_starts_from_the_actuator_of_the_runs(wave, tmp_path):
    out = tmp_path / "measured.toml"
    assert calibrated(wave, "-o", out) == 0
    assert Actuator.named(str(out)).gain_K_per_A2 == pytest.approx(250.0)


def test_kelvins_of_another_actuator_are_refused(wave, tmp_path, capsys):
    out = tmp_path / "measured.toml"
    assert calibrated(wave, "--actuator", "gorbet_one_wire", "-o", out) == 2
    err = capsys.readouterr().err
    assert "made with the actuator 'my_wire', which 1 A heats by 250 K; 'gorbet_one_wire' says 174.1 K" in err
    assert not out.exists()


def test_another_actuator_is_named_where_no_model_depends_on_it(wave, tmp_path, capsys):
    out = tmp_path / "measured.toml"
    run = str(wave / "loop.run.sqlite")
    assert cli(["calibrate", run, "--actuator", "gorbet_one_wire", "-o", str(out)]) == 0
    assert "Warning: the runs were made with the actuator 'my_wire'." in capsys.readouterr().err
