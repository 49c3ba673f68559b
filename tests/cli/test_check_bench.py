"""``smarig check`` on a bench: a checklist to sign, and an exit status that shows the result."""

import io
import json
import signal

import pytest

from smarig.cli import run as cli


def rig(tmp_path, name="one_wire_serial", **simulator):
    path = tmp_path / "bench.toml"
    lines = [f'{key} = "{value}"' for key, value in simulator.items()]
    path.write_text(
        "\n".join([f'name = "bench"\nbase = "{name}"\nwire = "check"\n[simulator]', *lines]) + "\n"
    )
    return str(path)


@pytest.mark.long("takes two seconds", cases=("two_wire_modbus_rtu",))
@pytest.mark.parametrize("name", ["one_wire_serial", "two_wire_modbus_rtu"])
def test_a_sound_bench_passes_every_check(name, tmp_path, capsys):
    assert cli(["check", rig(tmp_path, name), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    pulse = ["read-back", "resistance", "encoder direction", "encoder scale"]
    second = [f"{check}, wire 2" for check in pulse] if name.startswith("two") else []
    assert [c["name"] for c in found["checks"]] == ["devices", "at rest", *pulse, *second, "lease", "re-arm"]
    assert all(c["passed"] for c in found["checks"])
    assert "hash" in found["checks"][0]["seen"]


@pytest.mark.parametrize(
    ("fault", "check"),
    [
        ('kind = "open_wire"\n', "rig"),
        ('kind = "stuck_encoder"\n', "encoder direction"),
        ('kind = "drifting_shunt"\ngain_per_s = 0.02\n', "rig"),
        ('kind = "low_shunt"\nfactor = 1.2\n', "rig"),
    ],
)
def test_a_bench_that_is_not_fails_the_check_that_sees_it(fault, check, tmp_path, capsys):
    faults = tmp_path / "faults.toml"
    faults.write_text(f"[[fault]]\n{fault}")
    assert cli(["check", rig(tmp_path, faults=faults), "--json"]) == 3
    found = json.loads(capsys.readouterr().out)
    assert found["error"], "in the one object"
    assert check in [c["name"] for c in found["checks"] if not c["passed"]]


@pytest.mark.long("takes three seconds")
@pytest.mark.parametrize("more", [["--json"], []])
def test_a_device_that_is_lost_does_not_hide_the_checks_before(more, tmp_path, capsys):
    """Its shutdown is not confirmed either, which is said once, in the last check."""
    faults = tmp_path / "faults.toml"
    faults.write_text('[[fault]]\nkind = "unplugged"\ndevice = "amplifier"\nfrom_s = 40\n')
    assert cli(["check", rig(tmp_path, faults=faults), *more]) == 3
    out, err = capsys.readouterr()
    if more:
        checks = json.loads(out)["checks"]  # one object
        assert [(c["name"], c["passed"]) for c in checks] == [
            ("devices", True),
            ("at rest", True),
            ("rig", False),
        ]
        last = checks[-1]["seen"]
    else:
        rows = [line for line in out.splitlines() if line.startswith("[")]
        assert [row.split(":")[0] for row in rows[:3]] == ["[x] devices", "[x] at rest", "[ ] rig"]
        last = rows[2]
    assert "The amplifier cannot be reached." in last
    assert last.count("did not confirm that it switched off") == 1
    assert "did not confirm that it switched off" in err.splitlines()[-1]


def test_an_error_of_a_driver_does_not_hide_them_either(tmp_path, capsys, monkeypatch):
    def broken(bench, current_A, at_most=1):
        raise ValueError("no such channel")

    monkeypatch.setattr("smarig.rig.stoppable_bench.Bench.step", broken)
    assert cli(["check", rig(tmp_path), "--json"]) != 0
    checks = json.loads(capsys.readouterr().out)["checks"]
    assert [(c["name"], c["passed"]) for c in checks] == [("devices", True), ("rig", False)]
    assert "no such channel" in checks[-1]["seen"]


def test_a_forced_stop_does_not_promise_a_shutdown_that_was_not_confirmed(tmp_path, capsys, monkeypatch):
    """A second Ctrl-C, at a device that does not answer."""

    def stuck(bench, current_A, at_most=1):
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)

    def not_confirmed(shutdown):
        shutdown.unconfirmed = "The amplifier did not confirm."

    monkeypatch.setattr("smarig.runner.signal_handling.INSISTS_S", 0.0)
    monkeypatch.setattr("smarig.rig.stoppable_bench.Bench.step", stuck)
    monkeypatch.setattr("smarig.rig.source_shutdown.SourceShutdown.order_off", not_confirmed)
    assert cli(["check", rig(tmp_path)]) == 130
    out, err = capsys.readouterr()
    sentence = "The check was interrupted by the keyboard (Ctrl-C). The amplifier did not confirm."
    assert f"[ ] rig: {sentence}" in out
    assert err.splitlines()[-1] == f"smarig: {sentence}"


def test_hardware_is_not_heated_without_confirmation(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("smarig.cli.rig_bring_up.open_rig", None)
    path = tmp_path / "hard.toml"
    path.write_text('name = "hard"\nbase = "bench_one_wire"\n')
    assert cli(["check", str(path), "--no-current"]) == 2
    assert "links.amplifier.url is the placeholder of the template" in capsys.readouterr().err
    with path.open("a") as file:
        file.writelines(f'links.{name}.url = "/dev/absent-{name}"\n' for name in ("amplifier", "encoder_daq"))
    for answer in ("n\n", ""):
        monkeypatch.setattr("sys.stdin", io.StringIO(answer))
        assert cli(["check", str(path)]) == 2
        assert "Nothing was done. Give --yes to skip the question" in capsys.readouterr().err
    assert cli(["check", str(path), "--no-current"]) == 0
    assert "input_range_K" in capsys.readouterr().out


def test_a_make_is_that_of_a_supply(tmp_path, capsys):
    assert cli(["check", rig(tmp_path, make="rigol_dp800"), "--yes"]) == 2
    assert "simulator.make is the make of a supply. Omit it" in capsys.readouterr().err


def test_a_preview_of_a_bench_drives_no_current_unless_asked(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("smarig.cli.rig_bring_up.open_rig", None)
    path = tmp_path / "hard.toml"
    urls = "".join(f'links.{name}.url = "/dev/absent-{name}"\n' for name in ("amplifier", "encoder_daq"))
    path.write_text(f'name = "hard"\nbase = "bench_one_wire"\nwire = "preview"\n{urls}')
    preview = ["check", str(path), "--protocol", "initialise"]
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    assert cli(preview) == 0
    out, err = capsys.readouterr()
    assert "initialise: 0.02 h, 2 steps" in out
    assert "No current was driven. To bring the bench up as well, add --bring-up." in out
    assert "heated" not in err
    monkeypatch.setattr("sys.stdin", io.StringIO("n\n"))
    assert cli([*preview, "--bring-up"]) in (2, 130)
    assert "The wire of hard will be heated gently" in capsys.readouterr().err
    assert cli([*preview, "--bring-up", "--no-current"]) == 2


@pytest.mark.parametrize("campaign", ["quick_look", "./mine.toml"])
def test_a_campaign_is_not_previewed_by_a_check_which_says_by_what(campaign, capsys):
    assert cli(["check", "one_wire_twin", "--protocol", campaign]) == 2
    remedy = f"smarig run {campaign} --rig one_wire_twin --dry-run"
    assert f"{campaign} is a campaign, which runs several protocols. Preview it with: {remedy}" in (
        capsys.readouterr().err
    )


LASER = """
from smarig.device import Silent
class Laser:
    identity, unit = "laser", "{unit}"
    def position(self):
        return 3.25
    def close(self):
        pass
def a_{unit}_laser(where, rig):
    if where.url != "laser":
        raise Silent("There is none. Check its power, the cable and the port.")
    return Laser()
"""


BLIND = """
import math
from smarig.device import Electrical
class Blind:
    identity, tripped, has_lease = "blind", "", False
    def arm(self): pass
    def set_current(self, current_A): pass
    def measure(self): return Electrical(math.nan, 1.0)
    def off(self): return ""
    def close(self): pass
def blind(where, rig):
    return Blind()
"""


def test_a_driver_that_measures_no_current_gets_one_line(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "blind.py").write_text(BLIND)
    assert cli(["check", "--driver", "./blind.py", "--url", "anywhere", "--yes"]) == 3
    out, err = capsys.readouterr()
    (line,) = [line for line in err.splitlines() if line.startswith("NOT")]
    assert "the driver measures no current" in line
    assert "1 of 13 requirements are met.\nThe last 11 were not tested." in out


@pytest.mark.long("takes three seconds")
def test_a_position_in_mm_is_checked_without_a_rig_file(tmp_path, capsys, monkeypatch):
    """It does not demand that a shipped file be changed."""
    monkeypatch.chdir(tmp_path)
    for unit in ("mm", "deg"):
        (tmp_path / f"a_{unit}_laser.py").write_text(LASER.format(unit=unit))
    command = ["check", "--role", "encoder_daq", "--url", "laser"]
    assert cli([*command, "--driver", "./a_mm_laser.py"]) == 0
    out = capsys.readouterr().out
    assert "6 of 6 requirements are met" in out
    assert "Its sign and its unit are checked with heat" in out
    assert "for those of your bench: smarig check RIG --driver" in out
    assert cli([*command, "--driver", "./a_deg_laser.py"]) == 2
    assert "Name a rig whose wire moves in deg." in capsys.readouterr().err
    (tmp_path / "mine.toml").write_text('name = "mine"\nbase = "bench_one_wire"\nwire = "laser"\n')
    assert cli([*command, "--driver", "./a_mm_laser.py", "--rig", "./mine.toml"]) == 2
    assert "Give encoder.resolution in the file of rig 'mine'" in capsys.readouterr().err
