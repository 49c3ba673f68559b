"""Own protocols, effects and drivers given by path: they run, are recorded, and are loaded only on request."""

import json
import shutil
import sqlite3

import numpy as np
import pytest

import smarig
from control.model_files import model_file
from runner.interrupted import cut
from smarig.cli import run as cli
from smarig.config import locate
from smarig.control.controller_settings import TRACKING_CONTROLLERS
from smarig.core.catalogue import own_files, resolve_name
from smarig.core.errors import UsageError
from smarig.record import load_run
from smarig.runner.resume.resume_run import session_for

PROTOCOL = '''
from smarig.protocols._building_blocks import settle_at
from smarig.core.command import Settled

def two_holds(setup, *, high: float = 0.5):
    """Up and down."""
    yield from settle_at(setup, [setup.at(high), setup.at(0.2)], "mine", Settled(window_s=10))
'''
DRIVER = '''
from smarig.device.drivers.smarig_amplifier import smarig_amplifier

class Shunted:
    """The shipped amplifier, read a little wrong."""
    def __init__(self, source):
        self._source = source
    def __getattr__(self, name):
        return getattr(self._source, name)
    def since(self, tick, at_most):
        return [r._replace(voltage_V=1.01 * r.voltage_V) for r in self._source.since(tick, at_most)]

def shunted(where, rig):
    return Shunted(smarig_amplifier(where, rig))
'''
CONTROLLER = '''
def push(known, wanted, *, gain_K: float = 20.0):
    """Plain proportional action."""
    sample = yield 0.0
    while True:
        error = wanted(sample.t_s) - sample.position
        sample = yield known.setup.current_for(min(max(gain_K * error, 0.0), known.setup.upper_K))
'''
RIG = """
name = "mine"
base = "one_wire_serial"
[links.amplifier]
driver = "./shunted.py"
"""


def call(capsys, *arguments):
    status = cli([str(a) for a in arguments])
    out, err = capsys.readouterr()
    return status, out, err


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "two_holds.py").write_text(PROTOCOL)
    (tmp_path / "push.py").write_text(CONTROLLER)
    (tmp_path / "shunted.py").write_text(DRIVER)
    (tmp_path / "mine.toml").write_text(RIG)
    shutil.copy(locate("rigs", "one_wire_twin"), tmp_path / "twin.toml")
    with own_files():
        yield tmp_path


RUN = ("run", "./two_holds.py", "--rig", "one_wire_twin", "-o", "h.run.sqlite", "--quiet")


@pytest.fixture
def killed(capsys, here):
    assert call(capsys, *RUN)[0] == 0
    run = load_run("h.run.sqlite")
    return cut(run.path, here / "killed.run.sqlite", int(run["tick"][-1]) - 100)


def test_a_run_holds_the_file_that_it_was_made_with(capsys, here):
    with_effect = ["--effect", "creep", "--set", "high=0.3", "--notes", "n"]
    assert call(capsys, *RUN, *with_effect)[0] == 0
    run = load_run("h.run.sqlite")
    assert run.meta["protocol"] == "two_holds"
    assert run.meta["settings"] == {"high": "0.3"}
    (entry,) = run.meta["own_files"]
    assert (entry["kind"], entry["name"], entry["path"]) == (
        "protocol",
        "two_holds",
        str(here / "two_holds.py"),
    )
    assert entry["text"] == PROTOCOL
    assert len(entry["sha256"]) == 64
    assert call(capsys, "run", "validation", *RUN[2:4], "-o", "v.run.sqlite", "--set", "points=2")[0] == 0
    assert load_run("v.run.sqlite").meta["own_files"] == []


def test_check_and_dry_run_take_it_too(capsys, here):
    status, out, _ = call(capsys, "check", "one_wire_twin", "--protocol", "./two_holds.py", "--json")
    assert (status, json.loads(out)["preview"]["steps"]) == (0, 2)
    status, out, _ = call(capsys, *RUN, "--dry-run", "--json")
    assert (status, json.loads(out)["preview"][0]["protocol"]) == (0, "two_holds")


def test_a_notebook_runs_it_by_its_path(here):
    run = smarig.run("./two_holds.py", rig="one_wire_twin", out="n.run.sqlite")
    assert run.meta["own_files"][0]["name"] == "two_holds"


def test_what_fails_in_it_is_reported_with_its_line(capsys, here):
    (here / "two_holds.py").write_text(PROTOCOL.replace('"mine"', "undefined"))
    status, _, err = call(capsys, *RUN)
    assert status == 2
    assert err == "smarig: two_holds.py, line 7: NameError: name 'undefined' is not defined.\n"
    assert not (here / "h.run.sqlite").exists()


