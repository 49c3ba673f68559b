"""Hostile arguments and files: regression tests of inputs that once hung, gave wrong results or destroyed
files."""

import json
import math
import os
import shutil
import signal
import sqlite3
import subprocess
import sys

import pytest

from record.runs import edited
from smarig.cli import run
from smarig.config import load_rig
from smarig.core.errors import InUse, LimitExceeded, UsageError
from smarig.plant.actuator import Actuator
from smarig.record.recorder import Recorder
from smarig.rig.guard import Guard
from smarig.rig.paced_rig import PacedRig
from smarig.rig.twin import Twin
from smarig.runner.run_control import RunControl
from smarig.runner.session import Session


def small_fod(capsys, tmp_path):
    path = tmp_path / "f.run.sqlite"
    partition = ["--set", "partition_K=0,40,90,170"]
    call(capsys, "run", "first_order_descending", "--rig", "one_wire_twin", "-o", path, *partition)
    return path


def call(capsys, *arguments):
    status = run([str(a) for a in arguments])
    out, err = capsys.readouterr()
    assert "Traceback" not in err
    assert "Internal error" not in err
    return status, out, err


@pytest.fixture
def recorded(tmp_path, capsys):
    path = tmp_path / "v.run.sqlite"
    call(capsys, "run", "validation", "--rig", "one_wire_twin", "-o", path, "--set", "points=3")
    return path


def test_a_read_back_that_is_no_number_trips_at_once():
    class Blind:
        period_s, tick, shutdown_unconfirmed = 0.1, 0, ""

        def step(self, current_A, at_most=1):
            return tuple(s._replace(current_A=math.nan) for s in twin.step(current_A, at_most))

        def safe(self):
            twin.safe()

    twin = Twin.named("one_wire_twin")
    guard = Guard(Blind(), load_rig("one_wire_twin").limits, Actuator.named("gorbet_one_wire"))
    guard.step(0.5)
    with pytest.raises(LimitExceeded, match="reads nan"):
        guard.raise_if_tripped()
    assert twin.output_A == 0.0


def test_a_stop_does_not_wait_for_a_slow_tick():
    control = RunControl()
    naps = []

    def sleep(seconds):
        naps.append(seconds)
        control.stop("enough")

    paced = PacedRig(Twin.named("one_wire_twin"), 0.001, lambda: sum(naps), sleep, control.raise_if_stopped)
    with pytest.raises(Exception, match="enough"):
        paced.step(0.1)
    assert naps == [0.1]


@pytest.mark.parametrize("speed", [0.0, 1e-9, math.nan, math.inf, 1e9])
def test_impossible_speeds_are_refused(speed):
    with pytest.raises(UsageError, match="Speed"):
        PacedRig(Twin.named("one_wire_twin"), speed)


@pytest.mark.parametrize(
    "command", [("run", "validation", "--rig", "one_wire_twin"), ("view", "x.run.sqlite")]
)
def test_a_speed_that_is_no_number_is_refused_before_anything_is_opened(capsys, command):
    for speed in ("nan", "inf"):
        status, _, err = call(capsys, *command, "--speed", speed)
        assert status == 2
        assert f"{speed} is not a finite number" in err


@pytest.mark.long("takes five seconds")
@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_a_run_being_recorded_is_not_replaced(tmp_path):
    out = tmp_path / "r.run.sqlite"
    base = [sys.executable, "-m", "smarig", "run", "validation", "--rig", "one_wire_twin", "-o", str(out)]
    first = subprocess.Popen(
        [*base, "--speed", "5"], stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        while first.poll() is None and not recording(out):
            pass
        second = subprocess.run(
            [*base, "--wire", "other", "--force"], capture_output=True, text=True, check=False
        )
    finally:
        first.send_signal(signal.SIGTERM)
        first.communicate(timeout=60)
    assert second.returncode == 5
    assert f"is being recorded by process {first.pid} since" in second.stderr
    assert "(smarig run validation). Wait until it has ended" in second.stderr
    assert first.returncode == 130


def recording(path):
    if not path.exists():
        return False
    try:
        with sqlite3.connect(f"{path.as_uri()}?mode=ro", uri=True) as db:
            return db.execute("SELECT count(*) FROM sample").fetchone()[0] > 0
    except sqlite3.Error:
        return False


@pytest.mark.parametrize("command", ["report", "export", "identify"])
def test_the_output_is_never_the_input(capsys, recorded, command):
    before = recorded.read_bytes()
    extra = {"export": ["--to", "csv"]}.get(command, [])
    status, _, err = call(capsys, command, recorded, *extra, "-o", recorded, "--force")
    assert status == 2
    assert "both input and output" in err
    assert recorded.read_bytes() == before


LONG = pytest.mark.long("takes half a minute")
HUGE = [
    ("validation", "points=1000000000"),
    pytest.param("validation", "points=90000", marks=LONG),
    ("congruency", "points_per_branch=0"),
    ("congruency", "points_per_branch=1000000000"),
    ("minor_loops", "loops=1000000000"),
    ("minor_loops", "loop_s=nan"),
    ("minor_loops", "loop_s=1e9"),
    ("validation", "settle.timeout_s=inf"),
    ("step_currents", "currents_A=-1"),
    ("step_currents", "file=/dev/zero"),
]


@pytest.mark.parametrize(("protocol", "setting"), HUGE)
def test_what_would_never_end_is_refused(capsys, protocol, setting):
    status, _, err = call(capsys, "run", protocol, "--rig", "one_wire_twin", "--dry-run", "--set", setting)
    assert status == 2
    assert err.count("\n") == 1


def test_conflicting_settings_are_refused(capsys):
    both = ["--set", "settle=3", "--set", "settle.window_s=30"]
    assert call(capsys, "run", "validation", "--rig", "one_wire_twin", "--dry-run", *both)[0] == 2


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("period_s = 0.1", "period_s = 1e-9"),
        ("period_s = 0.1", "period_s = 1e300"),
        ("noise_counts = 0.4", "noise_counts = 1e19"),
        ("current_max_A = 1.0", "current_max_A = 0.0"),
        ("saturation_A = 1.0", "saturation_A = 0.5"),
        ("ambient_degC = 22.0", "ambient_degC = -1e8"),
    ],
)
def test_rigs_beyond_physics_are_refused(capsys, tmp_path, old, new):
    from smarig.config import locate

    text = locate("rigs", "one_wire_twin").read_text(encoding="utf-8")
    assert old in text
    file = tmp_path / "rig.toml"
    file.write_text(text.replace(old, new), encoding="utf-8")
    assert call(capsys, "check", file)[0] == 2


