"""The gates of the search: each refuses what it is for, and lets through what passes."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run, lagged, triangles
from smarig.diagnosis.measured.measured_search import failure
from smarig.diagnosis.measured.measured_verdict import decide
from smarig.identification import compared
from smarig.measurement import input_records
from smarig.measurement.effects.input_lag import input_lag

T = triangles((85.0, 60.0, 80.0, 57.0, 85.0), (30, 90, 50, 80, 40))


@pytest.fixture(scope="module")
def hypotheses():
    """The plain model, and one with the lag that was hidden."""
    run = as_run("lag", lagged(T, 4.0, 0.5), RelayWire(3).strain(T), dt=0.5)
    comparison = compared(input_records([run]), 1)
    return comparison.evaluated([]), comparison.evaluated([input_lag(lag_s=4.0)])


def test_what_was_hidden_passes(hypotheses):
    plain, lag = hypotheses
    assert failure(lag, plain) == ""


def test_a_value_at_the_end_of_its_search_is_refused(hypotheses):
    plain, lag = hypotheses
    assert "end of its search" in failure(replace(lag, at_bound=("lag_s",)), plain)


def test_an_interval_that_contains_no_effect_is_refused(hypotheses):
    plain, lag = hypotheses
    assert "no effect" in failure(replace(lag, intervals={"lag_s": (-1.0, 2.0)}), plain)


def test_a_small_gain_is_refused(hypotheses):
    plain, _ = hypotheses
    slightly = replace(plain, effects=(input_lag(lag_s=0.1),), errors=0.95 * plain.errors)
    assert "held-out blocks" in failure(slightly, plain)


def test_a_gain_in_one_block_only_is_refused(hypotheses):
    plain, lag = hypotheses
    errors = plain.errors.copy()
    block = plain.fit.problem.plan.block
    worst = np.argmax(plain.block_squares())
    errors[block == np.unique(block)[worst]] *= 0.3
    once = replace(lag, errors=errors)
    assert once.rms < 0.9 * plain.rms
    assert "chance" in failure(once, plain)


def test_a_worse_fit_is_refused(hypotheses):
    plain, lag = hypotheses
    assert "fits the records worse" in failure(replace(lag, fit=plain.fit), replace(plain, fit=lag.fit))


def test_a_model_that_is_worse_on_held_out_runs_is_not_offered(hypotheses):
    from smarig.diagnosis.measured.measured_search import SearchStep

    plain, lag = hypotheses
    steps = [SearchStep(plain, (lag,), (), {"input_lag": ""}), SearchStep(lag, (), (), {})]
    named = decide(steps, worse_on_held_out=False)
    assert named.verdict.names == ("input_lag",)
    worse = decide(steps, worse_on_held_out=True)
    assert worse.verdict.word == "unknown"
    assert not worse.accepted.effects
    assert "held-out runs worse" in worse.reason


def test_a_variable_that_explains_much_more_takes_the_name_away(hypotheses):
    from smarig.diagnosis.measured.measured_search import SearchStep

    plain, lag = hypotheses
    time = replace(plain, variable="time", errors=0.1 * lag.errors)
    steps = [SearchStep(plain, (lag,), (time,), {"input_lag": ""}), SearchStep(lag, (), (), {})]
    found = decide(steps, worse_on_held_out=False)
    assert found.verdict.word == "unknown"
    assert found.verdict.depends_on == "time"


def test_an_open_search_has_an_interval_without_an_upper_end():
    from smarig.diagnosis.diagnosis_text import parameter_text

    value = {"value": 126.0, "ci95": [119.0, None], "unit": "h"}
    assert parameter_text("time_constant_h", value) == "time constant at least 119 h"
