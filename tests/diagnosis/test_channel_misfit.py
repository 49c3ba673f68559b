"""The misfit of each channel: that of the channel whose readings were changed, and of no other."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from smarig.diagnosis.explain.channel_misfit import EQUATION_ERROR, channel_misfits

from replay.sittings import LISTED, LONG, session_runs, twin_plant_model
from smarig.diagnosis.refit.refit import refit
from smarig.plant import effects_from_pairs
from smarig.replay import ReadingSeries, build_timeline, predict

NOISE_A, SHIFT_A = 1e-3, 0.01


@pytest.fixture(scope="module")
def timeline(tmp_path_factory):
    """Settled positions, and currents with a noise of 1 mA, many at each step."""
    runs = session_runs(tmp_path_factory.mktemp("misfit"), LONG, LISTED)
    found = build_timeline(runs, twin_plant_model()[0].actuator.tau_s)
    ends = np.concatenate([[0.0], found.settled.t_s])
    t_s = np.round(np.concatenate([np.linspace(a, b, 21)[1:] for a, b in pairwise(ends)]), 6)
    noise = NOISE_A * np.random.default_rng(3).standard_normal(t_s.size)
    step = np.repeat(np.arange(len(found.settled)), 20)
    current = ReadingSeries("current", noise, t_s, step, "A")
    return replace(found, other_readings=(current,))


def shifted(timeline, shift_A):
    """The currents after the first third with another gain, as of a contact that loosened."""
    (current,) = timeline.other_readings
    late = np.arange(len(current)) > len(current) // 3
    return replace(timeline, other_readings=(replace(current, value=current.value + shift_A * late),))


def misfit(timeline, effects=()):
    wire, per_count = twin_plant_model()
    plain = replace(wire, per_count=per_count)
    extended = replace(plain, effects=effects_from_pairs(effects))
    pairs = [(m, refit(timeline, predict(timeline, m), m)) for m in (plain, extended)]
    (found,) = channel_misfits(timeline, *pairs)
    return found


def test_noise_alone_is_missed_by_once_the_noise(timeline):
    found = misfit(timeline)
    assert (found.channel, found.readings) == ("current", 20 * len(timeline.settled))
    assert found.before == found.after == pytest.approx(1.0, abs=0.1)
    assert found.expected == 1.0
    assert found.nats == 0.0


def test_a_current_that_changes_is_missed_by_the_change(timeline):
    found = misfit(shifted(timeline, SHIFT_A))
    assert found.before == pytest.approx(SHIFT_A * np.sqrt(2 / 3) / NOISE_A, rel=0.1)


def test_an_effect_on_the_current_may_be_off_by_a_share_of_its_change(timeline):
    found = misfit(timeline, ["amplifier_gain=10"])
    wire, _ = twin_plant_model()
    change_A = predict(timeline, replace(wire, effects=effects_from_pairs(["amplifier_gain=10"]))).values
    rms_A = float(np.sqrt(np.mean(change_A["current"] ** 2)))
    assert found.after == pytest.approx(rms_A / NOISE_A, rel=0.1)
    assert found.expected == pytest.approx(np.hypot(1.0, EQUATION_ERROR * rms_A / NOISE_A), rel=0.1)
    assert found.nats < 0
