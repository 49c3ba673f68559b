"""A rig in plans of bluesky: the documents are valid, and the positions are those of the run file."""

import time

import pytest

pytest.importorskip("ophyd_async", reason="the extra bluesky is not installed")
import bluesky.plan_stubs as bps
import bluesky.plans as bp
import event_model
from bluesky import RunEngine
from bluesky.utils import FailedStatus

from smarig.app import OphydRig, RunFlyer
from smarig.record import load_run

pytestmark = pytest.mark.filterwarnings("default")  # of packages that are not ours


@pytest.fixture
def engine():
    engine = RunEngine(context_managers=[])
    yield engine
    engine.loop.call_soon_threadsafe(engine.loop.stop)
    engine._th.join()  # its thread has no public handle
    engine.loop.close()


@pytest.fixture
def documents(engine):
    """Every document, validated by event-model as it comes."""
    found = []

    def keep(name, document):
        event_model.schema_validators[getattr(event_model.DocumentNames, name)].validate(document)
        found.append((name, document))

    engine.subscribe(keep)
    return found


def connected(engine, device):
    def plan():
        yield from bps.wait_for([device.connect])

    engine(plan())
    return device


@pytest.fixture
def rig(engine, tmp_path):
    return connected(engine, OphydRig("one_wire_twin", tmp_path / "scan.run.sqlite", name="wire"))


def events(documents):
    return [document["data"] for name, document in documents if name == "event"]


def test_a_scan_steps_the_wire_and_its_documents_are_valid(engine, documents, rig, tmp_path):
    engine(bp.scan([rig], rig.input, 20, 80, 4))
    run = load_run(tmp_path / "scan.run.sqlite")
    assert [step.target for step in run.steps] == [20, 40, 60, 80]
    assert run.cause == "done"
    found = events(documents)
    assert [e["wire-settled_position"] for e in found] == [step.position for step in run.steps]
    assert [e["wire-input-setpoint"] for e in found] == [20, 40, 60, 80]
    assert [e["wire-input-readback"] for e in found] == pytest.approx([20, 40, 60, 80], abs=0.2)
    assert all(e["wire-is_settled"] == 1.0 for e in found)
    assert all(abs(e["wire-position"] - e["wire-settled_position"]) < 0.1 for e in found)
    descriptor = next(document for name, document in documents if name == "descriptor")
    assert descriptor["data_keys"]["wire-position"]["units"] == "mm"
    assert descriptor["configuration"]["wire"]["data"]["wire-run_file"].endswith("scan.run.sqlite")


def test_each_scan_has_a_file_of_its_own(engine, rig, tmp_path):
    engine(bp.scan([rig], rig.current, 0.1, 0.3, 2))
    engine(bp.scan([rig], rig.current, 0.1, 0.2, 2))
    assert [len(load_run(tmp_path / f"{n}.run.sqlite").steps) for n in ("scan", "scan_2")] == [2, 2]


@pytest.mark.parametrize("speed", [None, 40.0])
def test_a_plan_that_fails_leaves_the_wire_at_zero(engine, tmp_path, speed):
    """Whether its hold is over (without speed) or not (at 40 times real time it takes more than a second)."""
    rig = connected(engine, OphydRig("one_wire_twin", tmp_path / "scan.run.sqlite", name="wire", speed=speed))

    def failing():
        yield from bps.open_run()
        yield from bps.stage_all(rig)
        yield from bps.abs_set(rig.current, 0.5, wait=speed is None)
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        engine(failing())
    rig._execution.run._thread.join(20)
    run = load_run(tmp_path / "scan.run.sqlite")
    assert run.complete
    assert run.cause == ("done" if speed is None else "the plan ended during a hold")
    assert len(run["t_s"]) < 1000


def test_what_the_limits_forbid_fails_the_move(engine, rig, tmp_path):
    with pytest.raises(FailedStatus, match="outside the rig's range"):
        engine(bp.scan([rig], rig.input, 20, 900, 2))
    assert load_run(tmp_path / "scan.run.sqlite").complete


def test_a_plan_that_fails_ends_the_run_of_its_flyer(engine, tmp_path):
    """The run would take minutes at this speed."""
    rig = tmp_path / "slow.toml"
    rig.write_text('name = "slow"\nbase = "one_wire_serial"\nsimulator.speed = 5.0\n')
    flyer = RunFlyer("fly", "validation", str(rig), tmp_path / "fly.run.sqlite", points=40)

    def failing():
        yield from bps.open_run()
        yield from bps.stage_all(flyer)
        yield from bps.kickoff(flyer, wait=True)
        while not (tmp_path / "fly.run.sqlite").exists():
            yield from bps.sleep(0.05)
        yield from bps.sleep(0.3)
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        engine(failing())
    for _ in range(200):
        if (tmp_path / "fly.run.sqlite").exists() and load_run(tmp_path / "fly.run.sqlite").complete:
            break
        time.sleep(0.05)
    run = load_run(tmp_path / "fly.run.sqlite")
    assert run.cause == "the plan ended during the run"
    assert len(run["t_s"]) < 2000


@pytest.mark.long("takes a second")
def test_a_flyer_runs_a_protocol_and_brings_its_steps(engine, documents, tmp_path):
    flyer = RunFlyer("fly", "validation", "one_wire_twin", tmp_path / "fly.run.sqlite", points=3)
    engine(bp.fly([flyer]))
    run = load_run(tmp_path / "fly.run.sqlite")
    (page,) = [document["data"] for name, document in documents if name == "event_page"]
    assert page["fly_position"] == [step.position for step in run.steps]
    assert all(page["fly_settled"])
