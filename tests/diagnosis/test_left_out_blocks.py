"""Blocks predicted from all others, against Gaussian conditioning written out."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from smarig.diagnosis.explain.left_out_blocks import left_out_blocks

BLOCK = np.array([0, 0, 1, 1, 1, 2, 2, 3])
FREE_SD = 1e4  # of a strength: practically free


def made(seed=1):
    """(timeline, refit, covariance, readings) of eight readings in four blocks."""
    rng = np.random.default_rng(seed)
    mixed = rng.standard_normal((8, 8))
    C = mixed @ mixed.T + 0.5 * np.eye(8)
    y = rng.standard_normal(8)
    factor = np.linalg.cholesky(C)
    timeline: Any = SimpleNamespace(block=BLOCK, all_readings=[SimpleNamespace(step=np.arange(8))])
    refitted: Any = SimpleNamespace(
        factor=factor, data=np.linalg.solve(factor, y), whitened=lambda t: np.linalg.solve(factor, t)
    )
    return timeline, refitted, C, y


def conditional(C, y, own):
    """(error, log density but for its constant) of the readings ``own`` given the others."""
    gain = C[np.ix_(own, ~own)] @ np.linalg.inv(C[np.ix_(~own, ~own)])
    error = y[own] - gain @ y[~own]
    covariance = C[np.ix_(own, own)] - gain @ C[np.ix_(~own, own)]
    return error, -0.5 * np.linalg.slogdet(covariance)[1] - 0.5 * error @ np.linalg.inv(covariance) @ error


def test_each_block_is_predicted_from_the_others():
    timeline, refitted, C, y = made()
    found = left_out_blocks(timeline, refitted)
    for b in range(4):
        error, log_density = conditional(C, y, b == BLOCK)
        np.testing.assert_allclose(found.error[b == BLOCK], error, atol=1e-9)
        assert found.log_density[b] == pytest.approx(log_density)
        rest = np.linalg.inv(np.linalg.inv(C)[np.ix_(b == BLOCK, b == BLOCK)])
        np.testing.assert_allclose(found.sd[b == BLOCK] ** 2, np.diag(rest))


def test_free_strengths_are_fitted_to_the_other_blocks():
    timeline, refitted, C, y = made()
    trace = np.random.default_rng(2).standard_normal((8, 1))
    y = y + 5.0 * trace[:, 0]
    refitted.data = np.linalg.solve(refitted.factor, y)
    found = left_out_blocks(timeline, refitted, trace)
    for b in range(4):
        error, _ = conditional(C + FREE_SD**2 * trace @ trace.T, y, b == BLOCK)
        np.testing.assert_allclose(found.error[b == BLOCK], error, atol=1e-5)
    assert np.abs(found.error).max() < np.abs(left_out_blocks(timeline, refitted).error).max()


def test_a_block_that_alone_determines_a_strength_is_predicted_by_nothing():
    """A law whose knot only one excursion reaches."""
    timeline, refitted, *_ = made()
    trace = np.where(BLOCK == 3, 1.0, 0.0)[:, None]  # a block of one reading
    found = left_out_blocks(timeline, refitted, trace)
    assert found.log_density[3] == -np.inf
    assert np.all(np.isfinite(found.log_density[:3]))
