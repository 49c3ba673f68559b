"""A resumed run has the table of an uninterrupted run."""

import json
import os
import signal
import sqlite3
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import smarig
from record.runs import edited
from runner.interrupted import cut
from smarig.core.errors import DataError, Interrupted, LeaseExpired, LimitExceeded, UsageError
from smarig.identification.calibration.holds import drive_holds
from smarig.identification.fod_data import fod_data
from smarig.record import CONTINUED, load_run
from smarig.runner.listener import CallbackListener
from smarig.runner.resume.resume_run import resume, resume_in, session_for
from smarig.runner.run_control import RunControl
from smarig.runner.session import Session

RIGS = ("one_wire_twin", "two_wire_twin")
LONG = pytest.mark.long("takes up to three seconds")
PARTITIONS = {"one_wire_twin": "0,65,75,174", "two_wire_twin": "-185,0,60,185"}


@pytest.fixture(scope="session")
def whole(tmp_path_factory):
    """An undisturbed run of each rig."""
    folder = tmp_path_factory.mktemp("whole")
    return {
        rig: smarig.run(
            "first_order_descending",
            rig=rig,
            out=folder / f"{rig}.run.sqlite",
            seed=1,
            wire="a",
            partition_K=PARTITIONS[rig],
        )
        for rig in RIGS
    }


def counts_apart(run, other):
    """The largest difference of two tables, in counts; their inputs are the same."""
    (u, y), (v, z) = run.points(), other.points()
    assert u.tolist() == v.tolist()
    return float(np.abs(y - z).max()) / run.meta["output"]["per_count"]


def events(run, kind):
    return [e for e in run.events if e.kind == kind]


# --- what must come out ------------------------------------------------------------------------------------


@pytest.mark.long(
    "takes three seconds",
    cases=(
        "0.0-one_wire_twin",
        "0.0-two_wire_twin",
        "0.37-one_wire_twin",
        "0.5-two_wire_twin",
    ),
)
@pytest.mark.parametrize(
    ("share", "rig"),
    [
        *((share, "one_wire_twin") for share in (0.0, 0.37, 0.83)),
        *((share, "two_wire_twin") for share in (0.0, 0.5)),
        *(pytest.param(share, "one_wire_twin", marks=LONG) for share in (0.2, 0.5)),
        *(pytest.param(share, "two_wire_twin", marks=LONG) for share in (0.2, 0.37, 0.83)),
    ],
)
def test_a_killed_run_ends_with_the_table_of_a_whole_one(whole, tmp_path, rig, share):
    tick = max(1, round(share * len(whole[rig])))
    run = resume(cut(whole[rig].path, tmp_path / "r.run.sqlite", tick))
    assert run.cause == "done"
    assert counts_apart(run, whole[rig]) < 1
    assert len(fod_data(run)) == len(fod_data(whole[rig]))
    assert [(s.branch, s.target) for s in run.settled] == [(s.branch, s.target) for s in whole[rig].settled]


@pytest.mark.long("takes a second", cases=("two_wire_twin",))
@pytest.mark.parametrize("rig", RIGS)
def test_the_record_shows_what_happened(whole, tmp_path, rig):
    tick = len(whole[rig]) // 2
    before = load_run(cut(whole[rig].path, tmp_path / "r.run.sqlite", tick))
    run = resume(before.path)
    assert (np.diff(run["tick"]) > 0).all()
    assert (np.diff(run["t_s"]) > 0).all()
    assert np.allclose(run["t_s"], run["tick"] * run.meta["period_s"])
    interrupted = next(s for s in run.steps if s.verdict == "interrupted")
    assert (interrupted.void, interrupted.position, interrupted.target is None) == (True, None, False)
    assert interrupted.n == np.sum(before["step"] == interrupted.index)
    assert interrupted.t_end_s == before["t_s"][-1]
    back = [s for s in run.steps if s.branch == "re-establish"]
    assert all(s.void and s.target is None for s in back)
    again = next(s for s in run.steps if s.attempt)
    assert (again.branch, again.target, again.attempt) == (interrupted.branch, interrupted.target, 1)
    assert [s.index for s in run.steps] == list(range(len(run.steps)))  # a number is one stretch of samples
    assert [s.t_start_s for s in run.steps] == sorted(s.t_start_s for s in run.steps)
    assert "never closed" in events(run, "interrupted")[0].data["cause"]
    event = events(run, "resumed")[0]
    assert event.data["holds"] == len(back)
    assert run["current_command_A"][before["tick"].size] == 0.0  # the wire is cooled first
    assert len(before) not in [h.begin for h in drive_holds(run)], "nobody saw how it cooled"
    columns = [np.array_equal(before[c], run[c][: len(before)], equal_nan=True) for c in before.columns]
    assert all(columns), "what was measured stays as it is"


