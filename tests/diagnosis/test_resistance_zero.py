"""Of a resistance, a constant in ohms is free (leads, contacts); a current that is missing is not one."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from replay.sittings import LISTED, LONG, session_runs, twin_plant_model
from smarig.diagnosis.refit.refit import refit
from smarig.plant import effects_from_pairs
from smarig.replay import ReadingSeries, build_timeline, predict

NOISE_V = 1e-3
DEAD_ZONE = ["dead_zone=0.03"]


def with_resistances(timeline, model, added_ohm=0.0):
    """Resistances V/i, many at each step, as this model predicts them, with noise of the voltage."""
    ends = np.concatenate([[0.0], timeline.settled.t_s])
    t_s = np.round(np.concatenate([np.linspace(a, b, 11)[1:] for a, b in pairwise(ends)]), 6)
    step = np.repeat(np.arange(len(timeline.settled)), 10)
    heated = np.abs(timeline.target_K[step]) > 20.0
    blank = ReadingSeries("resistance", np.zeros(heated.sum()), t_s[heated], step[heated], "ohm")
    empty = replace(timeline, other_readings=(blank,), resistance_from_command=True)
    prediction = predict(empty, model)
    current_A = np.sqrt(np.abs(timeline.target_K[blank.step]) / model.actuator.gain_K_per_A2)
    noise_ohm = NOISE_V / current_A * np.random.default_rng(4).standard_normal(len(blank))
    value = prediction.values["resistance"] + noise_ohm + added_ohm
    return replace(empty, other_readings=(replace(blank, value=value),))


@pytest.fixture(scope="module")
def timeline(tmp_path_factory):
    runs = session_runs(tmp_path_factory.mktemp("resistance"), LONG, LISTED)
    return build_timeline(runs, twin_plant_model()[0].actuator.tau_s)


def model(effects=()):
    wire, per_count = twin_plant_model(effects_from_pairs([]))
    return replace(wire, per_count=per_count, effects=effects_from_pairs(effects))


def evidence(timeline, with_effects):
    return refit(timeline, predict(timeline, with_effects), with_effects).log_evidence


@pytest.mark.long("takes a second")
def test_a_constant_in_ohms_is_free(timeline):
    without, with_leads = (with_resistances(timeline, model(), ohm) for ohm in (0.0, 0.3))
    assert evidence(with_leads, model()) == pytest.approx(evidence(without, model()), abs=1.0)


@pytest.mark.long("takes two seconds")
def test_a_missing_current_is_no_free_constant(timeline):
    """V/i = R (i − i_d)/i: a constant in volts, not in ohms."""
    readings = with_resistances(timeline, model(DEAD_ZONE))
    assert evidence(readings, model(DEAD_ZONE)) > evidence(readings, model()) + 1000
