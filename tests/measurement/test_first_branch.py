"""A first branch from another state: the output never comes back to where it began, though its far end is the same."""

import numpy as np
import pytest

from smarig.measurement import first_branch_differs, reversals, starting_state

CORNERS = (0.0, 100.0, 0.0, 100.0, 10.0, 80.0, 0.0)


def inputs(corners=CORNERS, rest=30, rows=150):
    legs = [np.linspace(a, b, rows)[1:] for a, b in zip(corners, corners[1:])]
    return np.concatenate([np.full(rest + 1, corners[0]), *legs])


def outputs(u, *, begins=-1.0, drift=0.0):
    """Two plays, of which both begin at the other end for ``begins`` = −1, with noise."""
    y = np.empty(u.size)
    wide, narrow = u[0] + 20.0 * begins, u[0] + 5.0 * begins
    for k, value in enumerate(u):
        wide, narrow = (min(max(state, value - r), value + r) for state, r in ((wide, 20.0), (narrow, 5.0)))
        y[k] = wide + narrow
    return y + drift * np.arange(u.size) / u.size + np.random.default_rng(1).normal(0, 0.1, u.size)


def noisy(u):
    return u + np.random.default_rng(2).normal(0, 0.02, u.size)


@pytest.mark.parametrize("rest", [0, 30, 200])
@pytest.mark.parametrize("corners", [CORNERS, CORNERS[:5], tuple(100 - c for c in CORNERS)])
def test_the_first_branch_is_left_out(corners, rest):
    exact = inputs(corners, rest)
    u, falls = noisy(exact), corners[0] > 50
    y = -outputs(-exact) if falls else outputs(exact)
    start = starting_state(None, u, (float(u.min()), float(u.max())), outputs=y, turns=reversals(u, 0.02))
    assert start.contradicted
    assert abs(u[start.first] - corners[1]) < 0.2, "the first branch ends where the input turns"


@pytest.mark.parametrize(
    ("begins", "drift"),
    [(1.0, 0.0), (1.0, 12.0), (1.0, -30.0)],  # +1: as after any later branch; drift moves both ends
)
def test_a_drift_is_no_other_state(begins, drift):
    exact = inputs()
    u = noisy(exact)
    y = outputs(exact, begins=begins, drift=drift)
    assert not first_branch_differs(u, y, reversals(exact))


def test_a_loop_that_is_never_closed_again_says_nothing():
    exact = inputs((0.0, 100.0, 0.0))
    assert not first_branch_differs(exact, outputs(exact), reversals(exact))
