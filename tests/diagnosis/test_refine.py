"""Refinement of an explanation: where a fit ends, and when it may continue."""

from dataclasses import replace

import numpy as np
import pytest

from replay.sittings import LISTED, LONG, session_runs, twin_plant_model
from smarig.diagnosis.refit.parameter_fit import ParameterFit, fit_parameters
from smarig.diagnosis.refit.refit import refit
from smarig.plant.effects.settling import settling
from smarig.plant.effects.walking import walking
from smarig.replay import build_timeline, predict

START = (walking(0.2), settling(2.0, time_constant_s=600.0))


def ended(*effects):
    return ParameterFit(effects, {}, {}, np.zeros(1), twin_plant_model()[0], 1.0)


def test_beyond_is_so_many_times_as_far_as_the_fit_went():
    found = ended(walking(0.5), settling(3.0, time_constant_s=500.0)).extrapolated(START, 2.0)
    assert [p.kind.name for p in found] == ["walking", "settling"]
    assert found[0].values == pytest.approx({"percent_per_cycle": 0.8})
    assert found[1].values == pytest.approx({"share_percent": 4.0, "time_constant_s": 400.0})


def test_once_as_far_is_where_the_fit_ended():
    end = (walking(-0.7), settling(1.0, time_constant_s=900.0))
    for p, q in zip(ended(*end).extrapolated(START, 1.0), end, strict=True):
        assert p.values == pytest.approx(q.values)


@pytest.mark.parametrize("strength", [-2.9, 2.9])
def test_beyond_ends_at_the_bounds(strength):
    end = ended(walking(strength), settling(0.1, time_constant_s=600.0))
    one, other = end.extrapolated(START, 50.0)
    assert one.strength == (walking.primary.upper if strength > 0 else walking.primary.lower)
    assert other.strength == settling.primary.lower
    assert other.values["time_constant_s"] == 600.0


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """The timeline of a wire with the effect walking, a plant model without it, and its refitted readings."""
    runs = session_runs(tmp_path_factory.mktemp("refine"), LISTED, LONG, LISTED, effects=("walking=0.8",))
    wire, per_count = twin_plant_model()
    plant_model = replace(wire, per_count=per_count)
    timeline = build_timeline(runs, wire.actuator.tau_s)
    told_ = predict(timeline, plant_model)
    trace = predict(timeline, plant_model, [walking(0.1)]).stacked(timeline) - told_.stacked(timeline)
    return timeline, plant_model, refit(timeline, told_, plant_model, [trace[:, None]])


def fitted(walked, strength):
    timeline, plant_model, warm_start = walked
    return fit_parameters([walking(strength)], timeline, plant_model, warm_start, plant_model.hysteresis)


def test_a_fit_from_a_distant_start_reaches_the_injected_value(walked):
    found = fitted(walked, 0.1)
    assert found.effects[0].strength == pytest.approx(0.8, rel=0.03)
    sd = found.spread["walking", "percent_per_cycle"]
    assert found.moved == pytest.approx((found.effects[0].strength - 0.1) / sd)
    assert found.moved > 10


def test_a_fit_from_its_own_end_moves_no_more(walked):
    again = fitted(walked, fitted(walked, 0.1).effects[0].strength)
    assert again.moved < 0.3
