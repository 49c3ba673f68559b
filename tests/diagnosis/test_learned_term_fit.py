"""The missing term of commanded runs: laws that independent code hid are learned, and none where nothing is hidden."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from smarig.diagnosis.commanded_diagnosis import _if_borne_out
from smarig.diagnosis.explain.learned_term_fit import LearnedTermFit, learned_term

from diagnosis.short_boxes import given_model, recorded, short_box
from smarig.diagnosis import commanded_diagnosis, joint_density_from_best_start
from smarig.plant import LearnedShape
from smarig.replay import predict

WIDE = 32
TIMELINE: Any = None


def learned(number, hidden, **settings):
    """The law that is learned from a short box."""
    given = given_model(number)
    timeline = recorded(short_box(number, hidden, **settings))
    base, plain = joint_density_from_best_start(timeline, given, given.hysteresis)
    return learned_term(timeline, base, plain, given.hysteresis)


@pytest.mark.long("takes ten seconds")
def test_a_strain_that_each_cycle_leaves_is_learned_as_a_straight_law_of_the_cycle():
    found = learned(WIDE, {"walking": {"percent_per_cycle": 0.6}})
    assert found is not None
    assert (found.shape.variable, found.shape.enters, found.shape.unit) == ("cycle", "output", "mm")
    cycle, added = np.array(found.points).T
    per_cycle = 0.006 * short_box(WIDE, {}).hysteresis.stroke
    np.testing.assert_allclose(np.diff(added) / np.diff(cycle), per_cycle, rtol=0.15)
    assert found.gain_blocks > 0.8


@pytest.mark.long
def test_an_amplifier_that_warms_up_is_learned_at_the_input_and_levels_off():
    hidden = {"warming_amplifier": {"share": 0.02, "tau_h": 0.3}}
    found = learned(1, hidden, runs=("wiping_out",) * 3)
    assert found is not None
    assert found.shape.enters == "input"
    assert found.shape.variable in ("time", "cycle", "reversals")
    added = np.array(found.points)[:, 1]
    assert added[1] > 0.5 * added[-1] > 0.4
    assert found.gain_blocks > 0.4


@pytest.mark.long
def test_a_frame_that_warms_up_is_learned_as_a_law_of_the_mean_power():
    found = learned(WIDE, {"warm_frame": {"share": 0.05, "tau_min": 8.0}})
    assert found is not None
    assert (found.shape.variable, found.shape.enters) == ("power_over_15_min", "output")
    assert np.all(np.diff([added for _, added in found.points]) > 0)
    assert found.gain_blocks > 0.4


def test_a_cord_that_recovers_is_learned_as_a_law_of_the_last_minutes():
    """It gives way by a tenth of the mean position of the last three minutes, computed here.

    In so short a record the mean power is much the same.
    """
    given, timeline = given_model(WIDE), recorded(short_box(WIDE, {}))
    prediction = predict(timeline, given)
    y = prediction.outputs_along(given.hysteresis, given.initial, prediction.hysteresis_input_K)
    mean, late = float(y[0]), []
    for position, dt_s in zip(y.tolist(), np.diff(prediction.t_s, prepend=0.0).tolist()):
        mean += (position - mean) * (1 - np.exp(-dt_s / 180.0))
        late.append(mean)
    at = prediction.tick_index[: len(timeline.settled)]
    stretched = timeline.settled.value - 0.1 * np.array(late)[at]
    timeline = replace(timeline, settled=replace(timeline.settled, value=stretched), other_readings=())
    base, plain = joint_density_from_best_start(timeline, given, given.hysteresis)
    found = learned_term(timeline, base, plain, given.hysteresis)
    assert found is not None
    assert found.shape.variable in ("level_over_2_min", "power_over_2_min")
    assert found.shape.enters == "output"
    assert np.all(np.diff([added for _, added in found.points]) < 0)
    assert found.gain_blocks > 0.4


def test_nothing_is_learned_where_nothing_is_hidden():
    assert learned(WIDE, {}) is None


def fit(shape, **values) -> Any:
    effect = SimpleNamespace(kind=SimpleNamespace(shape=shape), values=values)
    return LearnedTermFit(
        SimpleNamespace(effects=(effect,), plant_model="with law", refitted=None), 20.0, 9.0, 0.5
    )


def test_the_json_gives_holds_in_seconds():
    found = fit(LearnedShape("hold", "output", (1.0, 2.0, 3.0), "mm"), value_1=0.1, value_2=0.3).to_json()
    assert found["points"] == [[10.0, 0.0], [100.0, 0.1], [1000.0, 0.3]]
    assert (found["terms"][0]["variable_unit"], found["terms"][0]["unit"]) == ("s", "mm")


@pytest.mark.parametrize(
    ("base", "given", "extended", "offered"),
    [(2.0, 3.0, 1.0, True), (2.0, 3.0, 2.1, False), (2.0, 1.0, 1.5, False), (2.0, None, 1.5, True)],
)
def test_a_law_is_offered_only_if_neither_model_predicts_held_out_runs_better(
    monkeypatch, base, given, extended, offered
):
    monkeypatch.setattr(
        commanded_diagnosis, "with_posterior_density", lambda timeline, model, refitted: model
    )
    gain: Any = SimpleNamespace(base=base, original=given, extended=extended)
    law = fit(LearnedShape("time", "output", (0.0, 1.0), "mm"), value_1=0.1)
    model, _, reason = _if_borne_out(TIMELINE, law, lambda model: gain)
    assert (model == "with law") is offered
    assert bool(reason) is not offered
    assert _if_borne_out(TIMELINE, law, lambda model: None)[0] == "with law"  # no held-out run
    assert _if_borne_out(TIMELINE, None, lambda model: gain)[0] is None
