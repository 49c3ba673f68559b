"""The zero of a density that was identified with free zeros: that of the runs, and of the first session only."""

from dataclasses import replace

import numpy as np
import pytest

from replay.sittings import LONG, session_runs, twin_plant_model
from smarig.diagnosis.refit.refit import refit
from smarig.diagnosis.refit.zero_of_output import with_zero_of_runs
from smarig.preisach import FodTable
from smarig.replay import build_timeline, predict


@pytest.fixture(scope="module")
def timeline(tmp_path_factory):
    runs = session_runs(tmp_path_factory.mktemp("zero"), LONG)
    return build_timeline(runs, twin_plant_model()[0].actuator.tau_s)


@pytest.fixture(scope="module")
def shifted(timeline):
    """A density of the runs, 0.4 mm above them."""
    wire, _ = twin_plant_model()
    h = refit(timeline, predict(timeline, wire), wire).posterior.table()
    return replace(wire, hysteresis=FodTable(h.nodes, h.values + 0.4, h.unit))


def mean_error(timeline, plant_model, rows=slice(None)):
    error = timeline.settled.value - predict(timeline, plant_model).values["settled"]
    return float(np.mean(error[rows]))


def test_the_mean_error_of_the_runs_is_removed(timeline, shifted):
    assert mean_error(timeline, shifted) == pytest.approx(-0.4, abs=0.05)
    assert mean_error(timeline, with_zero_of_runs(timeline, shifted)) == pytest.approx(0.0, abs=1e-9)


def test_a_later_session_with_a_zero_of_its_own_does_not_count(timeline, shifted):
    later = (np.arange(len(timeline.settled)) >= 5).astype(np.int64)
    settled = replace(timeline.settled, value=timeline.settled.value + 2.0 * later)
    two = replace(timeline, settled=settled, zero=later)
    found = with_zero_of_runs(two, shifted)
    assert mean_error(two, found, later == 0) == pytest.approx(0.0, abs=1e-9)
    assert mean_error(two, found, later == 1) > 1.9


def test_a_surface_keeps_the_zero_it_was_given_with(timeline):
    wire, _ = twin_plant_model()
    assert with_zero_of_runs(timeline, wire) is wire
