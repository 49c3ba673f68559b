"""Where the comparison of measured records names nothing, on wires that share no code with it."""

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run, lagged, triangles
from smarig.diagnosis.comparison.measured import record_readings
from smarig.diagnosis.comparison.measured.measured_comparison import compare_measured

WIRE = RelayWire(2)
rng = np.random.default_rng(5)
PEAKS = (88.0, *rng.uniform(58, 88, 11).round(1).tolist())
ROWS = [40, 14, 70, 25, 50, 16, 30, 90, 20, 60, 18, 35]
ASIDE = ("input_drift", "output_jump", "since", "speed", "history")  # asked for in other tests


@pytest.fixture(autouse=True)
def few_readings(monkeypatch):
    monkeypatch.setattr(record_readings, "TRAIN_READINGS", 140)
    monkeypatch.setattr(record_readings, "HELD_OUT_READINGS", 50)


def drive(rows=ROWS):
    return triangles(PEAKS, rows=rows)


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
    assert found.missing > 0.9
    assert found.between is None


def test_a_left_out_effect_is_not_named():
    u = drive()
    run = as_run("a", lagged(u, 5.0, 1.0), WIRE.strain(u), dt=1.0)
    found = compare_measured([run], without=("input_lag",))
    assert found.verdict.word == "unknown"
    assert found.verdict.depends_on in ("rate", "speed", "since", "history")
