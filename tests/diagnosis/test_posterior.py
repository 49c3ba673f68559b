"""The posterior density of readings: a normal's conditional mean, or the nearest measure to it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import cho_solve, cholesky

from diagnosis.made_memories import prediction_for_inputs
from smarig.diagnosis.refit.density_posterior import DensityPosterior
from smarig.diagnosis.refit.density_prior import density_prior
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach

WIRE = thesis_surface("one_c")  # nowhere negative
STROKE = WIRE.everett(WIRE.upper, WIRE.lower)
NOISE, FREE_ZERO_SD, ZERO = 1e-4, 30.0, 0.3  # strokes
VARIANCES = np.array([1.0, 0.2, 1e-4])


def least_mass(table):
    """Of all cells off the diagonal."""
    y = table.values
    mass = y[1:, 1:] - y[1:, :-1] - y[:-1, 1:] + y[:-1, :-1]
    return mass[np.tri(len(mass), k=-1, dtype=bool)].min()


@pytest.fixture(scope="module")
def path():
    """Through both saturations, then to and fro where the wire moves."""
    levels = np.linspace(0.0, WIRE.upper, 41)
    return np.array([levels[-1], levels[0], *levels[np.random.default_rng(2).integers(12, 28, 60)]])


def outputs(hysteresis, inputs):
    return Preisach(hysteresis).simulate(inputs)


@pytest.fixture(scope="module")
def read(path):
    """Readings of a wire that transforms at lower temperatures, above a zero of the encoder's own."""
    return outputs(WIRE, WIRE.upper * (path / WIRE.upper) ** 0.75) + ZERO * STROKE


def posterior_of(path, read, kept=slice(None)):
    """Of the readings kept."""
    whole = prediction_for_inputs(WIRE, path)
    output, n = whole.output[kept], whole.output[kept].size
    prediction = replace(
        whole,
        states=whole.states[kept],
        output=output,
        tick_index=whole.tick_index[kept],
        output_slope=np.ones(n),
    )
    prior = density_prior(prediction, WIRE)
    density = np.sum([v * part for v, part in zip(VARIANCES, prior.covariances)], axis=0)
    free = np.full((n, n), FREE_ZERO_SD**2)
    factor = cholesky(density + free + NOISE**2 * np.eye(n), lower=True)
    dual_weights = cho_solve((factor, True), (read[kept] - WIRE.y_lower) / STROKE - prior.outputs(prior.mass))
    ones = np.ones(n)
    return DensityPosterior(
        prior,
        VARIANCES,
        ones,
        factor,
        free,
        dual_weights,
        density @ dual_weights,
        STROKE * ones,
        STROKE,
        WIRE.y_lower,
        "mm",
    )


@pytest.fixture(scope="module")
def posterior(path, read):
    return posterior_of(path, read)


def test_where_they_may_not_none_is_and_the_outputs_stay(path, read, posterior):
    table = posterior.table()
    assert least_mass(table) > -1e-9 * STROKE
    assert np.sqrt(np.mean((outputs(table, path) - read) ** 2)) < 0.001 * STROKE


def test_an_undetermined_zero_is_counted_once_with_the_density(path, read):
    """Saturations are not read: what cut masses lose is shared by the others and the zero, and no more than that."""
    kept = slice(2, None)
    table = posterior_of(path, read, kept).table()
    assert least_mass(table) > -1e-9 * STROKE
    assert np.sqrt(np.mean((outputs(table, path) - read)[kept] ** 2)) < 0.001 * STROKE