@pytest.mark.long("takes a second")
def test_void_steps_teach_nothing(whole, tmp_path):
    run = resume(cut(whole["one_wire_twin"].path, tmp_path / "r.run.sqlite", 4000))
    model = smarig.identify(run, surface="constant").model
    with edited(run.path) as db:
        changed = db.execute("UPDATE step SET position = 1000, target = 50 WHERE void").rowcount
    assert changed >= 4
    spoilt = smarig.identify(load_run(run.path), surface="constant").model
    assert (spoilt.fit["points"], spoilt.fit["rms"]) == (model.fit["points"], model.fit["rms"])
    undisturbed = smarig.identify(whole["one_wire_twin"], surface="constant").model
    assert model.fit["points"] == undisturbed.fit["points"]


@pytest.mark.long("takes three seconds")
def test_a_run_can_be_interrupted_again_and_during_restoration(whole, tmp_path):
    path = cut(whole["two_wire_twin"].path, tmp_path / "a.run.sqlite", 5000)
    once = resume(path)
    on_the_way = next(s for s in once.steps if s.branch == "re-establish" and s.t_start_s > 550)
    path = cut(path, tmp_path / "b.run.sqlite", round(10 * on_the_way.t_end_s) - 20)
    twice = resume(path)
    marked = [(s.branch, s.void) for s in twice.steps if s.verdict == "interrupted"]
    assert ("re-establish", True) in marked
    assert max(s.attempt for s in twice.steps) == 1, "a way back is no attempt at a step"
    path = cut(
        path, tmp_path / "c.run.sqlite", round(10 * next(s for s in twice.steps if s.attempt).t_end_s) - 20
    )
    thrice = resume(path)
    assert max(s.attempt for s in thrice.steps) == 2
    assert counts_apart(thrice, whole["two_wire_twin"]) < 1


def test_a_run_that_was_killed_at_its_very_end_is_only_closed(whole, tmp_path):
    path = cut(whole["one_wire_twin"].path, tmp_path / "r.run.sqlite", len(whole["one_wire_twin"]))
    run = resume(path)
    assert (len(run), run.cause) == (len(whole["one_wire_twin"]), "done")
    assert "all steps were already finished" in events(run, "resumed")[0].text


# --- endings that are not death ---------------------------------------------------------------------------------


def stop_at(tick, control):
    return CallbackListener(on_sample=lambda s, step, u: control.stop("enough") if s.tick == tick else None)


@pytest.mark.long("takes a second", cases=("two_wire_twin",))
@pytest.mark.parametrize("rig", RIGS)
def test_a_stopped_run_resumes_in_the_same_session(whole, tmp_path, rig):
    """The same device: its ticks and its zero continue, and the wire has gone through the whole input."""
    control = RunControl()
    out = tmp_path / "r.run.sqlite"
    with Session(rig, seed=1, wire="a", control=control) as session:
        with pytest.raises(Interrupted):
            session.run(
                "first_order_descending",
                {"partition_K": PARTITIONS[rig]},
                out,
                listeners=[stop_at(4000, control)],
            )
        control._stop_cause = ""
        resume_in(session, load_run(out))
    run = load_run(out)
    assert run["tick"].tolist() == list(range(1, len(run) + 1))
    assert counts_apart(run, whole[rig]) < 1
    assert events(run, "interrupted")[0].data["cause"] == "enough"


def test_a_trip_is_re_armed(whole, tmp_path):
    out = tmp_path / "r.run.sqlite"
    with Session("one_wire_twin", seed=1, wire="a") as session:

        def silence(s, step, u):
            if s.tick == 4000:
                session.rig.idle(5.0)

        with pytest.raises(LeaseExpired):
            session.run(
                "first_order_descending",
                {"partition_K": PARTITIONS["one_wire_twin"]},
                out,
                listeners=[CallbackListener(on_sample=silence)],
            )
        assert "no command from the host" in load_run(out).cause
        resume_in(session, load_run(out))
    run = load_run(out)
    assert run.cause == "done"
    assert counts_apart(run, whole["one_wire_twin"]) < 1
    assert run["tick"][4000] > 4001  # the ticks of the pause are missing and not recorded as samples


def test_a_limit_that_tripped_is_re_armed(tmp_path):
    out = tmp_path / "r.run.sqlite"
    with Session("one_wire_twin") as session:
        session.guard.tripped = "Something was too hot."
        with pytest.raises(LimitExceeded):
            session.run("validation", {"points": "2"}, out)
        resume_in(session, load_run(out))
    assert load_run(out).cause == "done"