@pytest.mark.parametrize(
    "damage",
    [
        "UPDATE run SET value = '\"mm\"' WHERE key = 'output'",
        "UPDATE run SET value = '[1]' WHERE key = 'end'",
        "UPDATE run SET value = '7' WHERE key = 'protocol'",
        "UPDATE step SET position = 'far'",
        "UPDATE step SET target = 'hot'",
    ],
)
def test_damaged_runs_are_data_errors(capsys, recorded, damage):
    with sqlite3.connect(recorded) as db:
        db.execute(damage)
    status, _, err = call(capsys, "report", recorded)
    assert status == 4
    assert "damaged" in err


def test_events_without_words_do_not_stop_a_report(capsys, recorded):
    with edited(recorded) as db:
        db.execute("UPDATE event SET text = NULL, kind = NULL, t_s = NULL")
    assert call(capsys, "report", recorded)[0] == 0


@pytest.mark.parametrize("value", ["1e999", "1e40"])
def test_positions_beyond_all_measure_are_not_identified(capsys, tmp_path, value):
    """What nothing can measure is missing, and with it its curve."""
    fod = small_fod(capsys, tmp_path)
    with edited(fod) as db:
        db.execute(f'UPDATE step SET position = {value} WHERE "index" = 6')
    status, _, err = call(capsys, "identify", fod, "-o", tmp_path / "m.json")
    assert status == 4
    assert "needs at least 4; there are 3" in err


def test_the_same_run_twice_is_refused(capsys, tmp_path, recorded):
    status, _, err = call(capsys, "identify", recorded, recorded, "-o", tmp_path / "m.json")
    assert status == 2
    assert "twice" in err


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("select", ["-(curve==0)", "(curve==0)-(curve==1)", ""])
def test_selections_that_are_no_condition(capsys, tmp_path, select):
    fod = small_fod(capsys, tmp_path)
    assert call(capsys, "identify", fod, "--select", select, "-o", tmp_path / "m.json")[0] == 2


def test_a_tampered_model_is_a_data_error(capsys, tmp_path):
    fod, model = tmp_path / "f.run.sqlite", tmp_path / "m.json"
    words = ("--set", "partition_K=0,40,80,120,170", "-o", fod)
    call(capsys, "run", "first_order_descending", "--rig", "one_wire_twin", *words)
    call(capsys, "identify", fod, "--surface", "exponential", "-o", model)
    good = json.loads(model.read_text(encoding="utf-8"))
    for key, wrong in (("x4", 0), ("x5", -1e308)):
        bad = json.loads(json.dumps(good))
        bad["hysteresis"]["x"][key] = wrong
        model.write_text(json.dumps(bad), encoding="utf-8")
        assert call(capsys, "verify", model, fod)[0] == 4
    good["hysteresis"]["kind"] = []
    model.write_text(json.dumps(good), encoding="utf-8")
    assert call(capsys, "verify", model, fod)[0] == 4


def test_locks_that_cannot_be_created_are_reported(monkeypatch, tmp_path):
    monkeypatch.setenv("SMARIG_LOCK_DIR", os.devnull)
    with Session("one_wire_twin") as session, pytest.raises(UsageError, match="SMARIG_LOCK_DIR"):
        session.run("validation", {"points": "2"}, tmp_path / "a.run.sqlite")
    assert not list(tmp_path.iterdir())


def test_a_preview_can_be_interrupted():
    from smarig.core.errors import Interrupted
    from smarig.runner.preview import preview

    control = RunControl()
    control.stop("enough")
    with pytest.raises(Interrupted, match="enough"):
        preview("validation", load_rig("one_wire_twin"), {}, control)