def test_resuming_needs_the_same_own_file(capsys, killed, here):
    before = killed.read_bytes()
    status, _, err = call(capsys, "resume", killed.name)
    assert status == 2
    assert f"--protocol {here / 'two_holds.py'}" in err
    (here / "two_holds.py").write_text(PROTOCOL + "# changed\n")
    status, _, err = call(capsys, "resume", killed.name, "--protocol", "./two_holds.py")
    assert status == 2
    assert "has changed since" in err
    assert "validation" in call(capsys, "resume", killed.name, "--protocol", "validation")[2]
    assert killed.read_bytes() == before
    (here / "two_holds.py").write_text(PROTOCOL)
    status, out, _ = call(capsys, "resume", killed.name, "--protocol", "./two_holds.py", "--json")
    found = json.loads(out)
    assert (status, found["cause"], found["start_over"]) == (0, "done", False)


def test_continue_resumes_with_it(capsys, killed):
    arguments = [*RUN[:4], "-o", killed, "--quiet", "--continue"]
    assert call(capsys, *arguments)[0] == 0
    assert load_run(killed).cause == "done"


def test_a_path_in_a_run_is_never_loaded(capsys, killed, here):
    """Whoever sends a run file cannot have a file of ours executed, however they write it."""
    (here / "evil.py").write_text("open('executed', 'w').close()\n")
    for key, value in (
        ("protocol", "./evil.py"),
        ("begun_with", json.dumps(load_run(killed).meta["begun_with"] | {"effects": ["./evil.py=1"]})),
        ("own_files", json.dumps([{"kind": "protocol"}])),
        ("own_files", "3"),
    ):
        changed = shutil.copy(killed, here / "changed.run.sqlite")
        with sqlite3.connect(changed) as db:
            if key != "own_files":
                db.execute("DELETE FROM run WHERE key = 'own_files'")
            text = json.dumps(value) if key == "protocol" else value
            db.execute("INSERT OR REPLACE INTO run (key, value) VALUES (?, ?)", (key, text))
        db.close()
        status, _, err = call(capsys, "resume", changed)
        assert status in (2, 4), key
        assert "Internal" not in err
        assert err.strip().count("\n") <= 1
        assert not (here / "executed").exists()


@pytest.mark.long("takes three seconds")
def test_an_own_effect_is_the_same_over_real_bytes(capsys, here):
    call(capsys, "new", "effect", "soft_mount")
    effect = ["--effect", "./soft_mount.py=5", "--set", "points=2", "--seed", "3", "--quiet"]
    for rig, out in (("one_wire_twin", "a.run.sqlite"), ("one_wire_serial", "b.run.sqlite")):
        assert call(capsys, "run", "validation", "--rig", rig, "-o", out, *effect)[0] == 0
    a, b = load_run("a.run.sqlite"), load_run("b.run.sqlite")
    assert a.meta["effects"] == b.meta["effects"] == ["soft_mount(share_percent=5, time_constant_s=60)"]
    assert (a["counts"] == b["counts"]).all()
    assert [f["kind"] for f in a.meta["own_files"]] == ["effect"]
    killed = cut(a.path, here / "k.run.sqlite", 1500)
    assert "a user's own effect" in call(capsys, "resume", killed)[2]
    assert call(capsys, "resume", killed, "--effect", "./soft_mount.py", "--quiet")[0] == 0


@pytest.mark.long("takes three seconds")
def test_a_rig_file_may_bring_its_driver(capsys, here, monkeypatch):
    (here / "elsewhere").mkdir()
    monkeypatch.chdir(here / "elsewhere")
    arguments = ["run", "validation", "--rig", "../mine.toml", "-o", "d.run.sqlite", "--set", "points=2"]
    assert call(capsys, *arguments, "--quiet")[0] == 0
    run = load_run("d.run.sqlite")
    assert [f["kind"] for f in run.meta["own_files"]] == ["driver"]
    plain = smarig.run("validation", rig="one_wire_twin", out="p.run.sqlite", points=2)
    assert (run["voltage_V"] == 1.01 * plain["voltage_V"]).all()
    killed = cut(run.path, here / "elsewhere" / "k.run.sqlite", 1500)
    status, _, err = call(capsys, "resume", killed)
    assert status == 2
    assert f"names the rig file '{here / 'mine.toml'}', which is not read" in err
    assert err.strip().endswith(
        f"If you trust it, smarig resume k.run.sqlite --rig {here / 'mine.toml'} reads it."
    )
    assert session_for(load_run(killed), rig="../mine.toml").file.name == "mine"


