"""The boundary of the Preisach plane that a run's page shows: that of the whole input so far, without growing."""

import math
from pathlib import Path

import numpy as np
import pytest

import smarig
from running.made import INFO, sample
from smarig.console.web.input_memory import InputMemory
from smarig.live import boundary
from smarig.preisach import Preisach, RelayMeasure
from smarig.record import stored_run
from smarig.runner import RunControl
from smarig.running import SAMPLES, RunStatus, announced, runs_in_progress


@pytest.fixture(scope="module")
def recorded(tmp_path_factory) -> Path:
    """A run whose file has the range of its rig."""
    out = tmp_path_factory.mktemp("run") / "a.run.sqlite"
    smarig.run("validation", rig="one_wire_twin", out=out, points=3)
    return out


@pytest.fixture
def announced_run(tmp_path, monkeypatch):
    """An announced run, and what feeds inputs into it."""
    monkeypatch.setenv("SMARIG_RUNNING_DIR", str(tmp_path / "running"))
    control = RunControl()
    with announced(INFO, control, RunStatus(INFO, control)) as listener:
        count = 0

        def feed(*inputs: float) -> None:
            nonlocal count
            for u in inputs:
                count += 1
                listener.sample(sample(count), 1, u)

        yield runs_in_progress()[0], feed


class EmptyFile:
    """A run file of the same rig that has no samples yet."""

    def __init__(self, recorded: Path, initial: str = "negative", blocks=()):
        with stored_run(recorded) as run:
            self.meta = {**run.meta, "initial": initial}
            self.info = type(run.info).of(self.meta)
        self._blocks = blocks

    def blocks(self, _names):
        return iter(self._blocks)


def followed(run, file) -> InputMemory:
    memory = InputMemory(run)
    memory.catch_up(file)
    return memory


def shown(memory: InputMemory) -> dict:
    memory.follow()
    found = memory.news()
    assert found is not None
    return found


def near(corners, expected) -> bool:
    """Whether they agree to what can be drawn."""
    return len(corners) == len(expected) and all(math.dist(*pair) < 0.1 for pair in zip(corners, expected))


def test_its_corners_are_the_extrema_that_are_remembered(announced_run, recorded):
    run, feed = announced_run
    memory = followed(run, EmptyFile(recorded))
    feed(0.0, 40.0, 80.0, 50.0, 20.0, 60.0)
    found = shown(memory)
    low, high = found["range"]
    assert low == 0.0
    assert high > 100.0
    assert near(found["corners"], [[0, 80], [20, 80], [20, 60], [60, 60]])
    assert (found["count"], found["input"]) == (3, 60.0)
    feed(90.0)  # wipes everything out
    assert shown(memory)["count"] == 1
    memory.follow()
    assert memory.news() is None  # nothing changed


def test_it_does_not_grow_with_the_run(announced_run, recorded):
    run, feed = announced_run
    memory = followed(run, EmptyFile(recorded))
    counts = []
    for cycle in range(200):
        feed(*(50 + 40 * math.sin(k / 3) for k in range(19)), 25.0 + cycle / 10)
        counts.append(shown(memory)["count"])
    assert max(counts) <= 5


@pytest.mark.parametrize(("two_wire", "low"), [(False, 0.0), (True, -1.0)])
def test_a_signed_input_has_a_plane_of_both_signs(announced_run, recorded, two_wire, low):
    run, feed = announced_run
    run.info["two_wire"] = two_wire
    memory = followed(run, EmptyFile(recorded))
    feed(-30.0, 40.0)
    found = shown(memory)
    assert found["range"][0] == low * found["range"][1]


def test_without_the_rig_the_range_is_that_of_the_inputs(announced_run):
    run, feed = announced_run
    memory = InputMemory(run)

    class Nothing:
        info = type("Info", (), {"initial": None, "actuator_values": {}, "rig_values": {}, "period_s": None})

        def blocks(self, _names):
            return iter(())

    memory.catch_up(Nothing())
    feed(10.0)
    memory.follow()
    assert memory.news() is None  # a plane of one point
    feed(30.0, 20.0)
    assert shown(memory)["range"] == [10.0, 30.0]
    assert shown_again(memory, feed)["corners"][0] == [10.0, 30.0]


def shown_again(memory, feed):
    feed(25.0)
    return shown(memory)


def test_samples_that_were_overwritten_are_read_from_the_file(announced_run, recorded):
    run, feed = announced_run
    memory = followed(run, EmptyFile(recorded))
    feed(0.0, 80.0)
    shown(memory)
    feed(10.0, *[50.0] * 5000)  # the minimum is no longer in shared memory
    memory.follow()
    assert memory.is_behind
    assert memory.news() is None
    t_s, inputs = np.arange(1, 5004) / 10, np.array([0.0, 80.0, 10.0, *[50.0] * 5000])
    memory._rests_until_s = 0.0
    memory.catch_up(EmptyFile(recorded, blocks=[{"t_s": t_s[:4000], "input": inputs[:4000]}]))
    assert not memory.is_behind
    found = shown(memory)
    assert near(found["corners"], [[0, 80], [10, 80], [10, 50], [50, 50]])


def test_it_is_the_boundary_of_the_operator_on_the_record(announced_run, recorded):
    run, _ = announced_run
    with stored_run(recorded) as file:
        found = followed(run, file).news()
        operator = Preisach(RelayMeasure.zero(*found["range"]), file.info.initial)
        operator.follow(file["input"])
    assert found["count"] == len(boundary(operator.state, *found["range"])) - 1
    assert found["corners"][-1] == pytest.approx([operator.u] * 2, abs=found["range"][1] / 2000)


def test_the_samples_of_a_run_have_the_fields_that_it_reads():
    assert {"t_s", "input_K", "number"} <= set(SAMPLES.names)
