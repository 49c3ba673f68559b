"""The 95 % intervals cover the true temperatures of loops whose tangents are known exactly."""

import os

import numpy as np
import pytest

from smarig.transformation import TEMPERATURES, run_figures
from transformation.known_loops import known_loop, run_of

long = pytest.mark.skipif(not os.environ.get("SMARIG_LONG"), reason="takes a minute: SMARIG_LONG=1")


def inside(seeds, **options):
    """(loops, 4): whether each interval contains the true temperature; and the errors in spans."""
    hits, errors = [], []
    for seed in seeds:
        loop = known_loop(seed, **options)
        found = run_figures(run_of(loop.u, loop.y))
        assert set(TEMPERATURES) <= set(found.means), found.cycles[0].why_not
        own = [(found.means[n], loop.truth[n]) for n in TEMPERATURES]
        hits.append([d.ci95[0] <= true <= d.ci95[1] for d, true in own])
        errors.append([(d.value - true) / loop.span for d, true in own])
    return np.array(hits), np.array(errors)


def test_intervals_cover_the_true_temperatures():
    hits, errors = inside(range(60))
    assert 0.88 <= hits.mean() <= 0.99
    assert np.abs(np.median(errors, axis=0)).max() < 0.02
    assert np.sqrt(np.mean(errors**2)) < 0.05


@long
def test_intervals_cover_each_of_the_four_temperatures_over_many_loops():
    hits, _ = inside(range(1000, 1600))
    assert ((hits.mean(axis=0) >= 0.90) & (hits.mean(axis=0) <= 0.98)).all(), hits.mean(axis=0)


@pytest.mark.parametrize("kind", ["ramp", "logistic", "normal"])
def test_without_noise_the_temperatures_are_those_of_the_tangents(kind):
    _, errors = inside(range(8), kind=kind, noise=1e-6)
    assert np.abs(errors).max() < 0.03


def test_a_noisy_temperature_does_not_flatten_the_steep_tangent():
    """A regression of the output on a temperature with a noise of a third of the span would."""
    errors = []
    for seed in range(8):
        loop = known_loop(seed, kind="ramp", noise=0.001, cycles=12, input_noise=4.0)
        found = run_figures(run_of(loop.u, loop.y))
        errors.append([(found.means[n].value - loop.truth[n]) / loop.span for n in TEMPERATURES])
    heating = np.mean(errors, axis=0)
    assert abs(heating[1] - heating[0]) < 0.12, "A_f − A_s, in spans"
    assert abs(heating[2] - heating[3]) < 0.12, "M_s − M_f, in spans"


def test_the_interval_contains_the_choice_of_readings():
    """A curved plateau without noise: other choices of its readings give other temperatures."""
    loop = known_loop(3, kind="ramp", noise=1e-5, drift=0.0)
    straight = run_figures(run_of(loop.u, loop.y)).means["A_f"]
    curved = loop.y + 0.3 * np.ptp(loop.y) * np.maximum((loop.u - loop.truth["A_f"]) / loop.u.max(), 0) ** 2
    wide = run_figures(run_of(loop.u, curved)).means["A_f"]
    assert np.diff(wide.ci95)[0] > 5 * np.diff(straight.ci95)[0]


def test_the_noise_of_several_cycles_averages_but_the_choice_does_not():
    loops = [known_loop(4, kind="ramp", noise=0.02, drift=0.0, cycles=n) for n in (1, 16)]
    one, many = (run_figures(run_of(loop.u, loop.y)).means["M_s"] for loop in loops)
    assert 0.1 < np.diff(many.ci95)[0] / np.diff(one.ci95)[0] < 0.75