def test_an_own_driver_that_was_edited_is_refused_before_it_is_executed(capsys, here):
    arguments = ["run", "validation", "--rig", "mine.toml", "-o", "d.run.sqlite", "--set", "points=2"]
    assert call(capsys, *arguments, "--quiet")[0] == 0
    killed = cut(load_run("d.run.sqlite").path, here / "k.run.sqlite", 1500)
    before = killed.read_bytes()
    (here / "shunted.py").write_text(DRIVER.replace("1.01", "1.02") + "open('executed', 'w').close()\n")
    status, _, err = call(capsys, "resume", killed, "--rig", "mine.toml", "--quiet")
    assert status == 2
    assert "links.amplifier.driver was 'shunted.py (sha256 " in err
    assert killed.read_bytes() == before
    assert not (here / "executed").exists()
    (here / "shunted.py").write_text(DRIVER)
    assert call(capsys, "resume", killed, "--rig", "mine.toml", "--quiet")[0] == 0


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (None, "There is no file"),
        ("def shunted(where, rig):\n    return object()\n", "lacks arm, close, has_lease, identity"),
        ("def shunted(where, rig):\n    return 1 / 0\n", "shunted.py, line 2: ZeroDivisionError"),
        ("def shunted(where): ...\n", "must be a function shunted(where, rig)"),
    ],
)
def test_a_wrong_driver_is_one_sentence(capsys, here, text, says):
    (here / "shunted.py").unlink()
    if text:
        (here / "shunted.py").write_text(text)
    arguments = ["run", "validation", "--rig", "./mine.toml", "-o", "d.run.sqlite", "--set", "points=2"]
    status, _, err = call(capsys, *arguments, "--quiet")
    assert status == 2
    assert says in err
    assert err.strip().count("\n") == 0


def test_checking_the_file_finds_a_driver_that_is_not_there(capsys, here):
    (here / "shunted.py").unlink()
    status, _, err = call(capsys, "check", "./mine.toml", "--no-current")
    assert status == 2
    assert "links.amplifier.driver: There is no file" in err


@pytest.mark.long("takes three seconds")
def test_a_model_brings_no_driver_and_moves_no_hardware(capsys, here):
    levels = ["--set", "partition_K=0,60,120,174"]
    call(capsys, "run", "first_order_descending", "--rig", "./twin.toml", "-o", "f.run.sqlite", *levels)
    assert call(capsys, "identify", "f.run.sqlite", "--surface", "constant", "-o", "f.model.json")[0] == 0
    model = json.loads((here / "f.model.json").read_text())
    (here / "shunted.py").write_text("open('executed', 'w').close()\n")
    (here / "g.model.json").write_text(json.dumps(model | {"rig": "./mine.toml"}))
    simulate = ["--protocol", "validation", "--set", "points=2", "-o", "s.run.sqlite"]
    status, _, err = call(capsys, "simulate", "g.model.json", *simulate)
    assert status == 2
    assert "g.model.json names the rig file './mine.toml', which is not read" in err
    assert call(capsys, "simulate", "g.model.json", *simulate, "--rig", "bench_one_wire")[0] == 0
    assert load_run("s.run.sqlite").meta["source"] == "simulation"
    assert not (here / "executed").exists()
    (here / "h.model.json").write_text(
        json.dumps(model | {"effects": [{"name": "./shunted.py", "parameters": {}}]})
    )
    status, _, err = call(capsys, "verify", "h.model.json", "f.run.sqlite")
    assert status == 4
    assert "--effect ./FILE.py" in err
    assert not (here / "executed").exists()


def test_a_campaign_distinguishes_two_files_of_one_name(capsys, here):
    (here / "other").mkdir()
    (here / "other" / "two_holds.py").write_text(PROTOCOL)
    step = '[[step]]\nprotocol = "{}"\nname = "{}"\n'
    (here / "c.toml").write_text(
        'name = "c"\nsummary = "Two."\n'
        + step.format("./two_holds.py", "a")
        + step.format("other/two_holds.py", "b")
    )
    status, _, err = call(capsys, "run", "./c.toml", "--rig", "one_wire_twin", "--dry-run")
    assert status == 2
    assert "have the same name" in err


def test_own_effects_are_looked_for_by_name(capsys, here):
    status, _, err = call(capsys, "diagnose", "m.json", "--train", "f.run.sqlite", "--effect", "walking")
    assert status == 2
    assert "is not the file of an effect of your own" in err
    call(capsys, "new", "effect", "soft_mount")
    status, out, _ = call(capsys, "list", "effects", "./soft_mount.py", "--json")
    assert list(json.loads(out)["effects"]) == ["soft_mount"]
    with pytest.raises(UsageError, match="No effect 'soft_mount'"):
        smarig.plant.effect_catalogue.effects_from_pairs(["soft_mount"])


# --- controllers --------------------------------------------------------------------------------------------


@pytest.fixture
def tracked(here):
    """A command that tracks a ramp by a model with an own controller."""
    model = model_file(here, "one_e").name
    ramp = ("--reference", "ramps", "--set", "seconds=20", "--set", "every_s=5")
    return (
        "track",
        model,
        *ramp,
        "--controller",
        "./push.py",
        "--rig",
        "one_wire_twin",
        "-o",
        "t.run.sqlite",
        "--quiet",
    )


