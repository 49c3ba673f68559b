"""Outputs of any smooth density and of grains: what memory states have in common for every density."""

import numpy as np
import pytest

from diagnosis.made_memories import prediction_for_inputs
from smarig.diagnosis.refit.density_prior import MIN_PRIOR_SHARE, SMOOTHING, density_prior
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach

WIRE = thesis_surface("one_e")
LEVELS = np.linspace(0.0, WIRE.upper, 41)


def wander(n, seed):
    """Levels of a partition, from saturation to and fro where the wire moves."""
    rng = np.random.default_rng(seed)
    return [LEVELS[-1], LEVELS[0], *LEVELS[rng.integers(12, 28, n)]]


def priors(inputs):
    """Covariances at the memories of a path that is read at every point: the smooth one first, grains last."""
    prediction = prediction_for_inputs(WIRE, inputs)
    return density_prior(prediction, WIRE).covariances


def table(masses):
    """The FOD table of cells' masses (i, j), j ≤ i, on the partition: what is on after a rise to α and a fall to β."""
    n = LEVELS.size
    y = np.zeros((n, n))
    y[1:, 1:] = np.cumsum(np.cumsum(np.where(np.tri(n - 1, dtype=bool), masses, 0.0), axis=0), axis=1)
    y[~np.tri(n, dtype=bool)] = np.nan
    return FodTable.from_arrays(LEVELS, LEVELS, y)


def model_density():
    """The model's own masses on the partition, shares of all."""
    F = np.array([[WIRE.everett(a, min(a, b)) for b in LEVELS] for a in LEVELS])
    mass = F[1:, :-1] - F[:-1, :-1] - np.where(np.eye(len(F) - 1, dtype=bool), 0.0, F[1:, 1:] - F[:-1, 1:])
    mass = np.where(np.tri(len(mass), dtype=bool), np.abs(mass), 0.0)
    return mass / mass.sum()


def bumps(rng):
    """The model's density times a smooth factor of either sign, a few bumps wide against the cells."""
    centre = (LEVELS[1:] + LEVELS[:-1]) / 2
    a, b = np.meshgrid(centre, centre, indexing="ij")
    total = np.zeros_like(a)
    for _ in range(8):
        at_a, at_b = rng.uniform(50.0, 110.0, 2)
        wide = rng.uniform(12.0, 25.0)
        total += rng.normal() * np.exp(-((a - at_a) ** 2 + (b - at_b) ** 2) / (2 * wide**2))
    return total * model_density()


def outputs(masses, inputs):
    """At every point of a path."""
    return Preisach(table(masses)).simulate(inputs)


@pytest.fixture(scope="module")
def path():
    return wander(60, seed=2)


@pytest.fixture(scope="module")
def covariances(path):
    return priors(path)


def test_covariances_are_symmetric_and_of_no_negative_variance(covariances, path):
    for C in covariances:
        assert C.shape == (len(path), len(path))
        np.testing.assert_allclose(C, C.T, rtol=0, atol=1e-12 * C.max())
        values = np.linalg.eigvalsh(C)
        assert values[-1] > 0
        assert values[0] > -1e-9 * values[-1]


def test_nothing_is_free_in_negative_saturation_and_much_elsewhere(covariances, path):
    """There every relay is off, whatever the density."""
    off = np.flatnonzero(np.array(path) == 0.0)
    for C in covariances:
        assert np.abs(C[off]).max() < 1e-12 * C.max()
        assert C[0, 0] > 0.9 * C.max()  # positive saturation: all of them


def test_equal_memories_have_equal_outputs_in_every_draw():
    """A loop that closes returns to the same memory; two minor loops between other turns do not."""
    inputs = [LEVELS[k] for k in (40, 0, 22, 16, 20, 16, 20, 18, 26, 16, 20)]
    for C in priors(inputs):
        apart = np.diag(C)[:, None] + np.diag(C)[None, :] - 2 * C
        assert apart[3, 5] < 1e-9 * C.max()
        assert apart[4, 6] < 1e-9 * C.max()
        np.testing.assert_allclose(C[4], C[6], atol=1e-9 * C.max())
        assert apart[4, 10] > 1e-5 * C.max()  # as high, but after a fall from 26