# --- the encoder's zero --------------------------------------------------------------------------------------------


def zeroed_hot(rig, out):
    """A run whose encoder was zeroed on a hot wire before."""
    with Session(rig, seed=1, wire="a") as session:
        for _ in range(600):
            session.guard.step(0.9)
        session.guard.zero()
        session._note_zero("zero", 60.0)
        for _ in range(600):
            session.guard.step(0.0)
        session.run("first_order_descending", {"partition_K": PARTITIONS[rig]}, out)
    return load_run(out)


@pytest.mark.long("takes three seconds", cases=("two_wire_twin",))
@pytest.mark.parametrize("rig", RIGS)
def test_a_lost_encoder_zero_is_recovered(whole, tmp_path, rig):
    """The encoder was zeroed on a hot wire before the run; the new twin's zero is another."""
    out, r = tmp_path / "whole.run.sqlite", tmp_path / "r.run.sqlite"
    undisturbed = zeroed_hot(rig, out)
    assert undisturbed["counts"].min() < -100
    run = resume(cut(out, r, int(undisturbed["tick"][0]) + 4000))
    assert counts_apart(run, undisturbed) < 1
    assert run.meta["shift"]["counts"] == events(run, "shift")[0].data["counts"]
    event = events(run, "shift")[0]
    assert abs(event.data["counts"]) > 50
    cooled = next(s for s in run.steps if s.branch == "re-establish")
    rows = run["step"] == cooled.index
    assert cooled.position == pytest.approx(np.mean(run["position"][rows][-cooled.n :]))
    assert cooled.position < -50 * run.meta["output"]["per_count"], (
        "the way there is told in the old zero, too"
    )


@pytest.mark.long("takes two seconds")
def test_an_encoder_zero_not_recovered_before_the_next_kill_is_recovered_later(whole, tmp_path):
    """Killed on the way back: the device is the same the second time, and its zero is still unknown."""
    rig, out, path = "one_wire_twin", tmp_path / "whole.run.sqlite", tmp_path / "r.run.sqlite"
    undisturbed = zeroed_hot(rig, out)
    cut(out, path, int(undisturbed["tick"][0]) + 4000)
    control = RunControl()
    with session_for(load_run(path), control=control) as session:
        with pytest.raises(Interrupted):
            resume_in(session, load_run(path), listeners=[stop_at(len(load_run(path)) + 1900, control)])
        assert not events(load_run(path), "shift")
        control._stop_cause = ""
        resume_in(session, load_run(path))
    assert counts_apart(load_run(path), undisturbed) < 1
    assert len(events(load_run(path), "shift")) == 1


def test_an_encoder_zero_that_cannot_be_recovered_is_a_refusal(tmp_path):
    out, r = tmp_path / "whole.run.sqlite", tmp_path / "r.run.sqlite"
    with Session("one_wire_twin", wire="a") as session:
        session._note_zero("zero", 60.0)
        session.guard.step(0.0)
        session.run("step_currents", {"temperatures_K": "60,100,70"}, out)
    path = cut(out, r, 1200)
    before = path.read_bytes()
    with pytest.raises(DataError, match="zero of the encoder is lost"):
        resume(path)
    assert path.read_bytes() == before


# --- starting again
# ------------------------------------------------------------------------------------------


