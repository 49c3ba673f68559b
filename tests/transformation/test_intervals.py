"""The 95 % intervals cover the true temperatures of loops whose tangents are known exactly."""

import numpy as np
import pytest

from report.pages import unpacked
from smarig.report.transformation.tangent_figures import tangent_figure
from smarig.transformation import TEMPERATURES, run_figures
from transformation.known_loops import known_loop, run_of

long = pytest.mark.long("takes a minute")


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


@pytest.mark.long("takes three seconds")
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


@pytest.mark.long
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


@pytest.mark.long("takes a second")
def test_the_noise_of_several_cycles_averages_but_the_choice_does_not():
    loops = [known_loop(4, kind="ramp", noise=0.02, drift=0.0, cycles=n) for n in (1, 16)]
    one, many = (run_figures(run_of(loop.u, loop.y)).means["M_s"] for loop in loops)
    assert 0.1 < np.diff(many.ci95)[0] / np.diff(one.ci95)[0] < 0.75


def with_a_hole(**options):
    """A loop, the readings about A_s that are left out (begin, end), and the run of the others."""
    loop = known_loop(5, **options)
    begin, end = loop.truth["A_s"] - 0.6 * loop.span, loop.truth["A_s"] + 0.2 * loop.span
    heating = np.arange(loop.u.size) < np.argmax(loop.u)
    kept = ~(heating & (loop.u > begin) & (loop.u < end))
    return loop, (begin, end), run_figures(run_of(loop.u[kept], loop.y[kept]))


@pytest.mark.parametrize("kind", ["ramp", "logistic", "normal"])
def test_a_start_between_readings_is_known_no_better_than_the_readings(kind):
    loop, (begin, end), found = with_a_hole(kind=kind, noise=0.002)
    low, high = found.means["A_s"].ci95
    assert low <= begin + 0.1 * loop.span
    assert high >= end - 0.1 * loop.span
    assert set(found.gaps) == {"A_s"}
    assert any("A_s lies between two readings" in note for note in found.notes)
    whole = run_figures(run_of(loop.u, loop.y))
    assert not whole.gaps
    assert np.diff(whole.means["A_s"].ci95) < 0.5 * (high - low)


def test_the_figure_draws_no_line_where_nothing_was_measured():
    _, (begin, end), found = with_a_hole(kind="ramp", noise=0.0)
    lines = {t["name"]: unpacked(t["x"]) for t in tangent_figure(found).panels[0].data}
    for name in ("heating", "all readings"):
        low, high = (
            np.minimum(lines[name][:-1], lines[name][1:]),
            np.maximum(lines[name][:-1], lines[name][1:]),
        )
        assert not ((low <= begin) & (high >= end)).any(), name
