"""An effect on the command line is shown with its strength in the unit of its parameter."""

from smarig.cli import run as cli

RUN = ["run", "step_currents", "--rig", "one_wire_twin", "--set", "currents_A=0.1"]


def test_the_strength_is_shown_with_its_unit(tmp_path, capsys):
    injected = ["--effect", "walking=0.4", "--effect", "settling.time_constant_s=300"]
    assert cli([*RUN, "-o", str(tmp_path / "a.run.sqlite"), *injected]) == 0
    err = capsys.readouterr().err
    assert "Injected into the twin: walking (rate 0.4 %/cycle)" in err
    assert "Injected into the twin: settling (share 2 %, time constant 300 s)" in err
    assert cli([*RUN, "-o", str(tmp_path / "b.run.sqlite"), "--quiet", *injected]) == 0
    assert "Injected" not in capsys.readouterr().err