def test_an_interrupted_waveform_restarts_the_protocol(tmp_path):
    whole = smarig.run("minor_loops", rig="one_wire_twin", out=tmp_path / "w.run.sqlite", wire="a")
    run = resume(cut(whole.path, tmp_path / "r.run.sqlite", len(whole) // 2))
    assert events(run, "resumed")[0].data["start_over"]
    assert [s.void for s in run.steps] == [True, True, True, True, False, False, False]
    assert [(s.branch, s.attempt) for s in run.steps[4:]] == [("cool", 1), ("loops", 1), ("cool", 0)]
    last = whole["position"][-100:].mean(), run["position"][-100:].mean()
    assert last[0] == pytest.approx(last[1], abs=run.meta["output"]["per_count"])


@pytest.mark.long("takes three seconds")
def test_a_memory_that_cannot_be_restored_restarts_the_protocol(tmp_path):
    """Two wires, never saturated: what they remember hangs on where they began."""
    settings = {"temperatures_K": "50,-30,40,-20"}
    control = RunControl()
    out = tmp_path / "r.run.sqlite"
    with Session("two_wire_twin", control=control) as session:
        with pytest.raises(Interrupted):
            session.run("step_currents", settings, out, listeners=[stop_at(1500, control)])
        control._stop_cause = ""
        plan = resume_in(session, load_run(out))
    run = load_run(out)
    assert plan.start_over
    assert run.meta["initial"] == CONTINUED
    assert [s.target for s in run.settled] == [50.0, -30.0, 40.0, -20.0]
    whole = smarig.run(
        "step_currents", rig="two_wire_twin", out=tmp_path / "w.run.sqlite", wire="a", **settings
    )
    again = resume(cut(whole.path, tmp_path / "r2.run.sqlite", 1500))  # a new twin is in the old state
    assert not events(again, "resumed")[0].data["start_over"]
    assert counts_apart(again, whole) < 1


@pytest.mark.long("takes three seconds")
def test_a_chooser_called_again_gives_the_same_choice(tmp_path):
    whole = smarig.run("adaptive_fod", rig="one_wire_twin", out=tmp_path / "w.run.sqlite", longest_h=0.4)
    run = resume(cut(whole.path, tmp_path / "r.run.sqlite", 8000))
    n = min(len(run.settled), len(whole.settled))
    assert [s.target for s in run.settled[:n]] == [s.target for s in whole.settled[:n]]
    assert sum(e.text == "chosen" for e in run.events) <= sum(e.text == "chosen" for e in whole.events)


# --- refusals ------------------------------------------------------------------------------------------------------


def test_refusals_are_one_sentence_and_touch_nothing(whole, tmp_path):
    done = whole["one_wire_twin"]
    path = cut(done.path, tmp_path / "r.run.sqlite", 4000)
    before = path.read_bytes()
    other = tmp_path / "other.toml"
    text = Path("configs/rigs/one_wire_twin.toml").read_text(encoding="utf-8")
    other.write_text(text.replace('name = "one_wire_twin"', 'name = "elsewhere"'), encoding="utf-8")
    for refused, sentence in (
        (lambda: resume(done.path), "is finished"),
        (lambda: resume(path, rig="two_wire_twin"), "was run on rig 'one_wire_twin', not on 'two_wire_twin'"),
        (lambda: resume(path, rig=str(other)), "not on 'elsewhere'"),
        (lambda: resume(path, wire="b"), "belongs to wire 'a', not to 'b'"),
    ):
        with pytest.raises(UsageError, match=sentence):
            refused()
    assert path.read_bytes() == before


def test_a_wire_that_was_changed_in_the_rig_file_is_refused(tmp_path):
    rig = tmp_path / "mine.toml"
    text = Path("configs/rigs/one_wire_twin.toml").read_text(encoding="utf-8")
    rig.write_text(text, encoding="utf-8")
    run = smarig.run("validation", rig=str(rig), out=tmp_path / "w.run.sqlite", points=2)
    path = cut(run.path, tmp_path / "r.run.sqlite", 900)
    rig.write_text(text.replace("twin-one-wire", "a-new-wire"), encoding="utf-8")
    with pytest.raises(UsageError, match="belongs to wire 'twin-one-wire', not to 'a-new-wire'"):
        resume(path, rig=str(rig))


def test_an_actuator_may_be_a_file_of_ones_own(tmp_path):
    actuator, rig = tmp_path / "wire.toml", tmp_path / "mine.toml"
    actuator.write_text(Path("configs/actuators/gorbet_one_wire.toml").read_text("utf-8"), encoding="utf-8")
    rig.write_text(f'name = "mine"\nbase = "one_wire_twin"\nactuator = "{actuator}"\n', encoding="utf-8")
    run = smarig.run("validation", rig=str(rig), out=tmp_path / "w.run.sqlite", points=2)
    assert resume(cut(run.path, tmp_path / "r.run.sqlite", 900), rig=str(rig)).cause == "done"
    actuator.write_text(
        actuator.read_text("utf-8").replace('"gorbet_one_wire"', '"another"'), encoding="utf-8"
    )
    with pytest.raises(UsageError, match="on actuator 'gorbet_one_wire', not on 'another'"):
        resume(cut(run.path, tmp_path / "s.run.sqlite", 900), rig=str(rig))


def test_a_protocol_that_differs_from_its_record_is_refused(tmp_path):
    rig = tmp_path / "mine.toml"
    text = Path("configs/rigs/one_wire_twin.toml").read_text(encoding="utf-8")
    rig.write_text(text, encoding="utf-8")
    run = smarig.run("validation", rig=str(rig), out=tmp_path / "w.run.sqlite", points=3)
    path = cut(run.path, tmp_path / "r.run.sqlite", 1900)
    rig.write_text(text.replace("current_max_A = 1.0", "current_max_A = 0.9"), encoding="utf-8")
    with pytest.raises(DataError, match="have changed"):
        resume(path, rig=str(rig))


@pytest.mark.parametrize(
    "damage",
    [
        "UPDATE sample SET counts = NULL",
        "UPDATE sample SET counts = 9e999 WHERE tick = 700",
        "UPDATE sample SET t_s = NULL WHERE tick = 700",
        "UPDATE sample SET t_s = 1 WHERE tick = 700",
        "UPDATE sample SET tick = 9223372036854775807 WHERE tick = 700",
        "UPDATE step SET n = -5",
    ],
)
def test_a_run_with_damaged_samples_is_not_resumed(whole, tmp_path, damage):
    path = cut(whole["one_wire_twin"].path, tmp_path / "r.run.sqlite", 4000)
    with sqlite3.connect(path) as db:
        db.execute(damage)
    db.close()
    before = path.read_bytes()
    with pytest.raises(DataError, match="(?i)the record is damaged"):
        resume(path)
    assert path.read_bytes() == before


def with_another_current(path, first, last):
    """Set the commanded current of these samples of the third step to 0.123 A."""
    with sqlite3.connect(path) as db:
        rows = [r for (r,) in db.execute("SELECT tick FROM sample WHERE step = 2 ORDER BY tick")]
        db.execute(
            "UPDATE sample SET current_command_A = 0.123 WHERE tick BETWEEN ? AND ?",
            (rows[first], rows[last]),
        )
    db.close()
    return path


def test_a_host_that_was_late_read_samples_of_the_current_before(whole, tmp_path):
    path = cut(whole["one_wire_twin"].path, tmp_path / "r.run.sqlite", 4000)
    assert resume(with_another_current(path, 0, 3)).cause == "done"


@pytest.mark.parametrize(("first", "last"), [(5, 9), (-3, -1), (0, -1)])
def test_another_current_within_a_step_is_refused_and_reported(whole, tmp_path, first, last):
    path = cut(whole["one_wire_twin"].path, tmp_path / "r.run.sqlite", 4000)
    with pytest.raises(DataError, match=r"step 2 was .*0\.123.* A, but its protocol now commands"):
        resume(with_another_current(path, first, last))


@pytest.mark.parametrize(
    ("key", "value"),
    [("begun_with", '{"rig": 1}'), ("begun_with", "[]"), ("seed", "[3]"), ("settings", "7")],
)
def test_a_damaged_description_is_a_sentence(whole, tmp_path, key, value):
    path = cut(whole["one_wire_twin"].path, tmp_path / "r.run.sqlite", 4000)
    with sqlite3.connect(path) as db:
        if key == "settings":
            changed = json.dumps(load_run(path).meta["begun_with"] | {"settings": 7})
            key, value = "begun_with", changed
        db.execute("INSERT OR REPLACE INTO run VALUES (?, ?)", (key, value))
    db.close()
    with pytest.raises(DataError, match=r"damaged|does not state"):
        resume(path)


def test_settings_given_as_values_are_kept(tmp_path):
    run = smarig.run(
        "step_currents", rig="one_wire_twin", out=tmp_path / "w.run.sqlite", temperatures_K=(60.0, 20.0, 40.0)
    )
    resumed = resume(cut(run.path, tmp_path / "r.run.sqlite", 1000))
    assert counts_apart(resumed, run) < 1
    assert session_for(load_run(cut(run.path, tmp_path / "s.run.sqlite", 1000))).wire == "twin-one-wire"


# --- real death ----------------------------------------------------------------------------------------------------


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
@pytest.mark.parametrize("rig", ["one_wire_twin", pytest.param("two_wire_twin", marks=LONG)])
def test_after_kill_9(whole, tmp_path, rig):
    out = tmp_path / "r.run.sqlite"
    command = [sys.executable, "-m", "smarig", "run", "first_order_descending", "--rig", rig, "--seed", "1"]
    process = subprocess.Popen(
        [
            *command,
            "-o",
            str(out),
            "--set",
            f"partition_K={PARTITIONS[rig]}",
            "--wire",
            "a",
            "--speed",
            "200",
        ],
        env=os.environ | {"OMP_NUM_THREADS": "1"},
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        while process.poll() is None and _steps(out) < 3:
            pass
    finally:
        process.kill()
        process.communicate()
    assert process.returncode == -signal.SIGKILL
    assert not load_run(out).complete
    with session_for(load_run(out), speed=1e6) as session:
        resume_in(session, load_run(out))
    assert counts_apart(load_run(out), whole[rig]) < 1


def _steps(out):
    try:
        return len(load_run(out).steps)
    except (DataError, UsageError):
        return 0
