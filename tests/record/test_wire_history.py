"""A wire's history: what is counted, the sum over runs, and the limit of cycles; none for a twin.

A history needs devices that outlive the session: simulated ones, which this module starts once.
"""

import json

import pytest

import smarig
from runner.interrupted import cut
from runner.lasting_devices import rig_file, started
from smarig.core.errors import DataError, Interrupted, LimitExceeded
from smarig.record.last_heat import LastHeat
from smarig.record.wire_history import Wear, WireHistory, load_wire_history, wire_histories
from smarig.runner.listener import CallbackListener
from smarig.runner.resume.resume_run import resume
from smarig.runner.run_control import RunControl
from smarig.runner.session import Session

WIRE = "lasting"
LOOPS = {
    "points_per_branch": 2,
    "high": 0.45,
}  # a short congruency: one cycle, by its peak; no hold at half the range
HOT_TICK = 4700  # of its 10,000: in the first hold above half of the range


@pytest.fixture(autouse=True)
def _empty(tmp_path, monkeypatch):
    monkeypatch.setenv("SMARIG_HISTORY_DIR", str(tmp_path / "wires"))


@pytest.fixture(scope="module")
def urls():
    with started() as found:
        yield found


@pytest.fixture
def rig(tmp_path, urls) -> str:
    return str(rig_file(tmp_path / "rig.toml", urls, wire=WIRE))


def of(wire=WIRE):
    return load_wire_history(wire, twin=True)


def test_what_is_counted():
    wear = Wear(range_K=100.0, period_s=360.0)
    for tick, u in enumerate([0, 60, 40, 60, 20, -70, 51, 49, 0], start=1):
        wear.add(tick, float(u))
    # 40 is no rest: 60, 40, 60 is one cycle; −70 after 20 is another (the other wire of the pair)
    assert wear.cycles == 2
    assert wear.hours_hot == pytest.approx(4 * 0.1)
    assert wear.dose_K_h == pytest.approx((60 + 60 + 70 + 51) * 0.1)
    assert (wear.largest_input_K, wear.last_tick) == (70.0, 9)


@pytest.mark.long("takes three seconds")
def test_it_adds_up_over_runs_and_stands_in_their_records(tmp_path, rig):
    first = smarig.run("congruency", rig=rig, out=tmp_path / "a.run.sqlite", **LOOPS)
    one = of()
    smarig.run("congruency", rig=rig, out=tmp_path / "b.run.sqlite", **LOOPS)
    two = of()
    assert (one.runs, one.cycles, two.runs, two.cycles) == (1, 1, 2, 2)
    assert two.hours_hot == pytest.approx(2 * one.hours_hot, rel=0.02)
    assert one.largest_input_K == pytest.approx(0.9 * 174.1, abs=0.2)
    assert first.meta["wire_history"].startswith("0 runs")
    assert smarig.load_run(tmp_path / "b.run.sqlite").meta["wire_history"] == one.sentence()
    assert [h.wire for h in wire_histories()] == [WIRE]


@pytest.mark.long("takes three seconds")
def test_an_interrupted_run_counts_once_however_it_ended(tmp_path, rig):
    whole = smarig.run("congruency", rig=rig, out=tmp_path / "a.run.sqlite", **LOOPS)
    undisturbed = of()
    path = cut(whole.path, tmp_path / "killed.run.sqlite", int(whole["tick"][0]) + HOT_TICK)
    resume(path, rig=rig)
    after = of()
    assert after.runs == 2
    assert after.cycles == 2 + 1, "the peak was reached before death, and once more on the way back or later"
    assert after.hours_hot > 2.07 * undisturbed.hours_hot, "hot before death: a fifth of the whole run"
    control = RunControl()
    with Session(rig, control=control) as session:
        last = session.rig.tick + HOT_TICK
        stop = CallbackListener(on_sample=lambda s, *_: control.stop("enough") if s.tick == last else None)
        with pytest.raises(Interrupted):
            session.run("congruency", LOOPS, tmp_path / "stopped.run.sqlite", listeners=[stop])
    stopped = of()
    assert (stopped.runs, stopped.cycles) == (3, after.cycles + 1)
    resume(tmp_path / "stopped.run.sqlite", rig=rig)
    assert of().runs == 3
    assert of().hours_hot - after.hours_hot == pytest.approx(
        after.hours_hot - undisturbed.hours_hot, rel=0.05
    )


@pytest.mark.long("takes a second", cases=("one_wire_serial",))
@pytest.mark.parametrize("rig_name", ["one_wire_twin", "one_wire_serial"])
def test_what_does_not_outlive_the_session_has_no_history(tmp_path, rig_name):
    """Twins, and simulated devices that the command itself starts: every session has a new wire."""
    run = smarig.run("validation", rig=rig_name, out=tmp_path / "a.run.sqlite", points=2)
    assert not {"wire_history", "history_until_tick"} & run.meta.keys()
    assert wire_histories() == []
    assert not (tmp_path / "wires").exists()