def test_a_smooth_density_is_predicted_from_its_readings(covariances, path):
    """For a scale that one half of the readings gives, the other half lies where it must, within its sd."""
    smooth = covariances[0] + 0.1 * covariances[1]  # mostly broad, a little fine
    order = np.random.default_rng(7).permutation(len(path))
    seen, hidden = order[::2], order[1::2]
    for seed in range(5):
        y = outputs(bumps(np.random.default_rng(seed)), path)
        fuzz = (1e-4 * np.ptp(y)) ** 2
        scale = _scale(smooth[np.ix_(seen, seen)], y[seen], fuzz)
        C = scale * smooth + fuzz * np.eye(y.size)
        gain = np.linalg.solve(C[np.ix_(seen, seen)], C[np.ix_(seen, hidden)]).T
        error = y[hidden] - gain @ y[seen]
        left = C[np.ix_(hidden, hidden)] - gain @ C[np.ix_(seen, hidden)]
        chi2 = error @ np.linalg.solve(left, error) / error.size
        assert 0.05 < chi2 < 5
        assert np.std(error) < 0.2 * np.std(y)


def test_cells_whose_signs_are_a_matter_of_chance_ask_for_a_much_larger_scale_for_their_size(
    covariances, path
):
    smooth, ratios = covariances[0] + 0.1 * covariances[1], []
    for seed in range(5):
        rng = np.random.default_rng(seed)
        masses = bumps(rng)
        scales = []
        for m in (masses, masses * rng.choice([-1.0, 1.0], masses.shape)):
            y = outputs(m, path)
            scales.append(_scale(smooth, y, (1e-4 * np.ptp(y)) ** 2) / np.mean(y**2))
        ratios.append(scales[1] / scales[0])
    assert min(ratios) > 10
    assert np.median(ratios) > 100


def _scale(C, y, fuzz):
    """The v of largest likelihood for y ~ N(0, v C + fuzz), on a grid of eighths of decades."""
    values, vectors = np.linalg.eigh(C / np.trace(C))
    squares = (vectors.T @ y) ** 2
    v = np.logspace(-4, 12, 129) * np.mean(y**2)
    values = np.where(values > 1e-12, values, 0.0)  # the rest are rounding
    spread = v[:, None] * values + fuzz
    best = np.argmin(np.sum(squares / spread + np.log(spread), axis=1))
    return v[best] / np.trace(C)


@pytest.mark.long("takes two seconds")
def test_grains_are_independent_cell_errors_in_proportion_to_the_model_mass():
    """Masses are drawn on a partition of the test's own: white noise does not mind how it is cut."""
    inputs, draws = wander(12, seed=8), 1500
    grains = priors(inputs)[-1]
    rng = np.random.default_rng(11)
    sd = np.sqrt(model_density())
    y = np.array([outputs(sd * rng.standard_normal(sd.shape), inputs) for _ in range(draws)])
    drawn = y.T @ y / draws
    error = np.sqrt((np.outer(np.diag(grains), np.diag(grains)) + grains**2) / draws)
    assert np.all(
        np.abs(drawn - grains) < 5 * error + MIN_PRIOR_SHARE
    )  # what cells hold beyond what is believed of them
    assert grains[0, 0] == pytest.approx(1 + MIN_PRIOR_SHARE, abs=0.005)


FUZZ = 1e-5  # of a stroke
VARIANCES = np.array([0.1, 0.02, 1e-6])  # of broad and fine factors, and of grains


@pytest.fixture(scope="module")
def prior_about_model(path):
    """The free density about masses that are nowhere negative, with a prior as rough as they are."""
    hysteresis = table(model_density())
    prediction = prediction_for_inputs(hysteresis, path)
    return density_prior(prediction, hysteresis, smoothing=0.0)