def test_a_loop_is_closed_by_an_own_controller_and_the_run_holds_it(capsys, tracked, here):
    status, out, _ = call(capsys, *tracked, "--controller-set", "gain_K=30", "--json")
    assert status == 0
    assert json.loads(out)["track"]["controller"] == "push"
    run = load_run("t.run.sqlite")
    assert (run.meta["settings"]["controller"], run.meta["settings"]["gain_K"]) == ("push", "30.0")
    (entry,) = run.meta["own_files"]
    assert (entry["kind"], entry["name"], entry["path"]) == ("controller", "push", str(here / "push.py"))
    assert entry["text"] == CONTROLLER
    again = smarig.track(
        tracked[1], "ramps", rig="one_wire_twin", out="n.run.sqlite", seconds=20, every_s=5,
        controller="./push.py", numbers={"gain_K": 30},
    )  # fmt: skip
    assert (again["counts"] == run["counts"]).all()
    assert again.meta["own_files"] == run.meta["own_files"]
    soft = smarig.track(
        tracked[1],
        "ramps",
        rig="one_wire_twin",
        out="s.run.sqlite",
        seconds=20,
        every_s=5,
        controller="./push.py",
    )
    assert (soft["counts"] != run["counts"]).any()


def test_a_run_by_a_shipped_controller_holds_no_file(here):
    resolve_name(TRACKING_CONTROLLERS, "./push.py")
    model = model_file(here, "one_e")
    run = smarig.track(model, "ramps", rig="one_wire_twin", out="p.run.sqlite", seconds=5, controller="pi")
    assert run.meta["own_files"] == []


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (None, "There is no file push.py."),
        ("import nowhere\n", "push.py, line 1: ModuleNotFoundError"),
        ("def pull(known, wanted):\n    yield 0.0\n", "the controller must have the file's name"),
        (CONTROLLER.replace("error =", "error = undefined +"), "push.py, line 6: NameError"),
        (CONTROLLER.replace("while True", "for _ in range(3)"), "push.py, line 7: the generator ended"),
        (CONTROLLER.replace("yield 0.0", "yield None"), "push.py, line 4: it must yield currents"),
        (CONTROLLER.replace("yield 0.0", "yield float('nan')"), "push.py, line 4: it commanded nan A"),
        (CONTROLLER.replace("gain_K", "seconds"), "'seconds' has another meaning in the record"),
    ],
)
def test_a_wrong_controller_is_one_sentence_before_anything_flows(capsys, tracked, here, text, says):
    (here / "push.py").unlink()
    if text:
        (here / "push.py").write_text(text)
    status, _, err = call(capsys, *tracked)
    assert status == 2
    assert says in err
    assert err.strip().count("\n") == 0
    assert not (here / "t.run.sqlite").exists()


def test_what_was_measured_before_a_controller_failed_is_kept(capsys, tracked, here):
    """The error occurs only in the run; the preview succeeds."""
    fails = CONTROLLER.replace("def push", "ROUNDS = []\ndef push").replace(
        "    while True:",
        "    ROUNDS.append(0)\n    for k in range(10**6):\n        if len(ROUNDS) == 2 and k == 50: return",
    )
    (here / "push.py").write_text(fails)
    status, _, err = call(capsys, *tracked)
    assert status == 2
    assert "push.py, line 10: the generator ended" in err
    run = load_run("t.run.sqlite")
    assert "the generator ended" in run.cause
    assert run["current_command_A"][-51:].any()
    closed_s = next(e.t_s for e in run.events if e.text == "closed loop")
    assert np.sum(run["t_s"] > closed_s) >= 51


def test_a_path_of_a_controller_in_a_run_is_never_loaded(capsys, tracked, here):
    assert call(capsys, *tracked)[0] == 0
    (here / "push.py").write_text("open('executed', 'w').close()\n")
    for words in (("report", "t.run.sqlite", "-o", "t.html"), ("resume", "t.run.sqlite")):
        call(capsys, *words)
    assert not (here / "executed").exists()


def test_a_driver_that_fails_during_a_run_is_a_fault_of_the_rig(capsys, here):
    """It ends with file and line, with what became of the current, and can be resumed."""
    (here / "shunted.py").write_text(
        DRIVER.replace(
            "        return [r._replace",
            "        if tick > 80:\n            raise OSError(5, 'cut')\n        return [r._replace",
        )
    )
    status, _, err = call(
        capsys, "run", "validation", "--rig", "./mine.toml", "-o", "d.run.sqlite", "--quiet"
    )
    assert status == 3
    assert "shunted.py, line 12: OSError: [Errno 5] cut. The current is at zero." in err
    assert len(load_run("d.run.sqlite")) > 50
