"""The fit of an effect's parameters: where it ends, and that it ends there."""

from dataclasses import replace

import pytest

from replay.sittings import LISTED, LONG, session_runs, twin_plant_model
from smarig.diagnosis.refit.parameter_fit import fit_parameters
from smarig.diagnosis.refit.refit import refit
from smarig.plant.effects.walking import walking
from smarig.replay import build_timeline, predict


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """The timeline of a wire with the effect walking, a plant model without it, and its refitted readings."""
    runs = session_runs(tmp_path_factory.mktemp("refine"), LISTED, LONG, LISTED, effects=("walking=0.8",))
    wire, per_count = twin_plant_model()
    plant_model = replace(wire, per_count=per_count)
    timeline = build_timeline(runs, wire.actuator.tau_s)
    return timeline, plant_model, refit(timeline, predict(timeline, plant_model), plant_model)


def fitted(walked, strength):
    timeline, plant_model, warm_start = walked
    return fit_parameters([walking(strength)], timeline, plant_model, warm_start, plant_model.hysteresis)


@pytest.mark.long("takes two seconds")
def test_a_fit_from_a_distant_start_reaches_the_injected_value(walked):
    found = fitted(walked, 0.1)
    assert found.effects[0].strength == pytest.approx(0.8, rel=0.03)
    sd = found.spread["walking", "percent_per_cycle"]
    assert found.moved == pytest.approx((found.effects[0].strength - 0.1) / sd)
    assert found.moved > 10


def test_a_fit_from_its_own_end_moves_no_more(walked):
    again = fitted(walked, fitted(walked, 0.1).effects[0].strength)
    assert again.moved < 0.3
