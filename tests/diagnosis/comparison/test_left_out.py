"""Blocks left out in closed form, against conditioning written out and a fit without the block."""

import numpy as np
import pytest
from numpy.typing import NDArray

from smarig.diagnosis.comparison.block_predictions import NU, left_out

BLOCKS = [np.array([0, 1]), np.array([2, 3, 4]), np.array([5, 6]), np.array([7])]


def made(seed=1):
    rng = np.random.default_rng(seed)
    mixed = rng.standard_normal((8, 8))
    return mixed @ mixed.T + 0.5 * np.eye(8), rng.standard_normal(8)


def conditional(k, y, rows):
    """(error, covariance) of the readings of a block given all others."""
    others = np.setdiff1d(np.arange(8), rows)
    gain = k[np.ix_(rows, others)] @ np.linalg.inv(k[np.ix_(others, others)])
    return y[rows] - gain @ y[others], k[np.ix_(rows, rows)] - gain @ k[np.ix_(others, rows)]


def dual(k, y) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return np.asarray(np.linalg.inv(k), dtype=float), np.asarray(np.linalg.solve(k, y), dtype=float)


def test_errors_are_those_of_a_prediction_from_the_other_blocks():
    k, y = made()
    error, _ = left_out(*dual(k, y), BLOCKS)
    for rows in BLOCKS:
        assert error[rows] == pytest.approx(conditional(k, y, rows)[0])


def test_scores_are_multivariate_t_densities_of_these_errors():
    from scipy.stats import multivariate_t

    k, y = made(2)
    _, scores = left_out(*dual(k, y), BLOCKS)
    for rows, score in zip(BLOCKS, scores):
        error, covariance = conditional(k, y, rows)
        assert score == pytest.approx(multivariate_t(shape=covariance, df=NU).logpdf(error))


def test_readings_of_no_block_have_no_error():
    k, y = made()
    error, scores = left_out(*dual(k, y), BLOCKS[:2])
    assert np.isnan(error[5:]).all()
    assert scores.size == 2
