"""The FORC diagram and the central ridge, on curves summed relay by relay from known densities."""

import numpy as np
import pytest

from smarig.core.errors import DataError, UsageError
from smarig.identification import FodData, central_ridge, forc_diagram

STEP = 2.0  # mT


def relay_moments(h_c, h_u, weight, reversal, field):
    """Moment of relays after saturation, a fall to ``reversal`` and a rise to ``field``."""
    up, down = h_u + h_c, h_u - h_c

    def of(rows):
        fell = reversal[rows, None] <= down
        rose = field[rows, None] >= up
        return np.where(fell & ~rose, -1.0, 1.0) @ weight

    parts = np.array_split(np.arange(field.size), 20)  # all relays at all rows would be 150 MB
    return np.concatenate([of(rows) for rows in parts])


def reversal_curves(h_c, h_u, weight, *, noise=0.0, curves=60, low=-90.0, seed=0):
    """FodData (mirrored, as of a magnetometer) of curves that rise to 120 mT from 60 reversal fields."""
    random = np.random.default_rng(seed)
    reversals = 30.0 - STEP * np.arange(curves)
    field = [
        np.arange(r, 120.0, STEP) + random.uniform(-0.1, 0.1) * (np.arange(r, 120.0, STEP) > r)
        for r in reversals
    ]
    curve = np.concatenate([np.full(f.size, k) for k, f in enumerate(field)])
    fields = np.concatenate(field)
    moment = relay_moments(h_c, h_u, weight, reversals[curve], fields)
    moment = moment + noise * random.standard_normal(moment.size)
    alpha = -reversals[curve]
    return FodData(
        alpha, -fields, -moment, curve, alpha == -fields, np.zeros_like(curve), np.arange(curve.size), "A m^2",
        float((-fields).min()), float(alpha.max()), True,
    )  # fmt: skip


def gaussian_relays(centre=(40.0, -5.0), widths=(10.0, 8.0)):
    """Relays on a fine grid in (H_c > 0, H_u) with Gaussian weights; a width of zero is a line."""
    axes = [m + np.linspace(-3.5, 3.5, 71 if s else 1) * s for m, s in zip(centre, widths)]
    h_c, h_u = (grid.ravel() for grid in np.meshgrid(*axes))
    scaled = ((h_c - centre[0]) / widths[0]) ** 2 + ((h_u - centre[1]) / (widths[1] or 1.0)) ** 2
    weight = np.where(h_c > 0, np.exp(-scaled / 2), 0.0)
    return h_c, h_u, weight / weight.sum()


@pytest.fixture(scope="module")
def broad():
    """Interacting particles: a resolved Gaussian."""
    return reversal_curves(*gaussian_relays(), noise=2e-4)


@pytest.fixture(scope="module")
def ridged():
    """Half of the particles at H_u = 0 exactly, half spread over 25 mT."""
    wide = gaussian_relays((35.0, 0.0), (15.0, 25.0))
    thin = gaussian_relays((40.0, 0.0), (12.0, 0.0))
    h_c, h_u, weight = (np.concatenate(pair) for pair in zip(wide, thin))
    return reversal_curves(h_c, h_u, weight / 2, noise=2e-4)


@pytest.mark.long("takes a second")
def test_the_peak_lies_where_most_relays_are(broad):
    peak = forc_diagram(broad).peak
    assert peak.half_width == pytest.approx(40.0, abs=2.5)
    assert peak.centre == pytest.approx(-5.0, abs=2.0)
    assert peak.mu == pytest.approx(
        1 / (2 * np.pi * 10 * 8) / 2, rel=0.12
    )  # dα dβ = 2 dH_c dH_u, and ±1: μ = w
    assert 2.355 * 10 * 0.9 < peak.fwhm_half_width < 2.355 * 10 * 1.25
    assert 2.355 * 8 * 0.9 < peak.fwhm_centre < 2.355 * 8 * 1.25


@pytest.mark.long
def test_standard_errors_are_those_of_repeated_noise():
    relays = gaussian_relays()
    diagrams = [forc_diagram(reversal_curves(*relays, noise=2e-3, seed=s), factor=4.0) for s in range(8)]
    spread = np.std([d.mu for d in diagrams], axis=0, ddof=1)
    ratio = spread / np.mean([d.se for d in diagrams], axis=0)
    assert np.nanmedian(ratio) == pytest.approx(1.0, abs=0.12)


def test_noise_alone_shows_nothing():
    nothing = (np.array([1000.0]), np.array([0.0]), np.array([1.0]))
    data = reversal_curves(*nothing, noise=1.0, seed=5)
    diagram = forc_diagram(data, factor=4.0)
    assert diagram.significant_share == pytest.approx(0.05, abs=0.04)
    assert central_ridge(data, diagram) is None or not central_ridge(data, diagram).present


@pytest.mark.long("takes three seconds")
def test_a_ridge_is_told_from_its_background(ridged):
    ridge = central_ridge(ridged, forc_diagram(ridged))
    assert ridge.present
    assert ridge.centre == pytest.approx(0.0, abs=STEP / 2)
    assert ridge.fwhm < 1.5 * ridge.resolution
    assert 0.2 < ridge.share < 0.8


@pytest.mark.long("takes two seconds")
def test_a_resolved_distribution_is_no_ridge(broad):
    ridge = central_ridge(broad, forc_diagram(broad))
    assert not ridge.present
    assert ridge.fwhm == pytest.approx(2.355 * 8, rel=0.2)


@pytest.mark.long("takes two seconds")
def test_few_curves_are_not_searched_for_a_ridge():
    data = reversal_curves(*gaussian_relays(), noise=2e-4, curves=20)
    assert central_ridge(data, forc_diagram(data)) is None


def test_a_given_factor_is_used_and_a_wrong_one_refused(broad):
    diagram = forc_diagram(broad, factor=3.0)
    assert (diagram.estimate.nearest, diagram.estimate.degree, diagram.tried) == (49, 2, ())
    assert diagram.smoothing_factor == pytest.approx(3.0)
    for wrong in (0.0, -1.0, float("nan"), 1e6):
        with pytest.raises(UsageError, match="smoothing factor"):
            forc_diagram(broad, factor=wrong)


@pytest.mark.long("takes a second")
def test_the_chosen_factor_has_the_least_error_of_those_tried(broad):
    diagram = forc_diagram(broad)
    best = min(diagram.tried, key=lambda choice: choice.error)
    assert (diagram.estimate.nearest, diagram.estimate.degree) == (best.nearest, best.degree)


def test_nothing_is_drawn_far_from_the_points(broad):
    diagram = forc_diagram(broad, factor=3.0)
    h, c = np.meshgrid(diagram.half_width, diagram.centre)
    beyond = (c + h > 120.0 + 2 * STEP) | (c - h < -90.0 - 2 * STEP)
    assert beyond.any()
    assert np.isnan(diagram.mu[beyond]).all()


def test_points_on_one_line_are_refused(broad):
    with pytest.raises(DataError, match=r"one line|single curve"):
        forc_diagram(broad.where(broad.curve == 0))