def posterior_masses(density, y):
    """Masses when the outputs (n,) turned out so much larger than believed."""
    C = np.sum([v * part for v, part in zip(VARIANCES, density.covariances)], axis=0)
    return density.posterior_masses(VARIANCES, np.linalg.solve(C + FUZZ**2 * np.eye(y.size), y))


def smoothly_perturbed(seed):
    """Masses of a density that is up to two thirds more or less than the believed one, smoothly."""
    change = bumps(np.random.default_rng(seed))
    return model_density() + 0.65 * change / np.abs(change / np.maximum(model_density(), 1e-12)).max()


@pytest.mark.parametrize("seed", range(5))
def test_the_refitted_density_predicts_a_path_without_readings(path, prior_about_model, seed):
    truth, elsewhere = smoothly_perturbed(seed), wander(60, seed=100 + seed)
    masses = posterior_masses(prior_about_model, outputs(truth, path) - outputs(model_density(), path))
    found = Preisach(prior_about_model.triangle.table(masses, 0.0)).simulate(elsewhere)
    y, before = outputs(truth, elsewhere), outputs(model_density(), elsewhere)
    assert (masses >= np.minimum(prior_about_model.mass, 0.0)).all()
    assert np.std(found - y) < 0.1 * np.std(before - y)


def test_masses_become_no_more_negative_than_they_were_for_any_dual_weights(path, prior_about_model):
    for seed in range(5):
        dual_weights = 1e3 * np.random.default_rng(seed).standard_normal(len(path))
        masses = [prior_about_model.posterior_masses(VARIANCES, sign * dual_weights) for sign in (1, -1)]
        assert np.min(masses) == min(prior_about_model.mass.min(), 0.0)
        assert np.max(masses) > 2 * prior_about_model.mass.max()


def test_with_zero_dual_weights_the_density_is_the_models(path, prior_about_model):
    masses = prior_about_model.posterior_masses(VARIANCES, np.zeros(len(path)))
    kept = Preisach(prior_about_model.triangle.table(masses, 0.0))
    np.testing.assert_allclose(kept.simulate(path), outputs(model_density(), path), atol=1e-9)


def test_a_smooth_prior_keeps_the_mass_and_takes_little_of_the_model_away(path):
    hysteresis = table(model_density())
    prior = density_prior(prediction_for_inputs(hysteresis, path), hysteresis)
    kept = Preisach(prior.triangle.table(prior.mass, 0.0)).simulate(path)
    model = outputs(model_density(), path)
    np.testing.assert_allclose(kept, prior.outputs(prior.mass), atol=1e-9)
    assert prior.mass.sum() == pytest.approx(1.0)
    assert 0 < np.std(kept - model) < 0.02 * np.std(model)


def test_deviations_of_a_smooth_prior_do_not_follow_a_single_cell():
    """Of two densities that differ in neighbouring cells only, a smooth prior makes nearly the same."""
    rough, smooth = model_density(), model_density()
    i, j = np.unravel_index(np.argmax(rough), rough.shape)
    moved = 0.8 * rough[i, j]
    rough[i, j] -= moved
    rough[i, j - 1] += moved
    inputs = wander(60, seed=5)

    def differ(smoothing):
        shapes = [
            density_prior(prediction_for_inputs(h, inputs), h, smoothing=smoothing).prior_scale
            for h in (table(rough), table(smooth))
        ]
        return np.abs(shapes[0] - shapes[1]).sum() if shapes[0].shape == shapes[1].shape else np.inf

    assert differ(SMOOTHING) < 0.7 * differ(0.0)


def test_levels_that_differ_by_rounding_only_are_one():
    """An input that is held at its lower end by a dead zone is nearly, but not exactly, there."""
    inputs = np.array(wander(60, seed=7))
    inputs[::9] = 1e-300 * np.arange(inputs[::9].size)
    with np.errstate(all="raise", under="ignore"):
        prior = density_prior(prediction_for_inputs(WIRE, inputs), WIRE)
    assert np.isfinite(prior.prior_scale).all()