def test_a_simulation_wears_nothing(tmp_path, rig):
    """A model takes the place of the hardware, of which the rig file has all."""
    from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
    from smarig.rig.twin import TwinSettings

    with Session(rig, twin=TwinSettings(hysteresis=thesis_surface("one_e"))) as session:
        session.run("validation", {"points": "2"}, tmp_path / "s.run.sqlite")
    assert wire_histories() == []


@pytest.mark.long("takes two seconds")
def test_a_worn_wire_is_refused_before_anything_moves(tmp_path, urls):
    worn = str(rig_file(tmp_path / "worn.toml", urls, limits="[limits]\ncycles_max = 1\n"))
    smarig.run("congruency", rig=worn, out=tmp_path / "a.run.sqlite", **LOOPS)
    with pytest.raises(LimitExceeded, match="has completed 1 cycles; its limit is cycles_max = 1"):
        smarig.run("congruency", rig=worn, out=tmp_path / "b.run.sqlite", **LOOPS)
    assert not (tmp_path / "b.run.sqlite").exists()


@pytest.mark.long("takes three seconds")
def test_a_twin_is_never_worn(tmp_path):
    worn = tmp_path / "worn.toml"
    worn.write_text('name = "worn"\nbase = "one_wire_twin"\n[limits]\ncycles_max = 1\n', encoding="utf-8")
    with Session(str(worn)) as session:
        for name in ("a", "b"):
            session.run("congruency", LOOPS, tmp_path / f"{name}.run.sqlite")


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"wire": 3}', "\x00"])
def test_a_damaged_history_gives_one_sentence(tmp_path, text):
    WireHistory("a", twin=True, runs=1).save()
    path = next((tmp_path / "wires").iterdir())
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DataError, match="Repair it, or remove it"):
        of("a")


def test_a_figure_of_the_wrong_kind_is_damage(tmp_path):
    WireHistory("a", twin=True, runs=1).save()
    path = next((tmp_path / "wires").iterdir())
    data = json.loads(path.read_text(encoding="utf-8"))
    for key, value in (("cycles", "3"), ("cycles", True), ("hours_hot", None), ("wire", 1)):
        path.write_text(json.dumps(data | {key: value}), encoding="utf-8")
        with pytest.raises(DataError):
            of("a")


def test_the_heat_at_the_end_is_kept():
    heat = LastHeat((120.5, 3.0), current_A=-0.5, flows_s=2.0, device="encoder, boot 3", tick=77, epoch=1.8e9)
    WireHistory("a", runs=1, heat=heat).save()
    assert load_wire_history("a", twin=False).heat == heat


def test_a_history_of_an_earlier_version_has_no_heat(tmp_path):
    WireHistory("a", twin=True, runs=7).save()
    path = next((tmp_path / "wires").iterdir())
    data = json.loads(path.read_text(encoding="utf-8"))
    del data["heat"]
    path.write_text(json.dumps(data), encoding="utf-8")
    assert (of("a").runs, of("a").heat) == (7, None)


@pytest.mark.parametrize(
    "damage",
    [
        {"wire_K": [1.0]},
        {"wire_K": 3},
        {"wire_K": [float("nan"), 0.0]},
        {"wire_K": [-1.0, 0.0]},
        {"current_A": None},
        {"flows_s": float("inf")},
        {"epoch": "noon"},
        {"tick": []},
    ],
)
def test_a_heat_of_no_wire_is_damage(tmp_path, damage):
    WireHistory("a", twin=True, heat=LastHeat((1.0, 0.0))).save()
    path = next((tmp_path / "wires").iterdir())
    data = json.loads(path.read_text(encoding="utf-8"))
    path.write_text(json.dumps(data | {"heat": data["heat"] | damage}), encoding="utf-8")
    with pytest.raises(DataError, match="Repair it, or remove it"):
        of("a")


def test_a_twin_in_process_leaves_no_heat_because_its_wire_ends_with_it(tmp_path):
    """Stopped at its hottest; the next twin has a new, cold wire."""
    control = RunControl()
    stop = CallbackListener(on_sample=lambda s, step, u: control.stop("enough") if u > 100.0 else None)
    with Session("one_wire_twin", control=control) as session, pytest.raises(Interrupted):
        session.run("congruency", LOOPS, tmp_path / "stopped.run.sqlite", listeners=[stop])
    assert of().heat is None
    with Session("one_wire_twin") as session:
        assert session.guard.input_K == 0.0


@pytest.mark.long("takes two seconds")
def test_a_history_that_cannot_be_written_is_reported_and_ends_nothing(tmp_path, monkeypatch, rig):
    (tmp_path / "file").touch()
    monkeypatch.setenv("SMARIG_HISTORY_DIR", str(tmp_path / "file" / "wires"))
    run = smarig.run("validation", rig=rig, out=tmp_path / "a.run.sqlite", points=2)
    assert run.cause == "done"
    assert any(e.kind == "history" and e.level == "warning" for e in run.events)