@pytest.mark.long("takes three seconds")
@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_an_import_does_not_replace_a_run_being_recorded_either(tmp_path):
    from smarig.record.new_run_file import write_run

    out = tmp_path / "r.run.sqlite"
    recording_one = [
        sys.executable,
        "-m",
        "smarig",
        "run",
        "validation",
        "--rig",
        "one_wire_twin",
        "-o",
        str(out),
    ]
    process = subprocess.Popen(
        [*recording_one, "--speed", "5"], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL
    )
    try:
        while process.poll() is None and not recording(out):
            pass
        with pytest.raises(InUse, match=f"being recorded by process {process.pid} since"):
            write_run(out, {}, {"tick": [0]}, [], force=True)
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait(timeout=60)


def test_two_steps_of_a_campaign_need_two_names(capsys, tmp_path):
    plan = tmp_path / "twice.toml"
    step = '[[step]]\nprotocol = "validation"\nset = { points = 2 }\n'
    plan.write_text(f'name = "twice"\nsummary = "s"\n{step}{step}', encoding="utf-8")
    status, _, err = call(capsys, "run", plan, "--rig", "one_wire_twin", "--dry-run")
    assert status == 2
    assert "two steps are called 'validation'" in err
    plan.write_text(f'name = "twice"\nsummary = "s"\n{step}{step}name = "again"\n', encoding="utf-8")
    assert call(capsys, "run", plan, "--rig", "one_wire_twin", "-o", tmp_path / "out", "--quiet")[0] == 0
    assert [p.name for p in sorted((tmp_path / "out").iterdir())] == [
        "01_validation.run.sqlite",
        "02_again.run.sqlite",
    ]


@pytest.mark.long("takes a second")
def test_a_model_path_below_a_file_is_reported(capsys, tmp_path):
    fod = small_fod(capsys, tmp_path)
    (tmp_path / "file").write_text("x", encoding="utf-8")
    status, _, err = call(
        capsys, "identify", fod, "--surface", "constant", "-o", tmp_path / "file" / "m.json"
    )
    assert status == 2
    assert "is not a folder" in err


def test_a_heading_of_20000_characters_is_named_by_its_beginning_and_end(capsys, tmp_path):
    file = tmp_path / "long.csv"
    file.write_text(
        f"time_s,current_A,{'x' * 20_000}\n" + "".join(f"{k},{k % 9},{k % 7}\n" for k in range(40))
    )
    own = ("import", file, "--format", "csv", "--rig", "one_wire_twin", "-o", tmp_path / "l.run.sqlite")
    for command in (own, ("study", file, "-o", tmp_path / "s", "--yes", "--input", "none")):
        status, _, err = call(capsys, *command)
        assert status in (2, 4)
        assert "xxx … xxx" in err
        assert len(err) < 600 + len(str(file))


def test_positions_of_1e_310_are_too_small_in_one_sentence(capsys, tmp_path):
    """Warnings are errors here: one of numpy came before the sentence."""
    file, seconds = tmp_path / "tiny.csv", range(400)
    rows = [f"{k},{0.5 + 0.5 * math.sin(k / 20)},{1e-310 * (3 + math.sin(k / 20 - 0.3))}\n" for k in seconds]
    file.write_text("time_s,current_A,position_mm\n" + "".join(rows))
    status, _, err = call(capsys, "study", file, "-o", tmp_path / "s", "--yes")
    assert (status, err.splitlines()[-1][:52]) == (4, "smarig: A number in these files is too large or too ")


@pytest.mark.skipif(os.name == "nt", reason="an open file cannot be moved")
@pytest.mark.parametrize(
    ("old", "new", "other"),
    [
        ("runs/a.run.sqlite", "runs/b.run.sqlite", False),
        ("runs/a.run.sqlite", "runs/b.run.sqlite", True),
        ("runs", "moved", False),
    ],
)
def test_a_run_whose_file_is_moved_meanwhile_says_so(capsys, tmp_path, monkeypatch, old, new, other):
    """After a step, and then the recorder looks for room on the disk of the folder that is gone. With ``other``,
    another run has its name then, as after a synchronisation of folders.
    """
    step, run_file = Recorder.step, tmp_path / "runs" / "a.run.sqlite"

    def moving_step(self, *given, **others):
        step(self, *given, **others)
        if run_file.exists() and not (tmp_path / new).exists():
            (tmp_path / old).rename(tmp_path / new)
            if other:
                shutil.copy(tmp_path / new, run_file)
            self._check_space()

    monkeypatch.setattr(Recorder, "step", moving_step)
    run_file.parent.mkdir()
    status, _, err = call(
        capsys, "run", "validation", "--rig", "one_wire_twin", "-o", run_file, "--set", "points=3", "--quiet"
    )
    assert status == 4
    assert err.splitlines()[-1] == (
        f"smarig: Run {run_file} was recorded to its end, but its file was renamed, moved, replaced or removed "
        "meanwhile. Look for it under its new name. The current is at zero."
    )
    run_file.unlink(missing_ok=True)
    (found,) = tmp_path.glob("*/?.run.sqlite")
    assert call(capsys, "check", found)[0] == 0
