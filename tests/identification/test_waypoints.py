"""Inputs between settled points belong to the memory: waveforms, loops, and any other turning points."""

from dataclasses import replace

import numpy as np
import pytest

from control.model_files import model_of
from identification.made_runs import driven_run
from smarig.app.loop_model import ModelSource
from smarig.app.regulation_loop import regulation
from smarig.identification.identify import identify
from smarig.identification.verify import verify
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.record import load_run
from smarig.replay import Model, memory_histories
from smarig.replay.memory_history import input_path, reversals_between
from smarig.runner.session import Session

LEVELS = {"partition_K": (0, 40, 60, 80, 100, 120, 170)}


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """FOD data, and a set-point held from B_ℓ: the sinusoid that leads there is no settled step."""
    folder = tmp_path_factory.mktemp("runs")
    with Session("one_wire_twin", seed=3) as session:
        loop = regulation(
            ModelSource(model_of("one_e"), "one_e.model.json", "1" * 64), session.file, 6.0, hold_s=30.0
        )
        made = [
            session.run("first_order_descending", LEVELS, folder / "fod.run.sqlite"),
            session.run("regulate", loop.settings, folder / "held.run.sqlite", protocol_factory=loop.make),
        ]
    return [load_run(path) for path in made]


@pytest.mark.long("takes five seconds")
def test_a_model_that_is_right_is_right_along_a_waveform_too(runs):
    (found,) = verify(model_of("one_e"), runs[1]).runs
    assert found.settled.n == 2
    assert found.settled.rms < 0.02


@pytest.mark.long("takes four seconds")
def test_a_waveform_between_settled_points_does_not_spoil_a_fit(runs):
    alone, both = (identify(given, "positive").model for given in (runs[:1], runs))
    assert isinstance(both, Model)
    u = [170.0, 60.0, 90.0, 30.0, 120.0]
    truth = Preisach(thesis_surface("one_e")).simulate(u)
    errors = [np.abs(Preisach(model.hysteresis).simulate(u) - truth).max() for model in (alone, both)]
    assert errors[1] < 1.5 * errors[0]


def test_the_memory_at_a_point_is_that_of_the_whole_input_path(runs):
    lower, upper, (_, held) = memory_histories(runs)
    inputs, where = input_path(runs[1])
    assert inputs.size > where.size == 2
    assert len(held.states[-1].extrema) > 5, "the sinusoid's reversals are remembered"
    whole = Preisach(thesis_surface("one_e")).simulate(np.clip(inputs, lower, upper))
    assert whole[where[-1]] == pytest.approx(6.0, abs=0.05)


def test_steps_have_no_turns_between_them():
    run = driven_run("one_e", [0, 100, 40, 80, 50, 90, 60])
    inputs, where = input_path(run)
    assert inputs.tolist() == [0, 100, 40, 80, 50, 90, 60]
    assert where.tolist() == list(range(7))


@pytest.mark.parametrize(
    ("traversed", "before", "after", "found"),
    [
        ([1.0, 30.0, 43.0], 0.0, 43.0, []),
        ([10.0, 80.0, 20.0, 70.0, 40.0], 0.0, 43.0, [80.0, 20.0, 70.0, 40.0]),
        ([10.0, 80.0, 20.0, 70.0, 43.0], 0.0, 43.0, [80.0, 20.0, 70.0]),
        ([80.0, 79.5, 80.2, 20.0], 0.0, 43.0, [80.2, 20.0]),
        ([10.0, np.nan, 80.0, 20.0], 0.0, 43.0, [80.0, 20.0]),
        ([50.0, 20.0], None, 43.0, [20.0]),
        ([50.0, 20.0], 43.0, None, [50.0, 20.0]),
        ([50.0, 20.0], 43.0, 10.0, [50.0]),
        ([], 0.0, 43.0, []),
        ([43.2, 42.9, 43.1], 43.0, 43.0, []),
    ],
)
def test_reversals_above_the_threshold_are_found(traversed, before, after, found):
    assert reversals_between(np.array(traversed), before, after, 1.0) == found


def test_a_run_that_was_interrupted_and_went_on_has_the_memory_of_a_whole_one(tmp_path):
    """Void steps turn near the levels that were aimed at: 75.002 K on the way is the 75 K of the step."""
    steps = [0.0, 65.0, 0.0, 75.0, 65.0, 0.0, 174.0, 75.0, 0.0]
    whole = driven_run("one_e", steps)
    traversed = np.insert(np.array(steps), 3, [75.002, 0.0004])
    broken = replace(
        whole, columns={**whole.columns, "input": traversed, "t_s": between_points(whole["t_s"])}
    )
    (*_, (one,)), (*_, (other,)) = memory_histories([whole]), memory_histories([broken])
    assert [s.extrema for s in other.states] == [s.extrema for s in one.states]


def between_points(t):
    """Two samples more within the fourth step."""
    return np.insert(t, 3, [t[3] - 20.0, t[3] - 10.0])
