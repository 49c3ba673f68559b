"""What may pass for noise is found and set aside, and nothing is where nothing is wrong."""

import numpy as np
import pytest

from smarig.diagnosis.spreads import START, Stack
from smarig.diagnosis.suspects import suspect

N = 120
LOW, HIGH = np.array([-6.0, -6.0, -9.0, -5.0, -5.0, -3.0]), np.array([2.0, 2.0, 0.0, -1.0, -1.0, 0.0])


@pytest.fixture
def made():
    """Readings of white noise under a draught, whose memory is that of a random walk; traces that might be wrong."""
    rng = np.random.default_rng(5)
    walk = np.minimum.outer(np.arange(N), np.arange(N)) / N
    smooth = [np.cos(np.pi * k * np.arange(N) / N)[:, None] for k in (1, 2, 3)]
    steps = [np.where(np.arange(N) < k, 0.0, 1.0)[:, None] for k in (30, 60, 90)]
    noise = 1e-3 * rng.standard_normal(N) + 0.05 * np.linalg.cholesky(
        walk + 1e-12 * np.eye(N)
    ) @ rng.standard_normal(N)

    def stack(more):
        zeros = np.zeros((N, N))
        return Stack(
            noise + more,
            (zeros, zeros, zeros),
            np.zeros((N, N)),
            np.full(N, 1e-4),
            np.zeros(N),
            np.ones(N),
            (LOW, HIGH),
        )

    return stack, walk, [*smooth, *steps]


def test_what_is_wrong_is_set_aside(made):
    stack, walk, sets = made
    one = stack(0.6 * sets[4][:, 0])
    found = one.likeliest(walk, START)
    aside = suspect(one, walk, found, sets)
    assert aside is sets[4]
    assert 10 ** one.likeliest(walk, START, aside)[1][-1] < 0.8 * 10 ** found[1][-1]


def test_nothing_is_set_aside_where_nothing_is_wrong(made):
    stack, walk, sets = made
    one = stack(0.0)
    assert suspect(one, walk, one.likeliest(walk, START), sets) is None
