"""The surface (5.5) is recovered from encoder readings, with correct intervals."""

import os

import numpy as np
import pytest

from identification.made_runs import fod_run
from smarig.core.errors import DataError, UsageError
from smarig.identification.fod_data import fod_data, select
from smarig.identification.surface.surface_fit import fit_surface
from smarig.identification.surface.surface_jacobian import jacobian
from smarig.preisach.hysteresis.fod_surface import FodSurface
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_SURFACES, thesis_surface

FORM = {"c": "constant", "p": "parabolic", "e": "exponential"}
SEEDS = range(20 if os.environ.get("SMARIG_LONG") else 10)


@pytest.fixture(scope="module")
def fits():
    """Fits of noisy FOD data by surface name, one per seed, together with the noise-free truth."""
    return {
        name: [fit_surface(fod_data(fod_run(name, seed=seed)), FORM[name[-1]]) for seed in SEEDS]
        for name in ("one_e", "two_c", "two_e")
    }


def truth_of(s):
    return np.array([*s.x, s.y_upper, s.y_lower])


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_jacobian_is_the_slope_of_the_surface(name):
    s = thesis_surface(name)
    rng = np.random.default_rng(1)
    alpha = rng.uniform(s.lower, s.upper, 40)
    beta = s.lower + rng.uniform(0, 1, 40) * (alpha - s.lower)
    p0 = truth_of(s)

    def of(p):
        return FodSurface(s.form, tuple(p[:-2]), s.lower, s.upper, p[-1], p[-2])

    J = jacobian(s, alpha, beta)
    for k, scale in enumerate(np.where(p0 == 0, 1.0, np.abs(p0))):
        h = 1e-5 * scale
        up, down = p0.copy(), p0.copy()
        up[k] += h
        down[k] -= h
        numeric = (of(up).y(alpha, beta) - of(down).y(alpha, beta)) / (2 * h)
        assert np.allclose(J[:, k], numeric, rtol=1e-6, atol=1e-7 * np.abs(J[:, k]).max())


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_exact_data_gives_the_exact_surface(name):
    data = fod_data(fod_run(name))
    fit = fit_surface(data, FORM[name[-1]])
    assert fit.converged
    assert fit.rms < 1e-6
    assert fit.points == len(data)
    assert np.allclose(fit.surface.y(data.alpha, data.beta), data.y, atol=1e-5)
    assert np.allclose(fit.values, truth_of(thesis_surface(name)), rtol=1e-4, atol=1e-4)


@pytest.mark.long("takes five seconds")
def test_one_e_is_found_within_the_stated_error(fits):
    s = thesis_surface("one_e")
    data = fod_data(fod_run("one_e"))
    grid = np.linspace(s.lower, s.upper, 121)
    a, b = np.meshgrid(grid, grid, indexing="ij")
    a, b = a[b <= a], b[b <= a]
    rms = [np.sqrt(np.mean((f.surface.y(data.alpha, data.beta) - data.y) ** 2)) for f in fits["one_e"]]
    mu = s.density(a, b)
    off = [np.abs(f.surface.density(a, b) - mu).max() / np.abs(mu).max() for f in fits["one_e"]]
    assert np.median(rms) <= 0.03
    assert max(rms) <= 0.04  # mm; one count is 0.047
    assert np.median(off) <= 0.04
    assert max(off) <= 0.08


def test_two_c_parameters_are_found_within_the_stated_error(fits):
    truth = np.array(thesis_surface("two_c").x)
    worst = [np.abs(f.values[:4] / truth - 1).max() for f in fits["two_c"]]
    assert np.median(worst) <= 0.03
    assert max(worst) <= 0.07


def test_intervals_cover_as_often_as_they_say(fits):
    inside = [
        low <= value <= high
        for name, several in fits.items()
        for fit in several
        for (low, high), value in zip(fit.intervals.values(), truth_of(thesis_surface(name)), strict=True)
    ]
    assert 0.90 <= np.mean(inside) <= 0.99


