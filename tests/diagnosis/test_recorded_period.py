"""The period of a recorded room, as a start of a periodic effect."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from smarig.diagnosis.comparison.commanded import effect_traces
from smarig.diagnosis.comparison.commanded.recorded_period import explained_shares, recorded_period_h
from smarig.plant.effects.ambient_drift import ambient_drift
from smarig.replay import ReadingSeries

RNG = np.random.default_rng(8)
T_S = np.sort(RNG.uniform(0, 3.5 * 3600, 168))


def record(value) -> Any:
    room = ReadingSeries("room", np.asarray(value), T_S, np.arange(T_S.size), "K")
    return SimpleNamespace(other_readings=(room,), duration_h=3.5)


def swing(period_h, noise_K=0.05):
    wave = np.sin(2 * np.pi * (T_S / 3600 / period_h + 0.11))
    return 21.0 + 2.3 * wave + noise_K * RNG.standard_normal(T_S.size)


@pytest.mark.parametrize("period_h", [0.2, 0.56, 1.3, 3.0, 6.0])
def test_a_room_that_swings_gives_its_period(period_h):
    found = recorded_period_h(record(swing(period_h)), "room")
    assert found == pytest.approx(period_h, rel=0.1)


def test_noise_and_missing_channels_give_none():
    assert recorded_period_h(record(21.0 + RNG.standard_normal(T_S.size)), "room") is None
    assert recorded_period_h(record(np.full(T_S.size, 21.0)), "room") is None
    assert recorded_period_h(record(swing(0.56)), "current") is None


def test_only_a_recorded_period_is_a_further_start_of_the_drift():
    def periods(timeline):
        return {v.values["period_h"] for v in effect_traces._variants(ambient_drift, timeline)}

    usual = periods(record(np.zeros(T_S.size)))
    assert sorted(usual) == pytest.approx([0.3 * 3.5, 0.7 * 3.5, 2.0 * 3.5])
    (own,) = periods(record(swing(0.56))) - usual
    assert own == pytest.approx(0.56, rel=0.05)


@pytest.mark.parametrize("spacing", ["even", "uneven"])
def test_its_periodogram_is_that_of_scipy(spacing):
    from scipy.signal import lombscargle

    t_h = np.linspace(0, 3.5, 60) if spacing == "even" else np.sort(RNG.uniform(0, 3.5, 60))
    y, omega = np.sin(9 * t_h) + RNG.standard_normal(60), 2 * np.pi * np.arange(0.5, 30, 0.125) / 3.5
    theirs = lombscargle(t_h, y - y.mean(), omega, normalize=True, floating_mean=True)
    np.testing.assert_allclose(explained_shares(t_h, y, omega), theirs, rtol=0, atol=1e-12)
