"""Where the comparison of measured records names nothing, on wires that share no code with it."""

import numpy as np
import pytest

from diagnosis.comparison.few_readings import ASIDE, WIRE, drive
from diagnosis.measured.independent_wire import as_run, lagged
from smarig.diagnosis.comparison.measured.measured_comparison import compare_measured

pytestmark = pytest.mark.usefixtures("few_readings")


def test_a_plain_wire_is_silent():
    u = drive()
    found = compare_measured([as_run("a", u, WIRE.strain(u), dt=1.0)], without=ASIDE)
    assert found.verdict.word == "silent"
    assert found.weights.nothing > 0.5


def test_an_output_that_is_a_function_of_its_input_is_silent():
    u = drive()
    y = 4 / (1 + np.exp((u - 55) / 4))
    found = compare_measured([as_run("a", u, y, dt=1.0)], without=ASIDE)
    assert found.verdict.word == "silent"


def test_a_turn_inside_the_fitted_loop_is_missing_knowledge_and_no_change():
    def run(name, points):
        u = np.concatenate([np.linspace(a, b, 50) for a, b in zip(points, points[1:])])
        return as_run(name, u, WIRE.strain(np.r_[25.0, u])[1:], dt=1.0)

    found = compare_measured([run("a", (25.0, 90.0, 25.0))], [run("b", (25.0, 90.0, 48.0, 90.0, 25.0))])
    assert found.verdict.word == "silent"
    assert found.missing is not None
    assert found.missing.share > 0.9
    low, high = found.missing.inputs
    assert 40.0 < low < high < 95.0
    assert not found.between_runs


@pytest.mark.long("takes two seconds")
def test_a_left_out_effect_is_not_named():
    u = drive()
    run = as_run("a", lagged(u, 5.0, 1.0), WIRE.strain(u), dt=1.0)
    found = compare_measured([run], without=("input_lag",))
    assert found.verdict.word == "unknown"
    assert found.verdict.depends_on in ("rate", "speed", "time_since_reversal", "history")