def test_sigma_is_the_noise_of_a_reading_whatever_the_weights():
    expected = np.sqrt(0.4**2 + 1 / 12) * 0.18  # reading noise and rounding to whole counts
    for weights in ("residual", "square"):
        sigma = [
            fit_surface(fod_data(fod_run("two_c", seed=k)), "constant", weights=weights).sigma
            for k in range(8)
        ]
        assert np.sqrt(np.mean(np.square(sigma))) == pytest.approx(expected, rel=0.12)


def test_weights_pull_the_fit_towards_the_major_loop():
    data = fod_data(fod_run("one_e"))  # a constant f cannot follow this data: weighting matters
    by = {w: fit_surface(data, "constant", weights=w) for w in ("residual", "square")}

    def on_major(fit):
        e = fit.surface.y(data.alpha, data.beta) - data.y
        return float(np.sum(e[data.major] ** 2))

    assert on_major(by["residual"]) < on_major(by["square"])
    assert by["residual"].sse > by["square"].sse
    for w, factor in (("residual", 4.0), ("square", 2.0)):
        e = by[w].surface.y(data.alpha, data.beta) - data.y
        weighted = np.sum(np.where(data.major, factor, 1.0) * e**2)
        assert by[w].weighted_sse == pytest.approx(weighted, rel=1e-9)
        assert by[w].norm2 == pytest.approx(np.sqrt(by[w].sse))
        assert by[w].weighted_norm2 == pytest.approx(np.sqrt(weighted))
        assert by[w].rms == pytest.approx(np.sqrt(by[w].sse / 65))


def test_the_fit_is_a_minimum():
    data = fod_data(fod_run("one_e", seed=3))
    fit = fit_surface(data, "exponential")
    root = np.where(data.major, 2.0, 1.0)
    e = (fit.surface.y(data.alpha, data.beta) - data.y) * root
    J = jacobian(fit.surface, data.alpha, data.beta) * root[:, None]
    alignment = np.abs(J.T @ e) / (np.linalg.norm(J, axis=0) * np.linalg.norm(e))
    assert alignment.max() < 1e-4


def test_anchored_ends_are_the_measured_ones():
    data = fod_data(fod_run("two_c", seed=1))
    fit = fit_surface(data, "constant", anchor=True)
    ends = data.y[data.beta == data.lower]
    assert fit.names == ("x2", "x3", "x4", "x5")
    assert fit.covariance.shape == (4, 4)
    assert fit.surface.y_lower == pytest.approx(ends.mean(), abs=1e-12)
    assert fit.surface.y_upper == data.y[(data.alpha == 185) & (data.beta == 185)][0]
    with pytest.raises(DataError, match="Anchoring needs"):
        fit_surface(select(data, "alpha < 185"), "constant", anchor=True)


def test_half_the_curves_predict_the_other_half():
    data = fod_data(fod_run("one_e", seed=5))
    odd = select(data, "curve%2==1")  # with the major loop
    fit = fit_surface(odd, "exponential")
    even = select(fod_data(fod_run("one_e")), "curve%2==0")
    error = fit.surface.y(even.alpha, even.beta) - even.y
    assert np.sqrt(np.mean(error**2)) < 0.06


def test_an_encoder_zero_elsewhere_moves_the_ends_only():
    run = fod_run("two_p", offset=-7.25)
    fit = fit_surface(fod_data(run), "parabolic")
    assert np.allclose(
        fit.values, truth_of(thesis_surface("two_p")) - np.r_[np.zeros(6), 7.25, 7.25], rtol=1e-4
    )


def test_what_cannot_be_fitted_is_reported():
    data = fod_data(fod_run("one_e"))
    with pytest.raises(DataError, match="needs 9 FOD points or more; there are 6"):
        fit_surface(select(data, "curve == 0 or curve == 2"), "exponential")
    with pytest.raises(UsageError, match="must be one of constant"):
        fit_surface(data, "cubic")
    with pytest.raises(UsageError, match="not one of residual"):
        fit_surface(data, weights="triple")
