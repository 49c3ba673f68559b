"""The partition of the triangle is dense where the output moves along its branches, whatever the turns are."""

import numpy as np
import pytest

from smarig.identification.positive.adapted_partition import adapted_nodes
from smarig.identification.positive.observations import Observations, excursions
from smarig.identification.positive.positive_fit import fit_positive
from smarig.preisach import Preisach, thesis_surface

SIGMA = 0.002


def cycles(gap):
    """Three cycles from about 0 to 100, whose minima differ by up to twice the gap."""
    lows = np.array([0.0, 1.0, 2.0, 0.5]) * gap
    ramps = [
        np.linspace(a, b, 101)[:-1]
        for low, after in zip(lows, lows[1:])
        for a, b in ((low, 100.0), (100.0, after))
    ]
    return np.concatenate(ramps)


def seen(u, y):
    operator, states = Preisach(thesis_surface("one_e"), "negative"), []
    for v in u:
        operator.step(v)
        states.append(operator.state)
    noisy = y + SIGMA * np.random.default_rng(1).standard_normal(u.size)
    return Observations.of_states(states, noisy, excursions(u, 1.0), (0.0, 100.0))


def function(u):
    return 4 + 3 * np.tanh((u - 55) / 12)


def play(u, width=8.0):
    at, followed = 0.0, []
    for v in u:
        at = min(max(at, v - width), v + width)
        followed.append(at)
    return np.array(followed)


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("gap", [0.0, 0.001, 0.02, 0.3, 3.0])
@pytest.mark.parametrize("path", [lambda u: u, play], ids=["function", "play"])
def test_minima_that_differ_leave_the_fit_at_the_noise(gap, path):
    u = cycles(gap)
    assert fit_positive(seen(u, function(path(u)))).rms < 1.5 * SIGMA


@pytest.mark.parametrize("gap", [0.0, 0.02])
def test_nodes_are_dense_where_the_output_moves(gap):
    u = cycles(gap)
    nodes = adapted_nodes(seen(u, function(u)), 40)
    widths = np.interp([55.0, 90.0], nodes[:-1], np.diff(nodes))
    assert widths[0] < 0.7 * widths[1]
    assert np.diff(nodes).min() > 0.2
